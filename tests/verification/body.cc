#include "tests/verification/body.h"

#include "surface/placement.h"
#include "tests/fem/quadrature.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace kerf::verification {

namespace {

/// Nodes closer to a plane than this part of h are on it [1].
constexpr double on_plane = 1e-9;

double height(const std::vector<support::Plane>& planes, const Vec3& p) {
  double highest = -1e300;
  for (const auto& plane : planes)
    highest = std::max(highest, plane.height(p));
  return highest;
}

/// Where an edge from inside leaves: the plane it crosses first.
grid::EdgeCut leave(const grid::Grid& grid, const grid::EdgeId e, const std::vector<support::Plane>& planes) {
  const auto& [lower, upper] = grid.ends(e);
  const bool goes_up = grid.is_material(lower);
  const Vec3 from = grid.position(goes_up ? lower : upper), to = grid.position(goes_up ? upper : lower);
  double first = 1;
  Vec3 normal = Vec3::Unit(grid.axis(e));
  for (const auto& plane : planes) {
    const double a = plane.height(from), b = plane.height(to);
    if (b > a && -a / (b - a) <= first) {
      first = -a / (b - a);
      normal = plane.normal;
    }
  }
  return {e, goes_up ? first : 1 - first, normal, grid::skin_label};
}

void place(Body& body) {
  surface::place(body, {});
  body.complex = grid::build_complex(body);
}

Body placed(support::Body&& made) {
  Body body{std::move(made)};
  place(body);
  return body;
}

} // namespace

Body convex_body(const grid::Lattice& lattice, const std::vector<support::Plane>& planes, const Box& around) {
  const Vec3 n = (around.upper - lattice.origin) / lattice.h;
  std::vector<Index3> nodes;
  for (int i = 1; i <= n[0] + 1; ++i)
    for (int j = 1; j <= n[1] + 1; ++j)
      for (int k = 1; k <= n[2] + 1; ++k)
        if (height(planes, lattice.position({i, j, k})) < -on_plane * lattice.h)
          nodes.push_back({i, j, k});
  return placed(support::make_body(
    lattice, nodes, [&](const grid::Grid& grid, const grid::EdgeId e) { return leave(grid, e, planes); }));
}

Body box(const Box& box, const double h, const Vec3& offset) {
  std::vector<support::Plane> planes;
  for (int d = 0; d < 3; ++d) {
    planes.push_back({Vec3::Unit(d), box.upper[d]});
    planes.push_back({-Vec3::Unit(d), -box.lower[d]});
  }
  return convex_body({box.lower - h * (Vec3::Ones() - offset), h}, planes, box);
}

Body ball(const double radius, const double h, const Vec3& offset) { return placed(support::ball(radius, h, offset)); }

void cut(Body& body, const support::Plane& plane, const std::function<bool(const Vec3&)>& is_cut) {
  cut::SweepCuts cuts;
  for (const grid::EdgeCut& one : support::plane_cuts(body, plane)) {
    const auto& [lower, upper] = body.grid.ends(one.edge);
    const Vec3 p = body.grid.position(lower), q = body.grid.position(upper);
    if (is_cut(p + one.t * (q - p)))
      cuts.cuts.push_back(one);
  }
  for (const grid::SkinCut& one : support::plane_skin_cuts(body, plane)) {
    const grid::CellId c = one.segment.face.valid() ? body.grid.cells(one.segment.face)[0] : one.segment.cell;
    const grid::Skeleton& skeleton = grid::skeleton_of(grid::material_of(body.grid, c));
    for (grid::Segments left = skeleton.segments & ~grid::skeleton::lines; left != 0; left &= left - 1)
      if (const int segment = std::countr_zero(left); grid::skin_segment(body.grid, c, segment) == one.segment) {
        const auto& ends = skeleton.segment[segment].ends;
        const Vec3 p = grid::item_point(body, c, ends[0]), q = grid::item_point(body, c, ends[1]);
        if (is_cut(p + one.t * (q - p)))
          cuts.of_skin.push_back(one);
      }
  }
  cut::Cutter cutter(1);
  cutter.begin(body, body.rest());
  surface::place(body, cutter.cut(body, cuts), {});
}

void cut_at_once(Body& body, const cut::Shape& shape, const cut::Fronts fronts) {
  cut::Cutter cutter(1, cut::Release::queued, fronts);
  cutter.begin(body, body.rest());
  surface::place(body, cutter.at_once(body, {"cut", shape, 1}, body.rest()), {});
}

void cut_with_blade(Body& body, const cut::Blade& blade, const int n_steps) {
  cut::Cutter cutter(1, cut::Release::queued, cut::Fronts::of_elements);
  cutter.begin(body, body.rest());
  for (int k = 0; k < n_steps || cutter.n_waiting() > 0; ++k)
    surface::place(body,
                   cutter.step(body, std::span(&blade, 1), std::min(1.0, double(k) / n_steps),
                               std::min(1.0, double(k + 1) / n_steps), body.rest()),
                   {});
}

Points traction_forces(const Body& body, const std::function<Vec3(const SurfacePoint&)>& traction) {
  static const auto rule = fem::triangle_rule(5);
  const auto skin = surface::build_surface(body);
  Points forces(body.complex.n_corners(), Vec3::Zero());
  for (std::size_t i = 0; i < skin.triangles.size(); ++i) {
    const auto vertex = [&](const int k) { return skin.rest[skin.triangles[i][k]]; };
    const Vec3 a = vertex(1) - vertex(0), b = vertex(2) - vertex(0), area = a.cross(b);
    const grid::Copy& copy = body.complex.copies[skin.copies[i]];
    if (area.norm() == 0)
      continue;
    for (const auto& [x, weight] : rule) {
      const Vec3 X = vertex(0) + x[0] * a + x[1] * b, local = (X - body.grid.origin(copy.cell)) / body.grid.h();
      const Vec3 force = weight * area.norm() * traction({X, area.normalized(), skin.labels[i]});
      for (int v = 0; v < 8; ++v)
        forces[copy.corners[v].value] += fem::shape(v, local) * force;
    }
  }
  return forces;
}

Points end_forces(const Body& body, const double x, const Vec3& traction) {
  const double tolerance = 1e-6 * body.grid.h();
  return traction_forces(body, [&](const SurfacePoint& p) {
    return std::abs(p.position[0] - x) < tolerance && std::abs(p.normal[0]) > 0.99 ? traction : Vec3(Vec3::Zero());
  });
}

Place find(const Body& body, const Vec3& X) {
  const Vec3 scaled = (X - body.grid.lattice().origin) / body.grid.h();
  Index3 lowest;
  for (int d = 0; d < 3; ++d)
    lowest[d] = static_cast<int>(std::floor(scaled[d]));
  const auto cell = body.grid.find_cell(lowest);
  if (!cell)
    throw std::logic_error("no cell holds this point");
  Place result{{}, scaled - Vec3(lowest[0], lowest[1], lowest[2])};
  double nearest = 1e300;
  for (int v = 0; v < 8; ++v) {
    const double distance = (result.local - Vec3(v & 1, v >> 1 & 1, v >> 2 & 1)).squaredNorm();
    const auto copy = body.complex.copy_at(*cell, v);
    if (copy.valid() && distance < nearest) {
      nearest = distance;
      result.copy = copy;
    }
  }
  return result;
}

Vec3 value_at(const Body& body, const Points& values, const Place& place) {
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < 8; ++v)
    sum += fem::shape(v, place.local) * values[body.complex.copies[place.copy].corners[v].value];
  return sum;
}

Vec3 value_at(const Body& body, const Points& values, const Vec3& X) { return value_at(body, values, find(body, X)); }

std::vector<std::uint32_t> corners_where(const Points& rest, const std::function<bool(const Vec3&)>& is_in) {
  std::vector<std::uint32_t> corners;
  for (std::uint32_t c = 0; c < rest.size(); ++c)
    if (is_in(rest[c]))
      corners.push_back(c);
  return corners;
}

double smallest_fraction(const fem::Hexahedra& model) {
  double smallest = 1;
  for (std::size_t i = 0; i < model.n_elements(); ++i)
    smallest = std::min(smallest, model.element(i).volume / std::pow(model.h(), 3));
  return smallest;
}

} // namespace kerf::verification
