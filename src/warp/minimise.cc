#include "warp/minimise.h"

#include <cmath>
#include <deque>

namespace kerf::warp {

namespace {

using Eigen::VectorXd;

struct Change {
  VectorXd step, gradient;
  double rho; ///< 1 / (step . gradient)
};

/// The direction down, bent by what earlier steps have taught (two-loop recursion).
VectorXd direction(const VectorXd& gradient, const std::deque<Change>& changes) {
  VectorXd q = -gradient;
  std::vector<double> alpha(changes.size());
  for (std::size_t i = changes.size(); i-- > 0;) {
    alpha[i] = changes[i].rho * changes[i].step.dot(q);
    q -= alpha[i] * changes[i].gradient;
  }
  if (!changes.empty())
    q /= changes.back().rho * changes.back().gradient.squaredNorm();
  for (std::size_t i = 0; i < changes.size(); ++i)
    q += (alpha[i] - changes[i].rho * changes[i].gradient.dot(q)) * changes[i].step;
  return q;
}

struct Trial {
  VectorXd x, gradient;
  double value = 0;
};

/// Halves the step until the value falls by a ten-thousandth of what the slope promises; false if it never does.
bool search(const Function& f, const Trial& from, const VectorXd& along, double length, Trial& to) {
  const double slope = from.gradient.dot(along);
  for (int i = 0; i < 30; ++i, length *= 0.5) {
    to.x = from.x + length * along;
    to.value = f(to.x, to.gradient);
    if (std::isfinite(to.value) && to.value <= from.value + 1e-4 * length * slope)
      return true;
  }
  return false;
}

} // namespace

double minimise(const Function& f, VectorXd& x, const MinimiseOptions& options) {
  Trial now{x, VectorXd::Zero(x.size())}, next = now;
  now.value = f(now.x, now.gradient);
  std::deque<Change> changes;
  for (int i = 0; i < options.n_iterations; ++i) {
    VectorXd along = direction(now.gradient, changes);
    if (along.dot(now.gradient) >= 0) {
      changes.clear();
      along = -now.gradient;
    }
    const double largest = along.cwiseAbs().maxCoeff();
    if (!(largest > 0))
      break;
    // The first step knows no scale: it moves the farthest variable by one unit.
    if (!search(f, now, along, changes.empty() ? 1 / largest : 1, next)) {
      if (changes.empty())
        break;
      changes.clear(); // what was learnt leads nowhere: straight down once more
      continue;
    }
    Change change{next.x - now.x, next.gradient - now.gradient, 0};
    const double curvature = change.step.dot(change.gradient);
    if (curvature > 1e-12 * change.step.norm() * change.gradient.norm()) {
      change.rho = 1 / curvature;
      changes.push_back(std::move(change));
      if (static_cast<int>(changes.size()) > options.n_kept)
        changes.pop_front();
    }
    const bool settled = now.value - next.value <= options.relative_fall * std::abs(now.value);
    std::swap(now, next);
    if (settled)
      break;
  }
  x = now.x;
  return now.value;
}

} // namespace kerf::warp
