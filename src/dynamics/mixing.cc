#include "dynamics/mixing.h"

#include "dynamics/conjugate_gradients.h"

#include <Eigen/QR>

#include <algorithm>

namespace kerf::dynamics {

namespace {

Loan<Vec3> difference(const Points& a, const Points& b) {
  Loan<Vec3> c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    c[i] = a[i] - b[i];
  return c;
}

double product(const Points& a, const Points& b, const std::span<const double> weight) {
  return sum_of(a.size(), [&](const std::size_t begin, const std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += weight[i] * a[i].dot(b[i]);
    return sum;
  });
}

} // namespace

void Mixing::mix(const Points& x, const std::span<const double> weight, Points& d) {
  if (last_.x.size() == x.size()) {
    if (n_past_ == depth_)
      std::rotate(past_.begin(), past_.begin() + 1, past_.begin() + depth_);
    else
      ++n_past_;
    past_[n_past_ - 1] = {difference(x, last_.x), difference(d, last_.d)};
  }
  last_ = {Loan<Vec3>(x), Loan<Vec3>(d)};
  if (n_past_ == 0)
    return;
  const auto n = static_cast<Eigen::Index>(n_past_);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most> normal(n, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1> right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j)
      normal(i, j) = normal(j, i) = product(past_[i].d, past_[j].d, weight);
    right[i] = product(past_[i].d, d, weight);
  }
  right = normal.completeOrthogonalDecomposition().solve(right).eval();
  for (Eigen::Index k = 0; k < n; ++k)
    for (std::size_t i = 0; i < d.size(); ++i)
      d[i] -= right[k] * (past_[k].x[i] + past_[k].d[i]);
}

} // namespace kerf::dynamics
