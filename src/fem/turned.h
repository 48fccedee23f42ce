#pragma once

/// One element's energy 1/2 u^T K u in the frame that turns with it, u_a = R^T (x_a - x_0) - (X_a - X_0), R the polar
/// rotation of its mean deformation gradient F = sum x_a b_a^T, and its exact derivatives.
///
/// With R^T dR = [w]x and S = R^T F, the polar decomposition gives A w = sum b_a x R^T dx_a for A = tr(S) I - S. So
/// dE = sum (R (K u)_a - R (z x b_a)) . dx_a, where A z = t = sum y_a x (K u)_a and y_a = R^T (x_a - x_0): the second
/// term is that of dR/dx. The second derivative follows by differentiating w, z and u once more. Where F collapses, R
/// is not differentiable: its derivative is left out there, as it is where the frame does not turn at all.

#include "fem/element.h"

namespace kerf::fem {

/// Which frame an element's matrix is meant in.
enum class Frame {
  fixed,  ///< R = I: small rotations only
  turning ///< with the material
};

struct Turned {
  Mat3 F; ///< mean deformation gradient [1]
  Mat3 R;
  Vector24 y; ///< R^T (x_a - x_0) [m]
  Vector24 u; ///< [m]
};

/// `x`: the 8 corners [m].
Turned turned(const Element& element, double h, const std::array<Vec3, 8>& x, Frame frame);

/// R K R^T: positive semi-definite [N/m].
Matrix24 turned_stiffness(const Matrix24& K, const Mat3& R);

/// The second derivative of E [N/m], symmetric. `K`: the element's stiffness, or its part that E is of.
Matrix24 hessian(const Element& element, const Matrix24& K, const Turned& state, Frame frame);

} // namespace kerf::fem
