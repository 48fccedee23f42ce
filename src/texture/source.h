#pragma once

/// Source points on the faces of a cell (thesis §3.4.2.2).
///
/// The plane of a face is swept through the cell until it contains the point p; then the ray from the swept barycentre
/// to p is taken back to the face, and the source point divides it in the same ratio between barycentre and boundary.
/// Distances to the boundary are tabulated by sweep and direction, the boundary being the outermost one where a ray
/// meets several, without its jumps (source.cc). In between their squares are bilinear: sections of what is round
/// shrink like the root of what is left of the sweep. Continuous, and exact in the face itself, whatever the table's
/// resolution.
///
/// A face that is one component of several keeps its source points: its boundary is followed from that of the component
/// itself, and what would lie beside the component, over another one or in a bay, is drawn to its border.

#include "texture/kernels.h"
#include "texture/partition.h"

#include <cmath>

namespace kerf::texture {

class Source {
 public:
  /// Throws ParameterError about "Axis [1]" or "Centre [m]" if the sweep's axis does not fit the face: it must lie in
  /// the plane, and pass beside the face.
  Source(const Face& face, const Cell& cell, const Exemplar& exemplar, const Chart& chart,
         const geometry::TriangleMesh& body);

  int exemplar() const { return exemplar_; }

  /// In local coordinates of the plane, and how far from the point that is asked for [m].
  struct Point {
    Vec2 local;
    double distance;
  };
  /// The source point of p [m].
  Point find(const Vec3& p) const {
    const Swept swept = sweep(p);
    const Vec2 local = find(swept);
    if (turns_)
      return {local, (plane_.origin + local[0] * plane_.x + local[1] * plane_.y - p).norm()};
    return {local, std::sqrt(swept.t * swept.t + (local - swept.local).squaredNorm())}; // it has gone along the normal
  }
  /// The same for eight points, to round-off: of each its coordinates, then those of its source point, and the
  /// distance.
  void find(const Lanes* points, Lanes& x, Lanes& y, Lanes& distances) const;

 private:
  /// A point as the swept plane sees it.
  struct Swept {
    double t;   ///< how far the plane has gone [m] or [radians]
    Vec2 local; ///< in the swept plane [m]
  };
  Swept sweep(const Vec3& p) const {
    const Vec3 d = p - plane_.origin;
    if (!turns_)
      return {side_ * normal_.dot(d), Vec2(plane_.x.dot(d), plane_.y.dot(d))};
    return turn(p);
  }
  Swept turn(const Vec3& p) const;
  Vec2 find(const Swept& swept) const;
  Frame frame(double t) const;
  void prepare_turning(const Face& face, const Exemplar& exemplar);
  void require_one_side(const Face& face, const Exemplar& exemplar, const Chart& chart) const;
  double farthest(const Cell& cell, const geometry::TriangleMesh& body, const Face& face, const Chart& chart) const;
  void tabulate(const Cell& cell, const Exemplar& exemplar, const geometry::TriangleMesh& body, double t_max);
  void prepare_component(const Face& face, const Chart& chart);
  /// How far a source point may lie from the middle, [m] each, where the component's border is `radius` away.
  double drawn_in(double length, double radius, const Vec2& along) const;

  static constexpr int n_directions = 256, n_steps = 33;
  static constexpr double far = 0.02 * (n_steps - 1); ///< how far is far from the boundary, see find() [steps]

  int exemplar_ = 0;
  Frame plane_;
  Vec3 normal_ = Vec3::Zero();
  double side_ = 1;
  bool turns_ = false;
  Vec3 centre_ = Vec3::Zero(), axis_ = Vec3::Zero(), outward_ = Vec3::Zero(), inward_ = Vec3::Zero();
  double steps_by_t_ = 0; ///< rows of the table a unit of t
  /// Distances from the middle to the boundary, squared: n_steps rows of n_directions + 1, the last of a row is its
  /// first [m^2].
  std::vector<float> squared_radii_;
  std::vector<float> squared_border_; ///< of a component: its own border, with jumps, as a row of those; else empty
  std::vector<Vec2> middles_;         ///< the swept barycentre, by step [m]
  image::Grey beside_;        ///< of a component: how far beside it a pixel is, 1 from four pixels on; else empty
  std::vector<double> reach_; ///< of a component: from its middle to its border, by direction [m]; else empty
  Mat2 to_pixels_ = Mat2::Identity();
};

} // namespace kerf::texture
