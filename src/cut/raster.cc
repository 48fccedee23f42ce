#include "cut/raster.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::cut {

void Raster::draw(const std::array<Vec3, 3>& triangle, const double most) {
  const auto& [a, b, c] = triangle;
  const double twice_area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
  if (twice_area == 0)
    return;
  const auto texel = [](const double at) {
    return static_cast<int>(std::clamp((at / side + 0.5) * n - 0.5, -1.0, double(n)));
  };
  const Vec3 lower = a.cwiseMin(b).cwiseMin(c), upper = a.cwiseMax(b).cwiseMax(c);
  for (int j = std::max(0, texel(lower[1])); j <= std::min(n - 1, texel(upper[1]) + 1); ++j)
    for (int i = std::max(0, texel(lower[0])); i <= std::min(n - 1, texel(upper[0]) + 1); ++i) {
      const double x = ((i + 0.5) / n - 0.5) * side, y = ((j + 0.5) / n - 0.5) * side;
      const auto area = [&](const Vec3& p, const Vec3& q) {
        return (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
      };
      const double of_a = area(b, c), of_b = area(c, a), of_c = area(a, b);
      const bool is_inside =
        twice_area > 0 ? of_a >= 0 && of_b >= 0 && of_c >= 0 : of_a <= 0 && of_b <= 0 && of_c <= 0;
      if (is_inside &&
          std::abs(of_a / twice_area * a[2] + of_b / twice_area * b[2] + of_c / twice_area * c[2]) <= most)
        rows_[j] |= std::uint64_t(1) << i;
    }
}

Raster Raster::grown(const double distance) const {
  const double radius = distance / side * n;
  Raster result;
  const int reach = static_cast<int>(std::lround(radius));
  for (int dj = -reach; dj <= reach; ++dj) {
    const long width = std::lround(std::sqrt(std::max(0.0, radius * radius - dj * dj)));
    for (int j = std::max(0, -dj); j < std::min(n, n - dj); ++j)
      for (int di = 0; di <= width && rows_[j] != 0; ++di)
        result.rows_[j + dj] |= rows_[j] << di | rows_[j] >> di;
  }
  return result;
}

int Raster::count() const {
  int sum = 0;
  for (const std::uint64_t row : rows_)
    sum += std::popcount(row);
  return sum;
}

Raster operator&(Raster a, const Raster& b) {
  for (int j = 0; j < Raster::n; ++j)
    a.rows_[j] &= b.rows_[j];
  return a;
}

} // namespace kerf::cut
