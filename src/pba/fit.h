#pragma once

/// The gradient of a field at a phyxel from the values of its neighbours, by moving least squares (thesis (2.31);
/// Mueller and others 2004): B = C A^+ minimises
///
///     sum_j w_j |x_j - x_i - B X_j|^2,   A = sum_j w_j X_j X_j^T,   C = sum_j w_j (x_j - x_i) X_j^T
///
/// with X_j the rest offset of neighbour j. The pseudo-inverse A^+ reveals the rank: coplanar neighbours say nothing of
/// the gradient across their plane, collinear ones nothing across their line, none nothing at all. What is used of B is
/// F = B M: M is one where the moment is well above a threshold, zero where it is below, and smooth between, so that
/// nothing jumps when a cut takes neighbours away one by one. The threshold is relative to the moment that all
/// neighbours would give, so that a phyxel whose sights all fade is let go.

#include "base/vec.h"

namespace kerf::pba {

struct Fit {
  Mat3 inverse = Mat3::Zero(); ///< A^+ [1/m^2]
  Mat3 used = Mat3::Zero();    ///< M, symmetric, with the eigenvectors of A and eigenvalues in [0, 1] [1]
  double determinant = 0;      ///< of M: 1 where the whole gradient is known [1]
};

/// `moment`: A [m^2]; `reference`: a third of the trace that A has with nothing in sight [m^2];
/// `threshold`: a direction counts in full when its eigenvalue is at least this part of the reference, and not at all
/// below a tenth of it [1].
Fit fit(const Mat3& moment, double reference, double threshold);

/// F where all of it is needed, from what is known: F M + R (1 - M). R is the rotation nearest to what is known, and to
/// no rotation where nothing is: a sheet carries its normal along, a row of points turns as little as it can, a lone
/// point does not turn.
Mat3 completed(const Mat3& known, const Fit& fit);

} // namespace kerf::pba
