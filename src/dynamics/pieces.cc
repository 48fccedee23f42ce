#include "dynamics/pieces.h"

#include "dynamics/points.h"

#include <algorithm>

namespace kerf::dynamics {

Pieces::Pieces(std::vector<std::uint32_t> piece_of_corner) : piece_(std::move(piece_of_corner)) {
  if (!piece_.empty())
    n_ = 1 + *std::max_element(piece_.begin(), piece_.end());
  if (n_ == 1)
    piece_ = {};
}

Loan<double> Pieces::products(const Points& a, const Points& b) const {
  if (n_ == 1)
    return Loan<double>(1, product(a, b));
  Loan<double> sum(n_, 0);
  for (std::size_t i = 0; i < a.size(); ++i)
    sum[of(i)] += a[i].dot(b[i]);
  return sum;
}

void Pieces::take_out_mean(const std::span<const double> mass, const std::span<const std::uint8_t> which,
                           Points& values) const {
  if (std::ranges::count(which, 0) == std::ssize(which))
    return;
  Loan<double> all(n_, 0);
  Loan<Vec3> mean(n_, Vec3::Zero());
  for (std::size_t i = 0; i < values.size(); ++i) {
    all[of(i)] += mass[i];
    mean[of(i)] += mass[i] * values[i];
  }
  for (std::size_t p = 0; p < n_; ++p)
    mean[p] = which[p] && all[p] > 0 ? Vec3(mean[p] / all[p]) : Vec3(Vec3::Zero());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] -= mean[of(i)];
}

} // namespace kerf::dynamics
