#include "dynamics/mixing.h"

#include <Eigen/QR>

namespace kerf::dynamics {

namespace {

Points difference(const Points& a, const Points& b) {
  Points c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    c[i] = a[i] - b[i];
  return c;
}

double product(const Points& a, const Points& b, const std::span<const double> weight) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += weight[i] * a[i].dot(b[i]);
  return sum;
}

} // namespace

Points Mixing::mixed(const Points& x, const Points& d, const std::span<const double> weight) {
  if (last_x_.size() == x.size())
    past_.push_back({difference(x, last_x_), difference(d, last_d_)});
  if (past_.size() > depth_)
    past_.erase(past_.begin());
  last_x_ = x;
  last_d_ = d;
  const auto n = static_cast<Eigen::Index>(past_.size());
  Eigen::MatrixXd normal(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      normal(i, j) = product(past_[i].d, past_[j].d, weight);
    right[i] = product(past_[i].d, d, weight);
  }
  Points sum = d;
  if (n == 0)
    return sum;
  const Eigen::VectorXd share = normal.completeOrthogonalDecomposition().solve(right);
  for (Eigen::Index k = 0; k < n; ++k)
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] -= share[k] * (past_[k].x[i] + past_[k].d[i]);
  return sum;
}

} // namespace kerf::dynamics
