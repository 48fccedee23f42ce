#include "cut/fit.h"

#include "base/parallel.h"
#include "cut/cell_triangles.h"
#include "geometry/triangle.h"
#include "grid/parts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace kerf::cut {

namespace cube = grid::cube;
using grid::Solid;

namespace {

constexpr int no_axis = -1;
constexpr double on_mesh = 1e-9; // parts of h: nearer lies on it

constexpr std::array<int, 12> line_axes = [] {
  std::array<int, 12> axes{};
  for (int line = 0; line < cube::n_lines; ++line)
    axes[line] = cube::line_axis(line);
  return axes;
}();

/// Along whole numbers of lines; zero for none.
const Vec3& unit_vector(const std::array<int, 3>& lines) {
  constexpr int most = 4, n = 2 * most + 1; // lines along an axis, and what they can sum up to
  static const std::vector<Vec3> vectors = [] {
    std::vector<Vec3> all;
    for (int i = 0; i < n * n * n; ++i)
      all.push_back(Vec3(i / (n * n) - most, i / n % n - most, i % n - most).normalized());
    return all;
  }();
  return vectors[((lines[0] + most) * n + lines[1] + most) * n + lines[2] + most];
}

/// The lines whose lower end is among the vertices, for each set of vertices (8 bits).
constexpr std::array<std::uint16_t, 256> lines_up_from = [] {
  std::array<std::uint16_t, 256> lines{};
  for (unsigned vertices = 0; vertices < 256; ++vertices)
    for (int line = 0; line < cube::n_lines; ++line)
      lines[vertices] |= static_cast<std::uint16_t>((vertices >> cube::line_vertices[line][0] & 1) << line);
  return lines;
}();

/// Moves the vertices of one cell and its faces; reads the mesh through the triangles near the cell. `groups` is room
/// for them, used again from cell to cell.
class CellFitter {
 public:
  CellFitter(Solid& solid, const CellTriangles& triangles, const std::size_t place, const grid::TouchedCell& touched,
             std::vector<TriangleGroup>& groups)
    : solid_(solid),
      triangles_(triangles),
      near_(triangles.of(place)),
      groups_(groups),
      cell_(touched.cell),
      cut_lines_(touched.lines),
      lower_(solid.grid.origin(touched.cell)),
      faces_(solid.grid.faces(touched.cell)) {
    triangles.prefetch(place + 1);
    leave_upwards_ = lines_up_from[grid::material_of(solid.grid, cell_)];
    groups_.resize((near_.size() + TriangleGroup::most - 1) / TriangleGroup::most);
    for (TriangleGroup& group : groups_)
      group.clear();
    for (std::size_t i = 0; i < near_.size(); ++i)
      groups_[i / TriangleGroup::most].push_back(triangles[near_[i]]);
  }

  void fit_faces() {
    for (int face = 0; face < cube::n_faces; ++face) {
      const grid::FaceId f = faces_[face];
      const Vec3* const p = solid_.cuts.point(f);
      const bool first_seen =
        (face & 1) == 1 || !p || !solid_.grid.cells(f)[0].valid(); // else done from the cell below
      if (!first_seen || !p)
        continue;
      if (const auto q = fit(*p, outward_direction(cube::face_lines[face]), cube::face_axis(face)))
        solid_.cuts.set_point(f, *q);
    }
  }

  /// Are the cells below, those that are stored, `first` or later ones?
  bool lies_above(const grid::CellId first) const {
    for (int face = 0; face < cube::n_faces; face += 2)
      if (const grid::CellId below = solid_.grid.cells(faces_[face])[0]; below.valid() && below < first)
        return false;
    return true;
  }

  /// After all its faces, also those done from the cells below.
  void fit_centre() {
    const Vec3* const p = solid_.cuts.point(cell_); // none where no vertex has been placed
    if (!p || lies_on_mesh(*p))
      return;
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for (const grid::FaceId f : faces_)
      if (const Vec3* q = solid_.cuts.point(f)) {
        sum += *q;
        ++n;
      }
    constexpr std::array<int, 12> lines = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    if (const auto q = fit(sum / n, outward_direction(lines), no_axis))
      solid_.cuts.set_point(cell_, *q);
  }

 private:
  /// From material to empty, summed over the cut lines; zero where sheets of skin face each other.
  template <class Lines>
  const Vec3& outward_direction(const Lines& lines) const {
    std::array<int, 3> sum{};
    for (const int line : lines)
      sum[line_axes[line]] += static_cast<int>(cut_lines_ >> line & 1) * (2 * (leave_upwards_ >> line & 1) - 1);
    return unit_vector(sum);
  }

  bool lies_on_mesh(const Vec3& p) const {
    return std::any_of(near_.begin(), near_.end(),
                       [&](const std::uint32_t t) { return lies_on(p, triangles_[t], triangles_[t].height(p)); });
  }

  /// `height` is the triangle's of p.
  bool lies_on(const Vec3& p, const FlatTriangle& triangle, const double height) const {
    const double tolerance = on_mesh * solid_.grid.h();
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
    for (std::size_t first = 0; first < near_.size(); first += TriangleGroup::most) {
      const TriangleGroup& group = groups_[first / TriangleGroup::most];
      const double room = 2 * solid_.grid.h(), near_plane = 2 * on_mesh * solid_.grid.h();
      for (std::uint32_t bits = group.which_may_meet(p, direction, room, near_plane); bits != 0; bits &= bits - 1) {
        const FlatTriangle& triangle = triangles_[near_[first + std::countr_zero(bits)]];
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
    const double slack = 1e-6 * solid_.grid.h();
    Reach reach = {-2 * solid_.grid.h(), 2 * solid_.grid.h()}; // longer than any way through the cell
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == normal || direction[axis] == 0)
        continue;
      const double slowness = 1 / direction[axis];
      const double a = (lower_[axis] - p[axis]) * slowness, b = a + solid_.grid.h() * slowness;
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
    const double margin = grid::min_edge_parameter * solid_.grid.h();
    for (int axis = 0; axis < 3; ++axis) {
      const double local = p[axis] - lower_[axis];
      if (axis != normal && (local < margin || local > solid_.grid.h() - margin))
        return false;
    }
    return true;
  }

  Solid& solid_;
  const CellTriangles& triangles_;
  std::span<const std::uint32_t> near_;
  std::vector<TriangleGroup>& groups_; // of them
  grid::CellId cell_;
  unsigned cut_lines_;
  int leave_upwards_; // lines whose lower end is material
  Vec3 lower_;
  std::array<grid::FaceId, 6> faces_;
};

} // namespace

void fit_skin(const geometry::TriangleMesh& mesh, Solid& solid) {
  const auto cells = grid::touched_cells(solid.grid, solid.cuts);
  const CellTriangles triangles(mesh, solid.grid, cells);
  // Every vertex that is moved exists already, so each cell and face writes its own place. A centre waits for the faces
  // that other threads may be at: those of cells below that come before the range.
  std::vector<std::uint8_t> waits(cells.size(), 0);
  parallel_ranges(cells.size(), 2, [&](const std::size_t begin, const std::size_t end) {
    std::vector<TriangleGroup> groups;
    for (std::size_t i = begin; i < end; ++i) {
      CellFitter fitter(solid, triangles, i, cells[i], groups);
      fitter.fit_faces();
      waits[i] = begin > 0 && !fitter.lies_above(cells[begin].cell);
      if (!waits[i])
        fitter.fit_centre();
    }
  });
  parallel_ranges(cells.size(), 2, [&](const std::size_t begin, const std::size_t end) {
    std::vector<TriangleGroup> groups;
    for (std::size_t i = begin; i < end; ++i)
      if (waits[i])
        CellFitter(solid, triangles, i, cells[i], groups).fit_centre();
  });
}

} // namespace kerf::cut
