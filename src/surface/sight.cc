#include "surface/sight.h"

#include "grid/material.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>

namespace kerf::surface {

namespace {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;

constexpr double round_off = 1e-12; // of h

/// Where three planes meet; none where that is nowhere, or round-off says where.
std::optional<Vec3> corner(const Plane& a, const Plane& b, const Plane& c) {
  constexpr double least = 1e-9;
  Mat3 normals;
  normals << a.normal, b.normal, c.normal;
  if (std::abs(normals.determinant()) < least)
    return {};
  return normals.transpose().inverse() *
         Vec3(a.normal.dot(a.point), b.normal.dot(b.point), c.normal.dot(c.point));
}

/// Above the plane through a with this normal, of any length; nothing where that has none.
void add(std::vector<Plane>& half_spaces, const Vec3& a, const Vec3& normal, const double length) {
  if (normal.norm() > round_off * length)
    half_spaces.push_back({a, normal.normalized()});
}

/// What is within all sides of a polygon in a face.
std::vector<Plane> within_border(const grid::Solid& solid, const View& view, const int side) {
  const auto& [n, items, segments] = view.now.skeleton().side[side];
  const Vec3 outward = Vec3::Unit(cube::face_axis(side / 2)) * (side / 2 % 2 == 1 ? 1 : -1);
  std::vector<Plane> half_spaces;
  for (int i = 0; i < n; ++i) {
    const Vec3 a = grid::item_point(solid, view.cell, items[i]),
               b = grid::item_point(solid, view.cell, items[(i + 1) % n]);
    add(half_spaces, a, outward.cross(b - a), solid.grid.h());
  }
  return half_spaces;
}

std::vector<Plane> below_skin(const grid::Solid& solid, const View& view) {
  std::vector<Plane> half_spaces;
  for_each_bit(view.now.skeleton().sides >> skeleton::first_triangle, [&](const int triangle) {
    const auto& items = view.now.skeleton().side[skeleton::first_triangle + triangle].items;
    const auto at = [&](const int k) { return grid::item_point(solid, view.cell, items[k]); };
    add(half_spaces, at(0), (at(2) - at(0)).cross(at(1) - at(0)), solid.grid.h() * solid.grid.h());
  });
  return half_spaces;
}

bool are_above(const std::vector<Plane>& half_spaces, const Vec3& p, const double least) {
  return std::ranges::all_of(half_spaces, [&](const Plane& of) { return height(p, of) >= least; });
}

/// p where it is above all; else on the way there from the middle of what is.
std::optional<Vec3> towards(const View& view, const std::vector<Plane>& half_spaces,
                            const std::vector<Plane>& in_planes, const Vec3& p) {
  constexpr double inside = 0.9;
  const double h = view.upper[0] - view.lower[0];
  if (are_above(half_spaces, p, -round_off * h))
    return p;
  const auto middle = middle_of(half_spaces, view.lower, view.upper, in_planes);
  if (!middle)
    return {};
  double part = 1;
  for (const Plane& of : half_spaces)
    if (const double fall = height(*middle, of) - height(p, of); fall > 0)
      part = std::min(part, inside * std::max(height(*middle, of), 0.0) / fall);
  return *middle + part * (p - *middle);
}

bool have_material(const grid::Solid& solid, const grid::CellId c, const grid::CellCuts& cuts, const double least) {
  constexpr double least_square = -1e-12; // of a cube
  using Products = Eigen::Matrix<double, 8, 8>;
  return std::ranges::all_of(grid::parts_of(cuts), [&](const grid::Part& part) {
    const auto pieces = grid::pieces_of(solid, c, part.items());
    std::array<double, 8> at_corner{};
    bool is_folded = false;
    for (const auto& [t, vertex] : pieces) {
      const auto integrals = grid::shape_integrals(t);
      for (int v = 0; v < 8; ++v)
        at_corner[v] += integrals[v];
      is_folded = is_folded || grid::volume(t) < 0;
    }
    if (*std::ranges::min_element(at_corner) <= least)
      return false;
    if (!is_folded)
      return true;
    Products products = -least_square * Products::Identity();
    for (const auto& [t, vertex] : pieces)
      grid::add_shape_products(t, products);
    return Eigen::LLT<Products>(products).info() == Eigen::Success;
  });
}

} // namespace

double height(const Vec3& p, const Plane& half_space) { return half_space.normal.dot(p - half_space.point); }

std::optional<Vec3> middle_of(std::vector<Plane> half_spaces, const Vec3& lower, const Vec3& upper,
                              const std::vector<Plane>& in_planes) {
  const double h = upper[0] - lower[0], margin = grid::min_edge_parameter * h;
  for (const int axis : {0, 1, 2})
    if (std::ranges::none_of(in_planes, [&](const Plane& of) { return std::abs(of.normal[axis]) == 1; })) {
      half_spaces.push_back({lower + margin * Vec3::Ones(), Vec3::Unit(axis)});
      half_spaces.push_back({upper - margin * Vec3::Ones(), -Vec3::Unit(axis)});
    }
  Vec3 sum = Vec3::Zero();
  int n = 0;
  std::array<Plane, 3> three;
  std::ranges::copy(in_planes, three.begin());
  const auto choose = [&](const auto& self, const std::size_t k, const std::size_t first) -> void {
    if (k < three.size()) {
      for (std::size_t i = first; i < half_spaces.size(); ++i) {
        three[k] = half_spaces[i];
        self(self, k + 1, i + 1);
      }
    } else if (const auto p = corner(three[0], three[1], three[2]); p && are_above(half_spaces, *p, -round_off * h)) {
      sum += *p;
      ++n;
    }
  };
  choose(choose, in_planes.size(), 0);
  return n == 0 ? std::nullopt : std::optional<Vec3>(sum / n);
}

std::optional<Vec3> seeing_border(const grid::Solid& solid, const View& view, const int side, const Vec3& p,
                                  std::vector<Plane> in_planes) {
  const int face = side / 2;
  in_planes.push_back({face % 2 == 0 ? view.lower : view.upper, Vec3::Unit(cube::face_axis(face))});
  return towards(view, within_border(solid, view, side), in_planes, p);
}

bool parts_have_areas(const grid::Solid& solid, const View& view, const int side, const Vec3& p) {
  const auto& [n, items, segments] = view.now.skeleton().side[side];
  const Vec3 outward = Vec3::Unit(cube::face_axis(side / 2)) * (side / 2 % 2 == 1 ? 1 : -1);
  Points border; // from one of its cuts on
  std::vector<std::size_t> cuts;
  int first = 0;
  while (first < n && (view.now.blades >> segments[first] & 1) == 0)
    ++first;
  for (int i = first; i <= first + n; ++i) {
    if (const int segment = segments[i % n]; (view.now.blades >> segment & 1) != 0) {
      cuts.push_back(border.size());
      border.push_back(grid::segment_point(solid, view.cell, view.now.skeleton(), segment));
    }
    border.push_back(grid::item_point(solid, view.cell, items[(i + 1) % n]));
  }
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    double twice = 0;
    for (std::size_t i = cuts[k]; i < cuts[k + 1]; ++i)
      twice += outward.dot((border[i] - p).cross(border[i + 1] - p));
    if (twice < -round_off * solid.grid.h() * solid.grid.h())
      return false;
  }
  return true;
}

std::optional<Vec3> seeing_skin(const grid::Solid& solid, const View& view, const Vec3& p,
                                const std::vector<Plane>& in_planes) {
  return towards(view, below_skin(solid, view), in_planes, p);
}

bool has_material(const grid::Solid& solid, const View& view, const double least) {
  return (!view.now.is_cut_at_skin() || have_material(solid, view.cell, grid::cuts_of(solid, view.cell), least)) &&
         (solid.cuts.front(view.cell) == nullptr ||
          have_material(solid, view.cell, grid::cuts_of_copies(solid, view.cell), least));
}
bool has_material(grid::Solid& solid, const View& view, const Vec3& p, const double least) {
  solid.cuts.set_inner_point(view.cell, p);
  return has_material(solid, view, least);
}

bool all_is_seen(const grid::Solid& solid, const View& view) {
  const double least = -round_off * solid.grid.h();
  if (const Vec3* const p = solid.cuts.inner_point(view.cell); p && !are_above(below_skin(solid, view), *p, least))
    return false;
  for (int side = 0; side < skeleton::first_triangle; ++side)
    if ((view.now.skeleton().sides >> side & 1) != 0)
      if (const Vec3* const p = solid.cuts.inner_point(solid.grid.faces(view.cell)[side / 2], side % 2);
          p && !are_above(within_border(solid, view, side), *p, least))
        return false;
  return true;
}

} // namespace kerf::surface
