#pragma once

/// The energy of a phyxel per volume, for a deformation gradient F of which a symmetric M is known (F = F M, fit.h):
///
///     Psi(F) = mu E : E + (lambda - v d^2) / 2 tr(E)^2 + v / 2 (det F - d)^2,   E = (F^T F - M^2) / 2,   d = det M
///
/// For M = 1, Hooke's law on Green's strain (thesis (2.32)) and the volume term of Mueller and others 2004, with lambda
/// shared between them, so that small strains meet Lame's lambda and mu whatever v is. A rotation has no energy for any
/// M; a direction that M leaves out has neither strain nor stress.

#include "dynamics/model.h"

namespace kerf::pba {

struct Law {
  double mu = 0, lambda = 0; ///< Lame's parameters [Pa]
  double volume = 0;         ///< v: the part of lambda that acts on the volume, in 0 .. lambda [Pa]
};

/// What a law is evaluated at.
struct Strain {
  const Mat3& F; ///< [1]
  const Mat3& M; ///< [1]
  double d;      ///< det M [1]
};

/// Psi [Pa].
double energy_density(const Law& law, const Strain& strain);
/// P = dPsi/dF, the first Piola-Kirchhoff stress [Pa].
Mat3 stress(const Law& law, const Strain& strain);

/// The second derivative of Psi at one F, ready for many products; the positive one leaves out what compression takes
/// away, and what a change of volume adds to turning areas.
struct Linearised {
  Mat3 F, cofactor;
  Mat3 spin_stress; ///< S of the geometric part dF S [Pa]
  double mu, trace; ///< of Hooke's law [Pa]
  double volume;    ///< v [Pa]
  double pressure;  ///< v (det F - d), 0 for the positive tangent [Pa]
};

Linearised linearise(const Law& law, const Strain& strain, dynamics::Tangent tangent);

/// dP for dF [Pa].
Mat3 stress_change(const Linearised& at, const Mat3& dF);

/// The 3 x 3 block K with dP g = K p for dF = p g^T [Pa/m^2 for g in 1/m].
Mat3 block(const Linearised& at, const Vec3& g);

} // namespace kerf::pba
