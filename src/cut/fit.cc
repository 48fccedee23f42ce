#include "cut/fit.h"

#include "base/parallel.h"
#include "cut/cell_triangles.h"
#include "geometry/triangle.h"
#include "grid/cube.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf::cut {

namespace cube = grid::cube;
using grid::Grid;

namespace {

constexpr int no_axis = -1;

std::vector<grid::EdgeId> cut_edges_of(const grid::Cuts& cuts) {
  std::vector<grid::EdgeId> edges;
  edges.reserve(cuts.all().size());
  for (const grid::EdgeCut& cut : cuts.all())
    edges.push_back(cut.edge);
  return edges;
}

/// Moves the vertices of one cell and its faces; reads the mesh through the triangles near the cell.
class CellFitter {
 public:
  CellFitter(const Grid& grid, grid::Cuts& cuts, const CellTriangles& triangles, const std::size_t place,
             const grid::TouchedCell& touched)
    : grid_(grid),
      cuts_(cuts),
      triangles_(triangles),
      near_(triangles.of(place)),
      cell_(touched.cell),
      cut_lines_(touched.lines),
      lower_(grid.origin(touched.cell)) {
    const auto nodes = grid.nodes(cell_);
    for (int v = 0; v < cube::n_vertices; ++v)
      material_ |= unsigned(grid.is_material(nodes[v])) << v;
  }

  void fit_faces() {
    const auto faces = grid_.faces(cell_);
    for (int face = 0; face < cube::n_faces; ++face) {
      const grid::FaceId f = faces[face];
      const bool first_seen = (face & 1) == 1 || !grid_.cells(f)[0].valid(); // else done from the cell below
      if (!first_seen || !cuts_.point(f))
        continue;
      if (const auto q = fit(*cuts_.point(f), outward_direction(cube::face_lines[face]), cube::face_axis(face)))
        cuts_.set_point(f, *q);
    }
  }

  void fit_centre() {
    if (lies_on_mesh(*cuts_.point(cell_)))
      return;
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for (const grid::FaceId f : grid_.faces(cell_))
      if (const Vec3* q = cuts_.point(f)) {
        sum += *q;
        ++n;
      }
    constexpr std::array<int, 12> lines = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    if (const auto q = fit(sum / n, outward_direction(lines), no_axis))
      cuts_.set_point(cell_, *q);
  }

 private:
  /// From material to empty, summed over the cut lines; zero where sheets of skin face each other.
  template <class Lines>
  Vec3 outward_direction(const Lines& lines) const {
    Vec3 sum = Vec3::Zero();
    for (const int line : lines)
      if (cut_lines_ >> line & 1) {
        sum[cube::line_axis(line)] += material_ >> cube::line_vertices[line][0] & 1 ? 1 : -1;
      }
    return sum.norm() > 0 ? Vec3(sum.normalized()) : sum;
  }

  bool lies_on_mesh(const Vec3& p) const {
    return std::any_of(near_.begin(), near_.end(),
                       [&](const std::uint32_t t) { return lies_on(p, triangles_[t], triangles_[t].height(p)); });
  }

  /// `height` is the triangle's of p.
  bool lies_on(const Vec3& p, const FlatTriangle& triangle, const double height) const {
    const double tolerance = 1e-9 * grid_.h();
    if (height * height > 4 * tolerance * tolerance * triangle.normal.squaredNorm())
      return false; // the plane alone is too far away
    return (geometry::closest_point(p, triangle.corners) - p).squaredNorm() < tolerance * tolerance;
  }

  /// The point of the mesh nearest to p along the line through it, inside the cell; where the line meets none, the
  /// nearest of all there; nothing when there is none at all, or p lies on the mesh itself. `normal` is the axis of the
  /// face that the vertex stays in, or no_axis.
  std::optional<Vec3> fit(const Vec3& p, const Vec3& direction, const int normal) const {
    std::optional<Vec3> best;
    Reach reach = reach_inside(p, direction, normal);
    for (const std::uint32_t t : near_) {
      const FlatTriangle& triangle = triangles_[t];
      const double height = triangle.height(p);
      if (lies_on(p, triangle, height))
        return std::nullopt;
      const double slope = triangle.normal.dot(direction);
      if ((height + reach.from * slope) * (height + reach.to * slope) > 0)
        continue; // meets the plane outside of the cell, or farther away than the best
      const auto s = geometry::line_meets(p, direction, triangle.corners);
      if (s && keep_nearer(best, p, normal, p + *s * direction)) {
        const double nearer = std::abs(*s) * (1 + 1e-9);
        reach = {std::max(reach.from, -nearer), std::min(reach.to, nearer)};
      }
    }
    return best ? best : nearest_of_all(p, normal);
  }

  std::optional<Vec3> nearest_of_all(const Vec3& p, const int normal) const {
    std::optional<Vec3> best;
    for (const std::uint32_t t : near_)
      keep_nearer(best, p, normal,
                  normal == no_axis ? std::optional(geometry::closest_point(p, triangles_[t].corners))
                                    : geometry::closest_point_in_plane(p, normal, triangles_[t].corners));
    return best;
  }

  /// A part of a line p + s d [m].
  struct Reach {
    double from, to;
  };

  /// What lies inside the cell, and a little more: round-off decides nothing.
  Reach reach_inside(const Vec3& p, const Vec3& direction, const int normal) const {
    const double slack = 1e-6 * grid_.h();
    Reach reach = {-2 * grid_.h(), 2 * grid_.h()}; // longer than any way through the cell
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == normal || direction[axis] == 0)
        continue;
      const double a = (lower_[axis] - p[axis]) / direction[axis], b = a + grid_.h() / direction[axis];
      reach = {std::max(reach.from, std::min(a, b) - slack), std::min(reach.to, std::max(a, b) + slack)};
    }
    return reach;
  }

  /// Is q the new best?
  bool keep_nearer(std::optional<Vec3>& best, const Vec3& p, const int normal, const std::optional<Vec3>& q) const {
    if (!q || !is_inside(*q, normal) || (best && (*q - p).squaredNorm() >= (*best - p).squaredNorm()))
      return false;
    best = q;
    return true;
  }

  bool is_inside(const Vec3& p, const int normal) const {
    const double margin = grid::min_edge_parameter * grid_.h();
    for (int axis = 0; axis < 3; ++axis) {
      const double local = p[axis] - lower_[axis];
      if (axis != normal && (local < margin || local > grid_.h() - margin))
        return false;
    }
    return true;
  }

  const Grid& grid_;
  grid::Cuts& cuts_;
  const CellTriangles& triangles_;
  std::span<const std::uint32_t> near_;
  grid::CellId cell_;
  unsigned cut_lines_, material_ = 0;
  Vec3 lower_;
};

} // namespace

void fit_skin(const geometry::TriangleMesh& mesh, const Grid& grid, grid::Cuts& cuts) {
  const auto cells = grid::touched_cells(grid, cut_edges_of(cuts));
  const CellTriangles triangles(mesh, grid, cells);
  // Every vertex that is moved exists already, so each cell and face writes its own place.
  parallel_for(cells.size(), [&](const std::size_t i) { CellFitter(grid, cuts, triangles, i, cells[i]).fit_faces(); });
  parallel_for(cells.size(), [&](const std::size_t i) { CellFitter(grid, cuts, triangles, i, cells[i]).fit_centre(); });
}

} // namespace kerf::cut
