#include "texture/flat.h"

#include <Eigen/Geometry>

#include <cmath>
#include <map>

namespace kerf::texture {

namespace {

constexpr double cube = 64;          ///< [pixels]
constexpr double most_height = 0.25; ///< of a corner above the plane [pixels]
/// A window reaches 3 sqrt(2) pixels away, and there rises by the same: sine 0.25 / 3 sqrt(2), of 3.4 degrees.
constexpr double least_cosine = 0.99826239;

struct Plane {
  Vec3 point, normal;
};

bool takes(const Plane& plane, const Corners& corners, const Vec3& normal, const double pixel) {
  if (!(std::abs(plane.normal.dot(normal)) >= least_cosine))
    return false;
  for (const Vec3& corner : corners)
    if (!(std::abs(plane.normal.dot(corner - plane.point)) <= most_height * pixel))
      return false;
  return true;
}

} // namespace

std::vector<FlatGroup> flat_groups(const std::span<const std::size_t> triangles, const std::span<const Corners> corners,
                                   const Mat3& axes, const Vec3& origin, const double pixel) {
  std::vector<FlatGroup> groups;
  std::vector<Plane> planes;
  std::map<std::array<long, 3>, std::vector<std::size_t>> by_cube;
  for (const std::size_t t : triangles) {
    const auto& [a, b, c] = corners[t];
    const Vec3 area = (b - a).cross(c - a);
    const Vec3 normal = area.norm() > 0 ? Vec3(area.normalized()) : Vec3(Vec3::Zero());
    const Vec3 place = axes.transpose() * ((a + b + c) / 3 - origin) / (cube * pixel);
    std::vector<std::size_t>& near = by_cube[{std::lround(place[0]), std::lround(place[1]), std::lround(place[2])}];
    std::size_t i = 0;
    while (i < near.size() && !takes(planes[near[i]], corners[t], normal, pixel))
      ++i;
    if (i < near.size()) {
      groups[near[i]].push_back(t);
      continue;
    }
    near.push_back(groups.size());
    groups.push_back({t});
    planes.push_back({a, normal});
  }
  return groups;
}

} // namespace kerf::texture
