#pragma once

/// Equations with a part that is much stiffer than the rest, (A + C^T C) x = b: by minimal residuals (MINRES; Paige and
/// Saunders 1975, Solution of sparse indefinite systems of linear equations, SIAM J. Numer. Anal. 12) for x and
/// q = C x together,
///
///     [ A   C^T ] [x]   [b]
///     [ C   -1  ] [q] = [0],
///
/// preconditioned by B near A^-1 and by 1 / (1 + e), with e near the largest eigenvalue of C A^-1 C^T. That is as well
/// conditioned as the problem of Stokes, however stiff the part is (Elman, Silvester and Wathen 2014, Finite elements
/// and fast iterative solvers, 2nd ed., sec. 4.2): conjugate gradients for x alone by B take as many more iterations as
/// the root of e says.
///
/// With r and g what is left of both rows, what is left of the equation for x is r + C^T g, and in its energy norm x is
/// off by at most |r| + |g|, the first in the norm of A^-1. Both are had from the iteration (Herzog and Soodhalter 2017,
/// A modified implementation of MINRES to monitor residual subvector norms for block systems, SIAM J. Sci. Comput. 39).

#include "dynamics/conjugate_gradients.h"
#include "dynamics/preconditioner.h"

namespace kerf::dynamics {

/// As conjugate_gradients(), for an equation whose A is the whole, stiff part included, and whose B leaves that out,
/// with J. Gives up, not converged, where the whole is not positive, or where iterations get on too slowly.
CgReport minimal_residuals(const CgEquation& equation, const StiffPart& stiff, std::span<const double> b,
                           const CgStop& stop, int max_iterations, std::span<double> x, std::span<double> left);

} // namespace kerf::dynamics
