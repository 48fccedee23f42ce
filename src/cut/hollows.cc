#include "cut/hollows.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::cut {

namespace {

using grid::Items;

template <class Function>
void for_each_item(Items items, const Function& f) {
  for (; items != 0; items &= items - 1)
    f(std::countr_zero(items));
}

bool holds(const grid::Tetrahedron& t, const double size, const Vec3& p) {
  for (int k = 0; k < 4; ++k) {
    grid::Tetrahedron part = t;
    part[k] = p;
    if (grid::volume(part) / size < 0)
      return false;
  }
  return true;
}

} // namespace

Hollows::Hollows(const grid::Solid& solid, const grid::CellId c, const Items items) {
  const Vec3 origin = solid.grid.origin(c);
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for_each_item(items, [&](const int item) {
    at_[item] = (grid::item_point(solid, c, item) - origin) / solid.grid.h();
    if (item < grid::cube::n_vertices) {
      sum += at_[item];
      ++n;
    }
  });
  inward_ = sum / std::max(1, n);
  constexpr double round_off = 1e-14; // of a cube
  for (const auto& [t, vertex] : grid::pieces_of(solid, c, items, grid::VerticesOfCuts::amid_cuts))
    if (std::abs(grid::volume(t)) > round_off)
      material_.push_back(t);
}

bool Hollows::lie_between(const Items some, const Items others) const {
  bool result = true;
  for_each_item(others, [&](const int item) { result = result && lie_between(some, at_[item]); });
  return result;
}

bool Hollows::lie_between(const Items some, const Vec3& p) const {
  constexpr double shallow = 0.1; // of a cube
  const auto is_in_hollow = [&](const Vec3& q) {
    return !is_inside(q) && !is_inside(q + shallow * (inward_ - q).normalized());
  };
  bool result = true;
  for_each_item(some, [&](const int item) {
    result = result && std::ranges::any_of(std::array{0.25, 0.5, 0.75}, [&](const double part) {
               return is_in_hollow(at_[item] + part * (p - at_[item]));
             });
  });
  return result;
}

Vec3 Hollows::point(const grid::Skeleton& skeleton, const int segment, const double t) const {
  const auto& [a, b] = skeleton.segment[segment].ends;
  const Vec3 way = at_[b] - at_[a];
  return at_[a] + t * (segment < grid::cube::n_lines ? Vec3(way / way.norm()) : way);
}

bool Hollows::is_inside(const Vec3& p) const {
  int n = 0;
  for (const grid::Tetrahedron& t : material_)
    if (const double size = grid::volume(t); holds(t, size, p))
      n += size > 0 ? 1 : -1;
  return n > 0;
}

} // namespace kerf::cut
