#include "tests/verification/manufactured.h"

#include "tests/fem/quadrature.h"

#include <Eigen/Dense>

#include <array>

namespace kerf::verification {

namespace {

struct Wave {
  Vec3 amplitude, number;
  double phase;
};

using Waves = std::array<Wave, 3>;

/// Nothing about them is aligned with anything.
const Waves oblique = {{{{0.7, -0.2, 0.4}, {1.9, 0.8, -1.1}, 0.3},
                        {{-0.3, 0.9, 0.1}, {-0.7, 1.3, 1.6}, 1.1},
                        {{0.2, 0.3, -0.8}, {1.2, -1.7, 0.6}, 2.0}}};

/// What of them is transverse.
Waves transverse() {
  Waves waves = oblique;
  for (Wave& w : waves)
    w.amplitude -= w.amplitude.dot(w.number) / w.number.squaredNorm() * w.number;
  return waves;
}

/// u, its gradient, and what it needs to be the solution.
struct Solution {
  Waves waves;
  double lambda, mu; // [Pa]

  Vec3 displacement(const Vec3& X) const {
    Vec3 u = Vec3::Zero();
    for (const Wave& w : waves)
      u += std::sin(w.number.dot(X) + w.phase) * w.amplitude;
    return u;
  }

  Mat3 gradient(const Vec3& X) const {
    Mat3 G = Mat3::Zero();
    for (const Wave& w : waves)
      G += std::cos(w.number.dot(X) + w.phase) * w.amplitude * w.number.transpose();
    return G;
  }

  Mat3 stress(const Vec3& X) const {
    const Mat3 G = gradient(X);
    return lambda * G.trace() * Mat3::Identity() + mu * (G + G.transpose());
  }

  /// -div sigma [N/m^3].
  Vec3 body_force(const Vec3& X) const {
    Vec3 b = Vec3::Zero();
    for (const Wave& w : waves)
      b += std::sin(w.number.dot(X) + w.phase) *
           ((lambda + mu) * w.amplitude.dot(w.number) * w.number + mu * w.number.squaredNorm() * w.amplitude);
    return b;
  }
};

Solution solution_of(const ManufacturedOptions& options) {
  const auto& material = options.model.material;
  return {options.dilatation == Dilatation::some ? oblique : transverse(), material.lambda(), material.mu()};
}

/// Calls f(copy, local, weight [m^3]) for points of the material.
template <class Function>
void for_each_point(const Body& body, const fem::Hexahedra& model, const Function& f) {
  static const auto full = fem::cube_rule(3);
  const double volume = std::pow(body.grid.h(), 3);
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies())) {
    const grid::Copy& copy = body.complex.copies[c];
    const bool is_full = model.element(c.value).volume > (1 - 1e-8) * volume;
    for (const auto& [x, weight] : is_full ? full : fem::material_rule(body, copy, 3))
      f(copy, x, weight * volume);
  }
}

Body make(const ManufacturedOptions& options) {
  if (options.shape == Shape::ball)
    return ball(0.5, options.h, options.offset);
  if (options.shape == Shape::fitted_cube)
    return box({Vec3::Zero(), Vec3::Ones()}, options.h, Vec3::Zero());
  const Mat3 R = (Eigen::AngleAxisd(0.53, Vec3(1, 2, -0.7).normalized())).toRotationMatrix();
  std::vector<support::Plane> planes;
  for (int side = 0; side < 6; ++side)
    planes.push_back({(side & 1 ? 1 : -1) * R.col(side / 2), 0.4});
  return convex_body({Vec3::Constant(-0.9) + options.h * options.offset, options.h}, planes,
                     {Vec3::Constant(-0.9), Vec3::Constant(0.9)});
}

Points forces(const Body& body, const fem::Hexahedra& model, const Solution& solution) {
  Points f =
    traction_forces(body, [&](const SurfacePoint& p) -> Vec3 { return solution.stress(p.position) * p.normal; });
  for_each_point(body, model, [&](const grid::Copy& copy, const Vec3& x, const double weight) {
    const Vec3 b = weight * solution.body_force(body.grid.origin(copy.cell) + body.grid.h() * x);
    for (int v = 0; v < 8; ++v)
      f[copy.corners[v].value] += fem::shape(v, x) * b;
  });
  return f;
}

/// Rigid motions of the corners: 3 n x 6.
Eigen::MatrixXd rigid_motions(const Points& rest) {
  Eigen::MatrixXd R(3 * rest.size(), 6);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    R.block<3, 3>(3 * i, 0).setIdentity();
    for (int d = 0; d < 3; ++d)
      R.block<3, 1>(3 * i, 3 + d) = Vec3::Unit(d).cross(rest[i]);
  }
  return R;
}

Eigen::Map<Eigen::VectorXd> as_vector(Points& p) { return {p[0].data(), static_cast<Eigen::Index>(3 * p.size())}; }

/// Takes away resultant and torque, which are errors of quadrature, by forces in proportion to the masses. Equal ones
/// would tear off corners that only slivers hold.
void balance(const Points& rest, const fem::Hexahedra& model, Points& f) {
  const Eigen::MatrixXd R = rigid_motions(rest);
  Eigen::MatrixXd MR = R;
  for (std::size_t i = 0; i < rest.size(); ++i)
    MR.middleRows<3>(3 * i) *= model.lumped_mass()[i];
  as_vector(f) -= MR * (R.transpose() * MR).ldlt().solve(R.transpose() * as_vector(f)).eval();
}

/// Adds the rigid motion that brings u nearest to the solution, in L2 over the material.
void fit_rigid_motion(const Body& body, const fem::Hexahedra& model, const Solution& solution, const Points& rest,
                      Points& u) {
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for_each_point(body, model, [&](const grid::Copy& copy, const Vec3& x, const double weight) {
    Vec3 found = Vec3::Zero();
    for (int v = 0; v < 8; ++v)
      found += fem::shape(v, x) * u[copy.corners[v].value];
    const Vec3 X = body.grid.origin(copy.cell) + body.grid.h() * x;
    Eigen::Matrix<double, 3, 6> R;
    R << Mat3::Identity(), Vec3::UnitX().cross(X), Vec3::UnitY().cross(X), Vec3::UnitZ().cross(X);
    A += weight * R.transpose() * R;
    b += weight * R.transpose() * (solution.displacement(X) - found);
  });
  as_vector(u) += rigid_motions(rest) * A.ldlt().solve(b);
}

void measure(const Body& body, const fem::Hexahedra& model, const Solution& solution, const Points& u,
             FieldErrors& errors) {
  double l2 = 0, h1 = 0, of_l2 = 0, of_h1 = 0;
  for_each_point(body, model, [&](const grid::Copy& copy, const Vec3& x, const double weight) {
    Vec3 found = Vec3::Zero();
    Mat3 G = Mat3::Zero();
    for (int v = 0; v < 8; ++v) {
      found += fem::shape(v, x) * u[copy.corners[v].value];
      G += u[copy.corners[v].value] * fem::shape_gradient(v, x).transpose() / body.grid.h();
    }
    const Vec3 X = body.grid.origin(copy.cell) + body.grid.h() * x;
    l2 += weight * (found - solution.displacement(X)).squaredNorm();
    h1 += weight * (G - solution.gradient(X)).squaredNorm();
    of_l2 += weight * solution.displacement(X).squaredNorm();
    of_h1 += weight * solution.gradient(X).squaredNorm();
  });
  errors.l2 = std::sqrt(l2 / of_l2);
  errors.h1 = std::sqrt(h1 / of_h1);
}

/// The face x = 0 of the fitted cube goes where the solution has it.
dynamics::Support hold_face(const Solution& solution, const Points& rest) {
  const auto corners = corners_where(rest, [](const Vec3& X) { return X[0] < 1e-9; });
  dynamics::Support support = hold(rest, corners);
  support.rest.clear();
  for (const auto c : corners)
    support.rest.push_back(rest[c] + solution.displacement(rest[c]));
  return support;
}

} // namespace

FieldErrors manufactured(const ManufacturedOptions& options) {
  Built built = build([&] { return make(options); }, options.model);
  const Body& body = built.body;
  fem::Hexahedra& model = *built.model;
  FieldErrors errors{.cost = built.cost};
  const Points rest = body.rest();
  const Solution solution = solution_of(options);
  Points f = forces(body, model, solution), u;
  const CpuTimer solving;
  if (options.shape == Shape::fitted_cube) {
    u = displacements(body, model, f, {hold_face(solution, rest)}, options.solver);
  } else {
    balance(rest, model, f);
    u = displacements(body, model, f, hold_rigid_motion(rest), options.solver);
    fit_rigid_motion(body, model, solution, rest, u);
  }
  errors.cost.solution = solving.seconds();
  measure(body, model, solution, u, errors);
  errors.n_cells = body.complex.n_copies();
  errors.smallest_fraction = smallest_fraction(model);
  return errors;
}

} // namespace kerf::verification
