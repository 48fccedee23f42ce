#pragma once

/// Equations with a part that is much stiffer than the rest, K x = b with K = A + C^T C: by generalised minimal residuals (Saad
/// and Schultz 1986, GMRES, SIAM J. Sci. Stat. Comput. 7) for x and q = C x together,
///
///     [ A   C^T ] [x]   [b]
///     [ C   -1  ] [q] = [0],
///
/// preconditioned from the right by the inverse of
///
///     [ B^-1      0    ]
///     [  C    -(1 + e) ],     B near A^-1, e near the largest eigenvalue of C A^-1 C^T.
///
/// That is as well conditioned as the problem of Stokes, however stiff the part is (Elman, Silvester and Wathen 2014,
/// Finite elements and fast iterative solvers, 2nd ed., ch. 4 and 9), while conjugate gradients for x alone by B take
/// as many more iterations as the root of e says. Residuals r, g of the two rows are measured by r.Br + g.g / (1 + e),
/// and what is left of the equation for x alone is r + C^T g. A few directions are remembered, and then x and q are
/// gone on from.
///
/// Two others were tried. MINRES with the diagonal blocks of that takes twice the iterations. The conjugate gradients
/// of Bramble and Pasciak (1988, Math. Comp. 50) need B^-1 below A, and multigrid is far from that for a few motions.

#include "dynamics/conjugate_gradients.h"
#include "dynamics/preconditioner.h"

namespace kerf::dynamics {

/// Solves K x = b from the x that is given until the residual in the measure equation.J is the one that is asked for.
/// equation.A is K, the stiff part included; equation.B leaves that out. `left`: where b - K x is to be. Gives up, not
/// converged, where it gets on too slowly, where B measures nothing (a square that is negative or no number), or where K
/// does not resist what was found.
CgReport minimal_residuals(const CgEquation& equation, const StiffPart& stiff, std::span<const double> b,
                           double residual, int max_iterations, std::span<double> x, std::span<double> left);

/// By minimal residuals where there is a stiff part, and by patient conjugate gradients where there is none (null), or
/// from where the others give up, for which half of the iterations are kept. Minimal residuals look at stop.residual
/// alone, and tell no way.
CgReport solve_equation(const CgEquation& equation, const StiffPart* stiff, std::span<const double> b,
                        const CgStop& stop, int max_iterations, std::span<double> x, std::span<double> left);

} // namespace kerf::dynamics
