#include "material/laws.h"

#include "base/error.h"
#include "material/polar.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf::material {

namespace {

template <class Law>
Tangent exact_tangent(const Law& law, const Mat3& F) {
  const Stretches stretches = stretches_of(F);
  return tangent_of(stretches, law.curvature(stretches.s));
}

template <class Law>
Tangent absolute_tangent(const Law& law, const Mat3& F) {
  const Stretches stretches = stretches_of(F);
  return tangent_of(stretches, absolute_value(law.curvature(stretches.s)));
}

/// dJ/dF.
Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  C << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return C;
}

/// lambda/2 tr(e)^2 + mu e:e of a symmetric strain e.
double hooke_energy(const double lambda, const double mu, const Mat3& e) {
  return 0.5 * lambda * e.trace() * e.trace() + mu * e.squaredNorm();
}

Mat3 hooke_stress(const double lambda, const double mu, const Mat3& e) {
  return lambda * e.trace() * Mat3::Identity() + 2 * mu * e;
}

Mat3 small_strain(const Mat3& F) { return 0.5 * (F + F.transpose()) - Mat3::Identity(); }
Mat3 green_strain(const Mat3& F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }

} // namespace

double SmallStrain::energy(const Mat3& F) const { return hooke_energy(lambda, mu, small_strain(F)); }
Mat3 SmallStrain::stress(const Mat3& F) const { return hooke_stress(lambda, mu, small_strain(F)); }

Tangent SmallStrain::tangent(const Mat3&) const {
  return tangent_of({Mat3::Identity(), Mat3::Identity(), Vec3::Ones()},
                    {Mat3::Constant(lambda) + 2 * mu * Mat3::Identity(), Vec3::Constant(2 * mu), Vec3::Zero()});
}

double Corotational::energy(const Mat3& F) const {
  return hooke_energy(lambda, mu, small_strain(rotation_of(F).transpose() * F));
}

Mat3 Corotational::stress(const Mat3& F) const {
  const Mat3 R = rotation_of(F);
  return R * hooke_stress(lambda, mu, small_strain(R.transpose() * F));
}

Curvature Corotational::curvature(const Vec3& s) const {
  constexpr double collapsed = 1e-6;
  Curvature c{Mat3::Constant(lambda) + 2 * mu * Mat3::Identity(), Vec3::Constant(2 * mu), Vec3::Zero()};
  for (int k = 0; k < 3; ++k)
    if (const double sum = s[(k + 1) % 3] + s[(k + 2) % 3]; sum > collapsed)
      c.twist[k] = 2 * mu + (2 * lambda * (s.sum() - 3) - 4 * mu) / sum;
  return c;
}

Tangent Corotational::tangent(const Mat3& F) const { return exact_tangent(*this, F); }
Tangent Corotational::positive_tangent(const Mat3& F) const { return absolute_tangent(*this, F); }

double StVenantKirchhoff::energy(const Mat3& F) const { return hooke_energy(lambda, mu, green_strain(F)); }
Mat3 StVenantKirchhoff::stress(const Mat3& F) const { return F * hooke_stress(lambda, mu, green_strain(F)); }

Curvature StVenantKirchhoff::curvature(const Vec3& s) const {
  const double pressure = 0.5 * lambda * (s.squaredNorm() - 3); // lambda tr(E)
  Curvature c;
  c.stretch = lambda * s * s.transpose();
  for (int k = 0; k < 3; ++k) {
    const double p = s[(k + 1) % 3], q = s[(k + 2) % 3];
    c.stretch(k, k) += mu * (3 * s[k] * s[k] - 1) + pressure;
    c.flip[k] = mu * (p * p + p * q + q * q - 1) + pressure;
    c.twist[k] = mu * (p * p - p * q + q * q - 1) + pressure;
  }
  return c;
}

Tangent StVenantKirchhoff::tangent(const Mat3& F) const { return exact_tangent(*this, F); }
Tangent StVenantKirchhoff::positive_tangent(const Mat3& F) const { return absolute_tangent(*this, F); }

double NeoHookean::energy(const Mat3& F) const {
  const double I = F.squaredNorm(), J = F.determinant();
  // (J - a)^2 - (1 - a)^2, without the cancellation near rest.
  return 0.5 * m() * (I - 3) + 0.5 * l() * (J - 1) * (J + 1 - 2 * a()) - 0.5 * m() * std::log1p((I - 3) / 4);
}

Mat3 NeoHookean::stress(const Mat3& F) const {
  const double I = F.squaredNorm(), J = F.determinant();
  return m() * I / (I + 1) * F + l() * (J - a()) * cofactor(F);
}

Curvature NeoHookean::curvature(const Vec3& s) const {
  const double I = s.squaredNorm(), shear = m() * I / (I + 1), pressure = l() * (s.prod() - a());
  const Vec3 slope(s[1] * s[2], s[2] * s[0], s[0] * s[1]); // dJ/ds
  Curvature c;
  c.stretch =
    shear * Mat3::Identity() + 2 * m() / ((I + 1) * (I + 1)) * s * s.transpose() + l() * slope * slope.transpose();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    c.stretch(i, j) += pressure * s[k];
    c.stretch(j, i) += pressure * s[k];
    c.flip[k] = shear - pressure * s[k];
    c.twist[k] = shear + pressure * s[k];
  }
  return c;
}

Tangent NeoHookean::tangent(const Mat3& F) const { return exact_tangent(*this, F); }
Tangent NeoHookean::positive_tangent(const Mat3& F) const { return absolute_tangent(*this, F); }

AnyLaw law_of(const Elastic& material) {
  const double lambda = material.lambda(), mu = material.mu();
  if (material.law == "small strain")
    return SmallStrain{lambda, mu};
  if (material.law == "corotational")
    return Corotational{lambda, mu};
  if (material.law == "St. Venant-Kirchhoff")
    return StVenantKirchhoff{lambda, mu};
  if (material.law == "neo-Hookean")
    return NeoHookean{lambda, mu};
  throw ParameterError({.path = "Law",
                        .value = material.law,
                        .rule = "is no constitutive law",
                        .remedy = "Choose small strain, corotational, St. Venant-Kirchhoff or neo-Hookean"});
}

Mat3 cauchy_stress(const AnyLaw& law, const Mat3& F, const double least_volume) {
  const Mat3 P = std::visit([&](const auto& l) { return Mat3(l.stress(F)); }, law);
  if (std::holds_alternative<SmallStrain>(law))
    return P;
  return P * F.transpose() / std::max(F.determinant(), least_volume);
}

} // namespace kerf::material
