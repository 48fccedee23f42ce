#pragma once

/// Constitutive laws of isotropic elastic solids, as pure functions of the deformation gradient F = dx/dX [1].
///
/// Each law has: energy density psi [Pa] per rest volume, zero at rest; first Piola-Kirchhoff stress P = dpsi/dF [Pa];
/// tangent dP/dF [Pa]; positive_tangent, which has the absolute values of its eigenvalues, as Newton's method wants it
/// (stretch.h). All are finite for every finite F, inverted and collapsed ones too. All agree with Hooke's law of
/// Lame's lambda and mu [Pa] for small strain. S = R^T F is the symmetric factor of the polar decomposition, E =
/// (F^T F - I) / 2.

#include "material/elastic.h"
#include "material/stretch.h"

#include <variant>

namespace kerf::material {

/// Hooke's law for e = sym(F) - I: psi = mu e:e + lambda/2 tr(e)^2. Only for small rotations.
struct SmallStrain {
  double lambda, mu;

  double energy(const Mat3& F) const;
  Mat3 stress(const Mat3& F) const;
  Tangent tangent(const Mat3& F) const;
  Tangent positive_tangent(const Mat3& F) const { return tangent(F); }
};

/// Hooke's law for S - I: psi = mu |S - I|^2 + lambda/2 tr(S - I)^2 (Mueller and others 2002; thesis §2.1.6).
/// R is not differentiable where two stretches sum to zero (inverted or collapsed F): the tangent leaves its derivative
/// out there.
struct Corotational {
  double lambda, mu;

  double energy(const Mat3& F) const;
  Mat3 stress(const Mat3& F) const;
  Tangent tangent(const Mat3& F) const;
  Tangent positive_tangent(const Mat3& F) const;
  Curvature curvature(const Vec3& s) const;
};

/// St. Venant-Kirchhoff: psi = mu E:E + lambda/2 tr(E)^2. Softens in compression, turns unstable below a stretch of
/// 1/sqrt(3), and does not resist inversion.
struct StVenantKirchhoff {
  double lambda, mu;

  double energy(const Mat3& F) const;
  Mat3 stress(const Mat3& F) const;
  Tangent tangent(const Mat3& F) const;
  Tangent positive_tangent(const Mat3& F) const;
  Curvature curvature(const Vec3& s) const;
};

/// Stable neo-Hookean (Smith, de Goes and Kim 2018, equation 14): with I = F:F, J = det F and a = 1 + 3 m / (4 l),
///
///     psi = m/2 (I - 3) + l/2 (J - a)^2 - m/2 log(I + 1) - its value at rest.
///
/// Its own moduli m = 4/3 mu and l = lambda + 5/6 mu make it Hooke's law for small strain (their section 3.4). A smooth
/// law that turns with the frame has no stress at F = 0: a body collapsed to one point stays until something disturbs
/// it, then comes back.
struct NeoHookean {
  double lambda, mu;

  double energy(const Mat3& F) const;
  Mat3 stress(const Mat3& F) const;
  Tangent tangent(const Mat3& F) const;
  Tangent positive_tangent(const Mat3& F) const;
  Curvature curvature(const Vec3& s) const;

  double m() const { return 4 * mu / 3; }
  double l() const { return lambda + 5 * mu / 6; }
  double a() const { return 1 + 3 * m() / (4 * l()); }
};

using AnyLaw = std::variant<SmallStrain, Corotational, StVenantKirchhoff, NeoHookean>;

/// The law of a material, by the name it has there.
AnyLaw law_of(const Elastic& material);

/// Cauchy's stress P F^T / det F of a state [Pa], current configuration; of the small-strain law P itself. Where F is
/// inverted or flat there is none: det F counts as at least `least_volume` [1] then.
Mat3 cauchy_stress(const AnyLaw& law, const Mat3& F, double least_volume = 1e-3);

} // namespace kerf::material
