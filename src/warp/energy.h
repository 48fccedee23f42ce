#pragma once

/// What a warp costs (thesis §3.4.3.1.1, after Matusik, Zwicker, Durand, Texture design using a simplicial complex of
/// morphable textures, 2005).
///
///     E(f) = 1/n sum_pixels sum_channels (a(x) - b(f(x)))^2          features that do not meet
///          + stiffness * mean_triangles |J - R|^2                    deformation; R = 1, or the nearest rotation
///          + barrier * mean_triangles -(d - 1/2)^2 ln(2 d), d < 1/2  infinite where a triangle would flip (d = det J)
///          + pin weight * mean_pins |f(p) - q|^2 / unit^2
///
/// Unknowns are the images of a lattice's nodes; triangles are those at the four corners of its cells. J is the
/// gradient of a triangle after the global motion G has been taken out: J = G^-1 grad f. The barrier is that of
/// incremental potential contact (Li et al. 2020), on areas.

#include "image/image.h"
#include "warp/lattice_map.h"

namespace kerf::warp {

/// Features of two pictures of one size, channel by channel, at one level.
struct FeatureLevel {
  std::vector<image::Grey> a, b;
};

/// A point that must go to another.
struct Pin {
  Vec2 from, to;
};

enum class Regularity {
  jacobian, ///< |J - 1|^2: the Jacobian of the displacement, harmonic inside
  rigid     ///< |J - R|^2, R the nearest rotation: as rigid as possible
};

/// What the border of the rectangle may do.
enum class Border {
  slides, ///< each side stays on its line, corners stay
  free
};

struct EnergyOptions {
  Regularity regularity = Regularity::jacobian;
  Border border = Border::slides;
  double stiffness = 0.05;
  double barrier = 0.1;
  double pin_weight = 20;
  double pin_unit = 1; ///< in units of the target
  /// A mask whose pixels span the rectangle: cells without any of it are softer by the factor `outside`, though flipped
  /// as little as others. Null: all are alike. Must live while the energy is built.
  const image::Grey* section = nullptr;
  double outside = 0.02;
};

/// A lattice of unknowns: x, y of each node, row by row.
class Energy {
 public:
  /// `levels` may be null: no features. `rest` gives rectangle and numbers of nodes; its images are the start. Features
  /// span the rectangle, their first pixel at its lower corner, the last at the upper.
  Energy(const LatticeMap& rest, const FeatureLevel* features, std::vector<Pin> pins, const EnergyOptions& options);

  /// The linear motion that costs nothing.
  void take_out(const Mat2& global) { global_inverse_ = inverse_of(global); }

  double operator()(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;

 private:
  static Mat2 inverse_of(const Mat2& m);
  double add_features(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  double add_triangles(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  double add_pins(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  double triangle(const Mat2& j, double share, double stiffness, Mat2& derivative) const;
  void hold_border(Eigen::VectorXd& gradient) const;

  /// The four nodes around a point and their shares.
  struct Foot {
    std::array<int, 4> nodes;
    std::array<double, 4> shares;
  };
  Foot foot(const Vec2& p) const;
  std::vector<double> stiffness_of_cells() const;

  LatticeMap rest_;
  const FeatureLevel* features_;
  std::vector<Pin> pins_;
  EnergyOptions options_;
  Mat2 global_inverse_ = Mat2::Identity();
  std::vector<double> cells_; ///< how stiff, over the options' stiffness [1]
  std::vector<Foot> pixels_, pin_feet_;
};

Eigen::VectorXd to_unknowns(const LatticeMap& map);
void from_unknowns(const Eigen::VectorXd& x, LatticeMap& map);

/// The rotation nearest to a matrix (polar decomposition in two dimensions); the identity for zero.
Mat2 nearest_rotation(const Mat2& m);

} // namespace kerf::warp
