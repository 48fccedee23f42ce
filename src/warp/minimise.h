#pragma once

/// Minimisation of smooth functions with barriers, by the limited-memory method of Broyden, Fletcher, Goldfarb, Shanno
/// (Nocedal and Wright, Numerical Optimization, 2006, algorithms 7.4 and 7.5) with steps cut back until the value
/// falls.

#include <Eigen/Core>

#include <functional>

namespace kerf::warp {

/// Returns the value and fills the gradient; infinite where the function is not defined.
using Function = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& gradient)>;

struct MinimiseOptions {
  int n_iterations = 60;
  int n_kept = 8;              ///< pairs of steps and changes of the gradient
  double relative_fall = 1e-5; ///< ends when an iteration lowers the value by less than this part of it
};

/// Returns the lowest value found; x holds its place. The value at the start must be finite.
double minimise(const Function& f, Eigen::VectorXd& x, const MinimiseOptions& options);

} // namespace kerf::warp
