#include "fem/energy_release.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace kerf::fem {

namespace {

Growth of_front(const LineFront& front, const Vec3& X) {
  const Vec3 along = (front.second - front.first).normalized(), d = X - front.first;
  return {front.growth, (d - d.dot(along) * along).norm(), 0};
}

Growth of_front(const CircleFront& front, const Vec3& X) {
  const Vec3 d = X - front.centre;
  const double above = d.dot(front.normal);
  const Vec3 out = d - above * front.normal;
  const double r = out.norm(), distance = std::hypot(r - front.radius, above);
  return r > 0 ? Growth{out / r, distance, 1 / r} : Growth{Vec3::Zero(), distance, 0};
}

Vec3 point_of(const LineFront& front, const double part) { return front.first + part * (front.second - front.first); }
Vec3 point_of(const CircleFront& front, const double part) {
  const double angle = 2 * std::numbers::pi * part;
  const Vec3 normal = front.normal.normalized(), u = normal.unitOrthogonal(), v = normal.cross(u);
  return front.centre + front.radius * (std::cos(angle) * u + std::sin(angle) * v);
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

Vec3 point_on(const CrackFront& front, const double part) {
  return std::visit([&](const auto& f) { return point_of(f, part); }, front);
}

double length(const CrackFront& front) {
  return std::visit([](const auto& f) { return length_of(f); }, front);
}

namespace {

/// Gradients beside the mean, one a monomial.
using Beside = std::array<Mat3, 6>;
using Gram = Eigen::Matrix<double, 6, 6>;

/// What copies with the same material share.
struct Shape {
  Gram gram;                 ///< of the monomials [m^3]
  Gradients of_motion, of_q; ///< of displacements [1/m]

  Shape(const Moments& moments, const Hexahedra& model) {
    const Centred about = centred(without_negative_squares(moments));
    const double h = model.h();
    gram = h * h * h * about.gram;
    of_motion = hourglass_gradients(about, model.material(), model.elements().strain()) / h;
    of_q = hourglass_gradients(about, model.material(), Strain::trilinear) / h;
  }
};

Beside gradients_of(const Gradients& all, const Vector24& u) {
  const Eigen::Matrix<double, 54, 1> flat = all * u;
  Beside gradients;
  for (int q = 0; q < 6; ++q)
    gradients[q] = Eigen::Map<const Mat3>(flat.data() + 9 * q);
  return gradients;
}

struct Piece {
  double volume;        ///< [m^3]
  Mat3 F, growth;       ///< means of the deformation gradient, and of grad q
  Mat3 R;               ///< F beside its mean is R times `beside`
  Beside beside, of_q;  ///< of the motion in the turned frame, and of q
  Gram gram;            ///< [m^3]
};

/// q at a copy's corners.
Vector24 growth_of(const grid::Solid& solid, const grid::Copy& copy, const CrackFront& front, const Tubes& tubes) {
  Vector24 q;
  for (int a = 0; a < 8; ++a) {
    const Growth at = growth_at(front, solid.grid.position(solid.complex.node[copy.corners[a]]));
    q.segment<3>(3 * a) = part(tubes, at.distance) * at.direction;
  }
  return q;
}

std::vector<Piece> domain(const grid::Solid& solid, const Hexahedra& model, const Points& x, const CrackFront& front,
                          const Tubes& tubes) {
  const Shape of_full(full_cube_moments(), model);
  std::vector<Piece> pieces;
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies())) {
    if (!model.incidence().is_used(c.value))
      continue;
    const grid::Copy& copy = solid.complex.copies[c];
    const Vector24 q = growth_of(solid, copy, front, tubes);
    const Element& element = model.element(c.value);
    Mat3 growth = Mat3::Zero();
    for (int a = 0; a < 8; ++a)
      growth += q.segment<3>(3 * a) * element.gradient(a).transpose();
    if (growth.isZero(1e-12 / tubes.outer))
      continue;
    std::optional<Shape> own;
    if (!model.elements().is_full(c.value))
      own.emplace(model.elements().moments(solid, c), model);
    const Shape& shape = own ? *own : of_full;
    std::array<Vec3, 8> corners;
    for (int a = 0; a < 8; ++a)
      corners[a] = x[copy.corners[a].value];
    const Turned state = turned(element, model.h(), corners, model.frame());
    pieces.push_back({element.volume, state.F, growth, state.R, gradients_of(shape.of_motion, state.u),
                      gradients_of(shape.of_q, q), shape.gram});
  }
  return pieces;
}

/// Hooke's stress of a displacement gradient.
Mat3 stress(const material::Elastic& material, const Mat3& H) {
  return material.lambda() * H.trace() * Mat3::Identity() + material.mu() * (H + H.transpose());
}

/// The integral of (F - F_0)^T P - W I : grad q over a piece; P, W: the law's at the mean.
double released(const Piece& piece, const Mat3& F_0, const Mat3& P, const double W, const material::Elastic& material) {
  const Mat3 F = piece.F - F_0, identity = Mat3::Identity();
  double sum = piece.volume * (F.transpose() * P - W * identity).cwiseProduct(piece.growth).sum();
  for (int p = 0; p < 6; ++p) {
    const Mat3 &H = piece.beside[p], S = stress(material, H), RH = piece.R * H;
    const Mat3 first = RH.transpose() * P + F.transpose() * piece.R * S - P.cwiseProduct(RH).sum() * identity;
    for (int q = 0; q < 6; ++q) {
      const Mat3 second = piece.beside[q].transpose() * S - 0.5 * piece.beside[q].cwiseProduct(S).sum() * identity;
      sum += piece.gram(p, q) * (first.cwiseProduct(piece.of_q[q]) + second.cwiseProduct(piece.growth)).sum();
    }
  }
  return sum;
}

/// What ties take as the front gets longer [J/m].
double taken_by_ties(const grid::Solid& solid, const Hexahedra& model, const Points& x, const CrackFront& front,
                     const Tubes& tubes) {
  const Ties ties = model.ties(solid);
  double sum = 0;
  for (const auto& [a, b, k] : ties.all()) {
    const Growth at = growth_at(front, solid.grid.position(solid.complex.node[grid::CornerId(a)]));
    sum += part(tubes, at.distance) * at.lengthening * 0.5 * k * (x[a] - x[b]).squaredNorm();
  }
  return sum;
}

} // namespace

double energy_release_rate(const grid::Solid& solid, const Hexahedra& model, const Points& x, const CrackFront& front,
                           const Tubes& tubes) {
  const std::vector<Piece> pieces = domain(solid, model, x, front, tubes);
  Mat3 F_0 = Mat3::Zero();
  double volume = 0, sum = -taken_by_ties(solid, model, x, front, tubes);
  for (const Piece& piece : pieces) {
    F_0 += piece.volume * piece.F;
    volume += piece.volume;
  }
  if (volume == 0)
    return 0;
  F_0 /= volume;
  const auto add = [&](const auto& law) {
    for (const Piece& piece : pieces)
      sum += released(piece, F_0, law.stress(piece.F), law.energy(piece.F), model.material());
  };
  std::visit(add, model.law());
  return sum / length(front);
}

double stress_intensity(const double energy_release_rate, const material::Elastic& material) {
  const double nu = material.poissons_ratio;
  return std::sqrt(std::max(0.0, energy_release_rate) * material.youngs_modulus / (1 - nu * nu));
}

} // namespace kerf::fem
