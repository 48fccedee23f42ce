#include "cut/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::cut {

namespace {

constexpr double edge = Raster::side / Raster::n; // of a texel

/// Where a + b x >= 0, of what is left of a range.
struct Range {
  double first, last;

  void clip(const double a, const double b) {
    if (b > 0)
      first = std::max(first, -a / b);
    else if (b < 0)
      last = std::min(last, -a / b);
    else if (a < 0)
      last = -std::numeric_limits<double>::infinity();
  }
};

/// The place of a coordinate among the middles of texels.
double place(const double at) { return at / edge + 0.5 * (Raster::n - 1); }
double middle(const int i) { return (i - 0.5 * (Raster::n - 1)) * edge; }

int first_from(const double at) {
  return static_cast<int>(std::clamp(std::ceil(place(at)), 0.0, double(Raster::n)));
}
int last_up_to(const double at) {
  return static_cast<int>(std::clamp(std::floor(place(at)), -1.0, double(Raster::n - 1)));
}

} // namespace

int Raster::draw(const std::array<Vec3, 3>& triangle, const double most) {
  const auto& [a, b, c] = triangle;
  const double twice_area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
  if (twice_area == 0)
    return 0;
  constexpr double on_an_edge = 1e-12; // of triangles that share one, both count it
  const double over = 1 / twice_area;
  /// s of s[0] + s[1] x + s[2] y, the share at a point of the corner opposite to the edge from p to q.
  const auto share = [&](const Vec3& p, const Vec3& q) {
    return Vec3(over * (q[1] * p[0] - q[0] * p[1]), over * (p[1] - q[1]), over * (q[0] - p[0]));
  };
  const std::array<Vec3, 3> shares = {share(b, c), share(c, a), share(a, b)};
  const Vec3 away = a[2] * shares[0] + b[2] * shares[1] + c[2] * shares[2]; // the third coordinate, in the same way
  const Vec3 lower = a.cwiseMin(b).cwiseMin(c), upper = a.cwiseMax(b).cwiseMax(c);
  int n_new = 0;
  for (int j = first_from(lower[1] - on_an_edge), end = last_up_to(upper[1] + on_an_edge); j <= end; ++j) {
    const double y = middle(j);
    Range range{lower[0] - on_an_edge, upper[0] + on_an_edge};
    for (const Vec3& s : shares)
      range.clip(on_an_edge + s[0] + s[2] * y, s[1]);
    const double height = away[0] + away[2] * y;
    range.clip(most - height, -away[1]);
    range.clip(most + height, away[1]);
    if (!(range.first <= range.last))
      continue;
    const int first = first_from(range.first), last = last_up_to(range.last);
    if (first > last)
      continue;
    const Row fresh = (~Row() << first & ~Row() >> (n - 1 - last)) & ~rows_[j];
    n_new += static_cast<int>(fresh.count());
    rows_[j] |= fresh;
  }
  return n_new;
}

Raster Raster::grown(const double distance) const {
  const double radius = distance / edge;
  const int reach = static_cast<int>(std::lround(radius));
  Raster result;
  for (int j = 0; j < n; ++j) {
    if (rows_[j].none())
      continue;
    Row wide = rows_[j];
    for (int dj = reach, width = 0; dj >= 0; --dj) { // the farther rows are, the less of them
      for (const long most = std::lround(std::sqrt(std::max(0.0, radius * radius - dj * dj))); width < most; ++width)
        wide |= wide << 1 | wide >> 1;
      for (const int to : {j - dj, j + dj})
        if (0 <= to && to < n)
          result.rows_[to] |= wide;
    }
  }
  return result;
}

int Raster::count() const {
  std::size_t sum = 0;
  for (const Row& row : rows_)
    sum += row.count();
  return static_cast<int>(sum);
}

void Raster::archive(Archive& a) {
  constexpr int word = 64;
  for (Row& row : rows_) {
    std::array<std::uint64_t, n / word> words{};
    for (int i = 0; i < n / word; ++i)
      words[i] = (row >> i * word & Row(~std::uint64_t(0))).to_ullong();
    a(words);
    row.reset();
    for (int i = 0; i < n / word; ++i)
      row |= Row(words[i]) << i * word;
  }
}

Raster operator&(Raster a, const Raster& b) {
  for (int j = 0; j < Raster::n; ++j)
    a.rows_[j] &= b.rows_[j];
  return a;
}

} // namespace kerf::cut
