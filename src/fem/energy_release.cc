#include "fem/energy_release.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::fem {

namespace {

Growth of_front(const LineFront& front, const Vec3& X) {
  const Vec3 along = (front.second - front.first).normalized(), d = X - front.first;
  return {front.growth, (d - d.dot(along) * along).norm()};
}

Growth of_front(const CircleFront& front, const Vec3& X) {
  const Vec3 d = X - front.centre;
  const double above = d.dot(front.normal);
  const Vec3 out = d - above * front.normal;
  const double r = out.norm();
  return {r > 0 ? Vec3(out / r) : Vec3(Vec3::Zero()), std::hypot(r - front.radius, above)};
}

double length_of(const LineFront& front) { return (front.second - front.first).norm(); }
double length_of(const CircleFront& front) { return 2 * std::numbers::pi * front.radius; }

/// 1 in the inner tube, 0 outside of the outer one.
double part(const Tubes& tubes, const double distance) {
  return std::clamp((tubes.outer - distance) / (tubes.outer - tubes.inner), 0.0, 1.0);
}

} // namespace

Growth growth_at(const CrackFront& front, const Vec3& X) {
  return std::visit([&](const auto& f) { return of_front(f, X); }, front);
}

double length(const CrackFront& front) {
  return std::visit([](const auto& f) { return length_of(f); }, front);
}

namespace {

struct Piece {
  double volume;  ///< [m^3]
  Mat3 F, growth; ///< means of the deformation gradient, and of grad q
};

std::vector<Piece> domain(const Hexahedra& model, const Points& rest, const Points& x, const CrackFront& front,
                          const Tubes& tubes) {
  std::vector<Piece> pieces;
  for (std::size_t copy = 0; copy < model.n_elements(); ++copy) {
    if (!model.incidence().is_used(copy))
      continue;
    const Element& element = model.element(copy);
    Mat3 growth = Mat3::Zero();
    for (int a = 0; a < 8; ++a) {
      const Vec3& X = rest[model.incidence().corners(copy)[a]];
      const auto [direction, distance] = growth_at(front, X);
      growth += part(tubes, distance) * direction * element.gradient(a).transpose();
    }
    if (!growth.isZero(1e-12 / tubes.outer))
      pieces.push_back({element.volume, model.deformation_gradient(copy, x), growth});
  }
  return pieces;
}

} // namespace

double energy_release_rate(const Hexahedra& model, const Points& rest, const Points& x, const CrackFront& front,
                           const Tubes& tubes) {
  const std::vector<Piece> pieces = domain(model, rest, x, front, tubes);
  Mat3 F_0 = Mat3::Zero();
  double volume = 0, sum = 0;
  for (const Piece& piece : pieces) {
    F_0 += piece.volume * piece.F;
    volume += piece.volume;
  }
  if (volume == 0)
    return 0;
  F_0 /= volume;
  const auto add = [&](const auto& law) {
    for (const auto& [volume_of_copy, F, growth] : pieces)
      sum += volume_of_copy *
             (((F - F_0).transpose() * law.stress(F)).cwiseProduct(growth).sum() - law.energy(F) * growth.trace());
  };
  std::visit(add, model.law());
  return sum / length(front);
}

double stress_intensity(const double energy_release_rate, const material::Elastic& material) {
  const double nu = material.poissons_ratio;
  return std::sqrt(std::max(0.0, energy_release_rate) * material.youngs_modulus / (1 - nu * nu));
}

} // namespace kerf::fem
