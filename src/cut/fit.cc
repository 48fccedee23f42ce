#include "cut/fit.h"

#include "base/parallel.h"
#include "geometry/triangle.h"
#include "grid/cube.h"

#include <algorithm>
#include <cmath>

namespace kerf::cut {

namespace cube = grid::cube;
using grid::CellId;
using grid::Grid;

namespace {

/// The triangles of the mesh whose boxes meet each stored cell.
class CellTriangles {
 public:
  CellTriangles(const geometry::TriangleMesh& mesh, const Grid& grid) : start_(grid.n_cells() + 1, 0) {
    std::vector<std::pair<CellId, std::uint32_t>> pairs;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [a, b, c] = geometry::corners(mesh, t);
      const Index3 first = cell_of(grid, a.cwiseMin(b).cwiseMin(c)), last = cell_of(grid, a.cwiseMax(b).cwiseMax(c));
      for (Index3 i = first; i[2] <= last[2]; ++i[2])
        for (i[1] = first[1]; i[1] <= last[1]; ++i[1])
          for (i[0] = first[0]; i[0] <= last[0]; ++i[0])
            if (const auto cell = grid.find_cell(i))
              pairs.emplace_back(*cell, t);
    }
    for (const auto& [cell, t] : pairs)
      ++start_[cell.value + 1];
    for (std::size_t c = 1; c < start_.size(); ++c)
      start_[c] += start_[c - 1];
    triangles_.resize(pairs.size());
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (const auto& [cell, t] : pairs)
      triangles_[next[cell.value]++] = t;
  }

  std::span<const std::uint32_t> of(const CellId c) const {
    return std::span(triangles_).subspan(start_[c.value], start_[c.value + 1] - start_[c.value]);
  }

 private:
  static Index3 cell_of(const Grid& grid, const Vec3& p) {
    Index3 i;
    for (int axis = 0; axis < 3; ++axis)
      i[axis] = static_cast<int>(std::floor((p[axis] - grid.lattice().origin[axis]) / grid.h()));
    return i;
  }

  std::vector<std::uint32_t> start_, triangles_;
};

class Fitter {
 public:
  Fitter(const geometry::TriangleMesh& mesh, const Grid& grid, grid::Cuts& cuts)
    : mesh_(mesh), grid_(grid), cuts_(cuts), triangles_(mesh, grid) {}

  void run() {
    std::vector<CellId> cells;
    for (const CellId c : ids<CellId>(grid_.n_cells()))
      if (cuts_.configuration(grid_, c) != 0)
        cells.push_back(c);
    // Every vertex that is moved exists already, so each cell and face writes its own place.
    parallel_for(cells.size(), [&](const std::size_t i) {
      for (int face = 0; face < cube::n_faces; ++face)
        if ((face & 1) == 1 || !grid_.cells(grid_.faces(cells[i])[face])[0].valid())
          fit_face(cells[i], face);
    });
    parallel_for(cells.size(), [&](const std::size_t i) { fit_cell(cells[i]); });
  }

 private:
  void fit_face(const CellId c, const int face) {
    const grid::FaceId f = grid_.faces(c)[face];
    if (!cuts_.point(f))
      return;
    const Vec3 outward = outward_direction(c, cube::face_lines[face]);
    if (const auto p = fit(c, *cuts_.point(f), outward, cube::face_axis(face)))
      cuts_.set_point(f, *p);
  }

  void fit_cell(const CellId c) {
    constexpr std::array<int, 12> lines = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    if (lies_on_mesh(c, *cuts_.point(c)))
      return;
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for (const grid::FaceId f : grid_.faces(c))
      if (const Vec3* q = cuts_.point(f)) {
        sum += *q;
        ++n;
      }
    constexpr int no_axis = -1;
    if (const auto fitted = fit(c, sum / n, outward_direction(c, lines), no_axis))
      cuts_.set_point(c, *fitted);
  }

  /// From material to empty, summed over the cut lines; zero where sheets of skin face each other.
  template <class Lines>
  Vec3 outward_direction(const CellId c, const Lines& lines) const {
    Vec3 sum = Vec3::Zero();
    for (const int line : lines)
      if (cuts_.is_cut(grid_.edges(c)[line])) {
        const bool lower_is_material = grid_.is_material(grid_.nodes(c)[cube::line_vertices[line][0]]);
        sum[cube::line_axis(line)] += lower_is_material ? 1 : -1;
      }
    return sum.norm() > 0 ? Vec3(sum.normalized()) : sum;
  }

  bool lies_on_mesh(const CellId c, const Vec3& p) const {
    const double tolerance = 1e-9 * grid_.h();
    const auto triangles = triangles_.of(c);
    return std::any_of(triangles.begin(), triangles.end(), [&](const std::uint32_t t) {
      const auto triangle = geometry::corners(mesh_, t);
      for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
        if (p[axis] < low - tolerance || p[axis] > high + tolerance)
          return false;
      }
      return (geometry::closest_point(p, triangle) - p).norm() < tolerance;
    });
  }

  /// The point of the mesh nearest to p along the line through it, inside the cell; where the line meets none, the
  /// nearest of all there; nothing when there is none at all, or p is on the mesh. `normal` is the axis of the face
  /// that the vertex stays in, or -1.
  std::optional<Vec3> fit(const CellId c, const Vec3& p, const Vec3& direction, const int normal) const {
    if (lies_on_mesh(c, p))
      return std::nullopt;
    const auto along = nearest(c, p, normal, [&](const auto& triangle) -> std::optional<Vec3> {
      const auto s = geometry::line_meets(p, direction, triangle);
      return s ? std::optional<Vec3>(p + *s * direction) : std::nullopt;
    });
    if (along)
      return along;
    return nearest(c, p, normal, [&](const auto& triangle) {
      return normal < 0 ? std::optional(geometry::closest_point(p, triangle))
                        : geometry::closest_point_in_plane(p, normal, triangle);
    });
  }

  /// Of the points that `candidate` finds on the cell's triangles, the one inside that is nearest to p.
  template <class Candidate>
  std::optional<Vec3> nearest(const CellId c, const Vec3& p, const int normal, const Candidate& candidate) const {
    std::optional<Vec3> best;
    for (const std::uint32_t t : triangles_.of(c)) {
      const auto q = candidate(geometry::corners(mesh_, t));
      if (q && is_inside(c, *q, normal) && (!best || (*q - p).squaredNorm() < (*best - p).squaredNorm()))
        best = q;
    }
    return best;
  }

  bool is_inside(const CellId c, const Vec3& p, const int normal) const {
    const Vec3 local = p - grid_.origin(c);
    const double margin = grid::min_edge_parameter * grid_.h();
    for (int axis = 0; axis < 3; ++axis)
      if (axis != normal && (local[axis] < margin || local[axis] > grid_.h() - margin))
        return false;
    return true;
  }

  const geometry::TriangleMesh& mesh_;
  const Grid& grid_;
  grid::Cuts& cuts_;
  CellTriangles triangles_;
};

} // namespace

void fit_skin(const geometry::TriangleMesh& mesh, const Grid& grid, grid::Cuts& cuts) {
  Fitter(mesh, grid, cuts).run();
}

} // namespace kerf::cut
