#include "cut/raster.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::cut {

int Raster::draw(const std::array<Vec3, 3>& triangle, const double most) {
  const auto& [a, b, c] = triangle;
  const double twice_area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
  if (twice_area == 0)
    return 0;
  const auto texel = [](const double at) {
    return static_cast<int>(std::clamp((at / side + 0.5) * n - 0.5, -1.0, double(n)));
  };
  constexpr double on_an_edge = -1e-12; // of triangles that share one, both count it
  const double over = 1 / twice_area;
  /// s of s[0] + s[1] x + s[2] y, the share at a point of the corner opposite to the edge from p to q.
  const auto share = [&](const Vec3& p, const Vec3& q) {
    return Vec3(over * (q[1] * p[0] - q[0] * p[1]), over * (p[1] - q[1]), over * (q[0] - p[0]));
  };
  const std::array<Vec3, 3> shares = {share(b, c), share(c, a), share(a, b)};
  const Vec3 lower = a.cwiseMin(b).cwiseMin(c), upper = a.cwiseMax(b).cwiseMax(c);
  int n_new = 0;
  const int first = std::max(0, texel(lower[0])), last = std::min(n - 1, texel(upper[0]) + 1);
  for (int j = std::max(0, texel(lower[1])); j <= std::min(n - 1, texel(upper[1]) + 1); ++j) {
    std::array<double, 3> of_row;
    for (int k = 0; k < 3; ++k)
      of_row[k] = shares[k][0] + shares[k][2] * middle(j);
    for (int i = first; i <= last; ++i) {
      const double x = middle(i), of_a = of_row[0] + shares[0][1] * x, of_b = of_row[1] + shares[1][1] * x,
                   of_c = of_row[2] + shares[2][1] * x;
      const bool is_set = (of_a >= on_an_edge) & (of_b >= on_an_edge) & (of_c >= on_an_edge) &
                          (std::abs(of_a * a[2] + of_b * b[2] + of_c * c[2]) <= most);
      const std::uint64_t bit = std::uint64_t(is_set) << i;
      n_new += (bit & ~rows_[j]) != 0;
      rows_[j] |= bit;
    }
  }
  return n_new;
}

Raster Raster::grown(const FunctionRef<double(double, double)> distance, const double most) const {
  constexpr double texel = side / n;
  Raster result;
  const int reach = static_cast<int>(std::lround(most / texel));
  for (int dj = -reach; dj <= reach; ++dj) {
    std::array<int, 2> width = {-1, -1}; // to either side
    for (const bool to_right : {false, true})
      for (int di = 0; di <= reach; ++di)
        if (const int x = to_right ? di : -di;
            (di == 0 && dj == 0) || std::hypot(x, dj) <= distance(x, dj) / texel + 0.5)
          width[to_right] = di;
    for (int j = std::max(0, -dj); j < std::min(n, n - dj); ++j)
      for (int di = -width[0]; di <= width[1] && rows_[j] != 0; ++di)
        result.rows_[j + dj] |= di >= 0 ? rows_[j] << di : rows_[j] >> -di;
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
