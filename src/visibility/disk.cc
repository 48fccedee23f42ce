#include "visibility/disk.h"

#include "base/error.h"
#include "base/parameters.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace kerf::visibility {

namespace {

void check(const int resolution, const double radius) {
  if (resolution < 4 || resolution > MaskShape::max_resolution)
    throw ParameterError({.path = "Mask resolution [texels]",
                          .value = std::to_string(resolution),
                          .rule = "must be between 4 and " + std::to_string(MaskShape::max_resolution),
                          .remedy = "The thesis recommends 32"});
  if (!positive.contains(radius))
    throw ParameterError({.path = "Disk radius [1]",
                          .value = to_text(radius),
                          .rule = positive.rule(),
                          .remedy = "The thesis recommends 0.5: half the distance of the pair"});
}

/// All three corners on the outer side of a plane through the eye.
bool all_beyond(const std::array<double, 3>& x, const std::array<double, 3>& w, const double half) {
  return x[0] > half * w[0] && x[1] > half * w[1] && x[2] > half * w[2];
}

} // namespace

MaskShape::MaskShape(const int resolution, const double radius) : resolution_(resolution), radius_(radius) {
  check(resolution, radius);
  // Twice the distances from the middle, so that everything is a whole number.
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x) {
      const int dx = 2 * x + 1 - resolution, dy = 2 * y + 1 - resolution;
      if (dx * dx + dy * dy <= resolution * resolution)
        disk_[y] |= 1u << x;
    }
  n_texels_ = count(disk_);
}

Disk make_disk(const Pair& pair, const MaskShape& shape) {
  const Vec3 ab = pair.b - pair.a;
  const double distance = ab.norm();
  const Vec3 n = ab / distance, u = n.unitOrthogonal();
  const double texels = shape.resolution() / (2 * shape.radius() * distance);
  return {0.5 * pair.a + 0.5 * pair.b, texels * u, texels * n.cross(u), 2 / distance * n};
}

Vec3 texel_middle(const Disk& disk, const MaskShape& shape, const int x, const int y) {
  const double half = 0.5 * shape.resolution();
  return disk.middle + (x + 0.5 - half) / disk.to_x.squaredNorm() * disk.to_x +
         (y + 0.5 - half) / disk.to_y.squaredNorm() * disk.to_y;
}

Box box_of_lines(const Pair& pair, const MaskShape& shape) {
  const Vec3 ab = pair.b - pair.a, middle = 0.5 * pair.a + 0.5 * pair.b;
  const double distance = ab.norm();
  const Eigen::Array3d n = ab.array() / (distance > 0 ? distance : 1);
  const Vec3 disk = (shape.radius() * distance * (1 - n.square()).max(0).sqrt()).matrix();
  return {pair.a.cwiseMin(pair.b).cwiseMin(middle - disk), pair.a.cwiseMax(pair.b).cwiseMax(middle + disk)};
}

bool may_occlude(const Disk& disk, const MaskShape& shape, const Face& face, const int side) {
  std::array<double, 3> x, y, w, minus_x, minus_y;
  for (int i = 0; i < 3; ++i) {
    const Vec3 p = face[i] - disk.middle;
    x[i] = disk.to_x.dot(p);
    y[i] = disk.to_y.dot(p);
    w[i] = side == 0 ? 1 + disk.to_z.dot(p) : 1 - disk.to_z.dot(p);
    minus_x[i] = -x[i];
    minus_y[i] = -y[i];
  }
  const auto [nearest, farthest] = std::minmax_element(w.begin(), w.end());
  const double half = 0.5 * shape.resolution();
  return *farthest > 0 && *nearest < end_of_lines && !all_beyond(x, w, half) && !all_beyond(minus_x, w, half) &&
         !all_beyond(y, w, half) && !all_beyond(minus_y, w, half);
}

int count(const std::span<const std::uint32_t> mask) {
  int n = 0;
  for (const std::uint32_t row : mask)
    n += std::popcount(row);
  return n;
}

} // namespace kerf::visibility
