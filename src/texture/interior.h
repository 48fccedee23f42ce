#pragma once

/// The inside of a body: a colour at any point, from a few sections (thesis §3.4).
///
/// Built once: exemplars are fitted to the body, their planes part it into cells, the faces of each cell are matched in
/// pairs. Asked often: the cell of a point, its source points and weights, and their morph,
///
///     q_i = w_i p_i + sum_{j != i} w_j f_ji(p_j),     c = sum_i w_i c_i(q_i),                       (3.14)
///
/// (for faces j that are no partners of i, f_ji(p_j) is p_i) without allocation, the same bits on any thread. In a face
/// its own source point is the point itself and its weight 1: so the colour there is the picture's, and colours are
/// continuous across planes.

#include "texture/source.h"
#include "texture/warps.h"
#include "texture/weights.h"

#include <optional>
#include <span>

namespace kerf::texture {

enum class Morph {
  first_order,   ///< (3.14)
  exact_inverse, ///< q_i solves (3.13) with the warping (3.12): w_i (q_i - p_i) + sum_j w_j A_ji (f_ij(q_i) - p_j) = 0
  blend,         ///< no warp: q_i = p_i
  nearest        ///< the colour at the nearest source point alone
};
enum class Weights { shepard, mean_value };

/// How source points become a colour.
struct Blending {
  Morph morph = Morph::first_order;
  /// mean_value: where the source points enclose the point, Shepard where they do not, and a mixture in between.
  Weights weights = Weights::shepard;
  double power = 1; ///< of Shepard's distances [1]
};

struct InteriorOptions {
  Blending blending;
  Components components = Components::one;
  WarpOptions warps;
};

/// What building an interior takes longest to find.
struct Maps {
  std::vector<std::optional<warp::LatticeMap>> fits; ///< by exemplar
  std::vector<std::vector<BothWays>> warps;          ///< by cell, pairs (i, j) of faces, i < j, in order
};

/// What makes up the colour of a point: of the arrays the first n.
struct Blend {
  Blend() {} // takes no time for the arrays
  int n = 0, cell = 0;
  std::array<std::uint8_t, max_sources> exemplars;
  std::array<float, max_sources> weights;
  std::array<float, max_sources> x, y; ///< in the exemplar's chart [pixels]
};

class Interior {
 public:
  /// At least one exemplar; the body must be closed. `known` are the maps of an earlier interior of the same input.
  /// Throws ParameterError as the parts do; the complaint's path is a key of a scene's section, its value may name the
  /// exemplar.
  Interior(const std::vector<Exemplar>& exemplars, const geometry::TriangleMesh& body, const InteriorOptions& options,
           const Maps* known = nullptr);

  Blend blend(const Vec3& p, const Blending& how) const { return blend(p, how, partition_->find(p)); }
  /// As if the point lay in that cell, which need not be its own: it may lie a little beside it.
  Blend blend(const Vec3& p, const Blending& how, int cell) const;
  /// Of up to eight points, the same to round-off in less time: what one gets does not depend on the others.
  void blend(std::span<const Vec3> points, const Blending& how, std::span<Blend* const> blends) const;
  /// Red, green, blue and luminance of a point of the rest frame [m].
  Eigen::Array4f colour(const Vec3& p) const { return colour(blend(p, options_.blending)); }
  Eigen::Array4f colour(const Vec3& p, const Blending& how) const { return colour(blend(p, how)); }
  Eigen::Array4f colour(const Blend& blend) const;

  const InteriorOptions& options() const { return options_; }
  const std::vector<Chart>& charts() const { return charts_; }
  const Partition& partition() const { return *partition_; }
  const Maps& maps() const { return maps_; }
  const Vec3& origin() const { return origin_; } ///< a point that goes along with the body [m]
  double pixel() const { return pixel_; }        ///< mean side of the exemplars' pixels [m]
  std::size_t n_pairs() const;                   ///< of warps
  std::size_t n_closed_cells() const;            ///< that exemplars alone bound: there mean value weights apply
  /// From picture to picture, as points go: a fit, a warp between faces as tabulated, the other fit. Triangles that
  /// this turns over, two in each pixel of a face, with sides of a thousandth of it: larger ones may lie across a kink
  /// of a lattice, and seem turned over where nothing is.
  struct Folds {
    std::size_t n_triangles = 0, n_flipped = 0;
  };
  Folds folds() const;
  /// The smallest determinant over all warps and fits, relative to no deformation [1].
  double smallest_determinant() const;

 private:
  struct CellData {
    std::vector<Source> sources;
    std::vector<image::Grey> pixels; ///< of the faces
    std::vector<WarpTable> tables;
    std::vector<char> apart;       ///< [j * n + i]: 1 where faces j and i are no partners, or one face
    std::vector<Mat2> linear;      ///< [j * n + i]: from chart pixels of face j to those of face i, before matching
    std::vector<Triple> triangles; ///< between source points; empty where the cell touches the skin
  };
  /// The source points of one question.
  struct Found {
    std::array<Vec2, max_sources> pixels; ///< of the charts
    std::array<Vec2, max_sources> locals; ///< [m]
    Shares shares;
  };

  void build_cell(int cell, const std::vector<Exemplar>& exemplars, const geometry::TriangleMesh& body,
                  const Maps* known);
  void find_sources(const CellData& cell, const Vec3& p, const Blending& how, Found& found) const;
  /// Of eight points: their coordinates.
  void find_sources(const CellData& cell, const Lanes* points, double power, std::span<Found> found) const;
  void mix(int cell, const Found& found, const Blending& how, Blend& blend) const;
  void enclose(const CellData& cell, const Vec3& p, Found& found) const;
  void morph(const CellData& cell, const Found& found, std::array<Vec2, max_sources>& q) const;
  Vec2 in_picture(int exemplar, const Vec2& pixel) const;
  void count_folds(const CellData& cell, int from, int to, Folds& folds) const;
  /// The weight of what stays where it is on face i: of itself, and of those that are no partners of it.
  static double own_share(const CellData& cell, const Found& found, int i);
  Vec2 solve_inverse(const CellData& cell, const Found& found, int i, Vec2 q) const;

  InteriorOptions options_;
  std::vector<Chart> charts_;
  std::optional<Partition> partition_;
  std::vector<CellData> cells_;
  Maps maps_;
  Vec3 origin_;
  double pixel_ = 0;
};

} // namespace kerf::texture
