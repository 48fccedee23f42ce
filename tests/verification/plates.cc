#include "tests/verification/plates.h"

#include "fem/energy_release.h"
#include "grid/opening.h"
#include "tests/support/cap.h"
#include "tests/support/spectrum.h"

#include <Eigen/Dense>

#include <cmath>
#include <numbers>

namespace kerf::verification {

namespace {

/// The straight line between two points of the plane, outside on its right.
support::Plane side(const double x0, const double y0, const double x1, const double y1) {
  const Vec3 normal = Vec3(y1 - y0, x0 - x1, 0).normalized();
  return {normal, normal.dot(Vec3(x0, y0, 0))};
}

} // namespace

fem::HexahedraOptions cook_material(const fem::Strain strain) { return hooke(15.0 / 16, 0.25, strain); }

PlateResult cooks_membrane(const int n_over_length, const double offset, const fem::HexahedraOptions& options) {
  const double h = 48.0 / n_over_length, thickness = 2 * h;
  const std::vector<support::Plane> planes = {side(0, 0, 48, 44), side(48, 44, 48, 60),  side(48, 60, 0, 44),
                                              side(0, 44, 0, 0),  {-Vec3::UnitZ(), 0.0}, {Vec3::UnitZ(), thickness}};
  const grid::Lattice lattice{Vec3(-h, -h * (1 - offset), -h), h};
  auto [body, model, cost] = build(
    [&] {
      return convex_body(lattice, planes, {Vec3::Zero(), Vec3(48, 60, thickness)});
    },
    options);
  const CpuTimer timer;
  const Points rest = body.rest();
  Points f = end_forces(body, 48, Vec3(0, 1.0 / 16, 0));
  double total = 0; // less than the thickness where a corner of the loaded side is missing
  for (const Vec3& one : f)
    total += one[1];
  for (Vec3& one : f)
    one *= thickness / total;
  std::vector<dynamics::Support> supports = {
    hold(rest, corners_where(rest, [](const Vec3& X) { return X[0] < 1e-9; })),
    hold(rest, corners_where(rest, [](const Vec3&) { return true; }), dynamics::held_axes("z"))};
  const Points u = displacements(body, *model, f, std::move(supports), LinearSolver::direct);
  cost.solution = timer.seconds();
  const double v = value_at(body, u, Vec3(48 - 1e-9, 52 + 1e-9, h * (1 + 1e-9)))[1];
  return {v, body.complex.n_copies(), smallest_fraction(*model), cost};
}

namespace {

std::uint32_t nearest(const Points& rest, const Vec3& X) {
  std::uint32_t best = 0;
  for (std::uint32_t c = 1; c < rest.size(); ++c)
    if ((rest[c] - X).norm() < (rest[best] - X).norm())
      best = c;
  return best;
}

/// Supports of a cube that shrinks and stretches freely: three corner nodes, away from the disc.
std::vector<dynamics::Support> hold_corners(const Points& rest, const double R) {
  const auto at = [&](const Vec3& X) { return nearest(rest, X); };
  return {hold(rest, {at(Vec3(-R, -R, -R))}), hold(rest, {at(Vec3(R, -R, -R))}, dynamics::held_axes("yz")),
          hold(rest, {at(Vec3(-R, R, -R))}, dynamics::held_axes("z"))};
}

double work(const Points& f, const Points& u) {
  double sum = 0;
  for (std::size_t c = 0; c < f.size(); ++c)
    sum += f[c].dot(u[c]);
  return sum;
}

void compare(const Body& body, const Points& u, const Vec3& centre, PennyResult& result) {
  const double nu = 0.3, exact_volume = 16 * (1 - nu * nu) / 3;
  constexpr double small = 1e-6; // at which strains are small; at E = 1 Pa they are not
  Points x = body.rest();
  for (std::size_t c = 0; c < x.size(); ++c)
    x[c] += small * u[c];
  const auto gaps = grid::gaps(body, 1, x);
  double products = 0, squares = 0, exact_squares = 0;
  for (const grid::Gap& gap : gaps) {
    const double s2 = (grid::edge_point(body, gap.edge) - centre).squaredNorm();
    const double exact = 8 * (1 - nu * nu) / std::numbers::pi * std::sqrt(std::max(0.0, 1 - s2)),
                 found = gap.way.norm() / small;
    products += found * exact;
    squares += found * found;
    exact_squares += exact * exact;
  }
  result.opening = products / exact_squares;
  result.opening_error = std::sqrt(std::max(0.0, squares / exact_squares - result.opening * result.opening));
  result.volume = grid::opened_volume(gaps) / (small * exact_volume);
  result.n_cells = body.complex.n_copies();
}

double release_rate(const Body& body, const fem::Hexahedra& model, const Points& u, const Vec3& centre,
                    const Vec3& normal) {
  const double nu = 0.3, exact = 4 * (1 - nu * nu) / std::numbers::pi;
  const fem::CircleFront front{centre, normal, 1};
  return fem::energy_release_rate(body, model, deformed(body, u), front, {0.5, 0.95}) / exact;
}

/// Under a tension of 1 Pa along the normal.
Points forces_along(const Body& body, const Vec3& normal) {
  return traction_forces(body, [&](const SurfacePoint& p) -> Vec3 {
    return p.label == grid::skin_label ? Vec3(normal * normal.dot(p.normal)) : Vec3(Vec3::Zero());
  });
}

double work_of_cut(const Points& f, const Points& u, const double half_width) {
  const double nu = 0.3, without_cut = std::pow(2 * half_width, 3);
  return (work(f, u) - without_cut) / (16 * (1 - nu * nu) / 3);
}

} // namespace

double work_of_cap(const Penny& problem, const double radius, const cut::Fronts fronts,
                   const fem::HexahedraOptions& options) {
  const double h = 1.0 / problem.n_over_radius, R = problem.half_width;
  const Vec3 normal = problem.normal.normalized();
  auto [body, model, cost] = build(
    [&] {
      Body cube = box({Vec3::Constant(-R), Vec3::Constant(R)}, h, Vec3::Zero());
      cut_at_once(cube, support::cap(h * problem.offset, normal, radius, 1, 40), fronts);
      return cube;
    },
    options);
  const Points f = forces_along(body, normal);
  return work_of_cut(f, displacements(body, *model, f, hold_corners(body.rest(), R), LinearSolver::conjugate_gradients),
                     R);
}

double work_of_leaning_crack(const double angle, const double along, const double across,
                             const fem::HexahedraOptions& options) {
  const double h = 0.25, R = 1.5;
  const Vec3 ahead(std::cos(angle), 0, std::sin(angle)), normal(-std::sin(angle), 0, std::cos(angle)),
    beside = 0.01 * h * Vec3(1.3, 1.1, 1.7); // all nodes
  auto [body, model, cost] = build(
    [&] {
      Body cube = box({Vec3::Constant(-R), Vec3::Constant(R)}, h, Vec3::Zero());
      const Vec3 front = h * (along * ahead + across * normal) + beside;
      cut_at_once(cube, cut::Rectangle{front - 2 * R * ahead, 4 * R * ahead, Vec3(0, 4 * R, 0)});
      return cube;
    },
    options);
  const Points f = forces_along(body, normal);
  return work(f, displacements(body, *model, f, hold_corners(body.rest(), R), LinearSolver::conjugate_gradients));
}

PennyResult penny(const Penny& problem, const fem::HexahedraOptions& options) {
  const double h = 1.0 / problem.n_over_radius, R = problem.half_width;
  const Vec3 centre = h * problem.offset;
  auto [body, model, cost] = build(
    [&] {
      Body cube = box({Vec3::Constant(-R), Vec3::Constant(R)}, h, Vec3::Zero());
      cut_at_once(cube, cut::Disc{centre, problem.normal.normalized(), 1});
      return cube;
    },
    options);
  const CpuTimer timer;
  const Points rest = body.rest();
  const Vec3 normal = problem.normal.normalized();
  const Points f = forces_along(body, normal);
  const Points u = displacements(body, *model, f, hold_corners(rest, R), LinearSolver::conjugate_gradients);
  PennyResult result;
  compare(body, u, centre, result);
  result.work = work_of_cut(f, u, R);
  result.release_rate = release_rate(body, *model, u, centre, normal);
  result.cost = cost;
  result.cost.solution = timer.seconds();
  return result;
}

EdgeCrackResult edge_crack(const EdgeCrack& crack, const fem::Strain strain, const fem::Inertia inertia) {
  // By n = 20, 40, 80, extrapolated: work for a thickness of 1 m [J], and what it grows by with the crack [J/m].
  constexpr double exact = 3.0392, slope = 10.57;
  const double h = 1.0 / crack.n, y = 2 * h;
  fem::HexahedraOptions options = hooke(1, 0.3, strain);
  options.inertia = inertia;
  auto [body, model, cost] = build(
    [&] {
      Body plate = box({Vec3::Zero(), Vec3(1, y, 2)}, h, Vec3(1 - crack.along, 0, 1 - crack.across));
      cut_at_once(plate, cut::Rectangle{Vec3(-0.1, h, 1), Vec3(1, 0, 0), Vec3(0, 1, 0)});
      return plate;
    },
    options);
  const Points rest = body.rest();
  const Points f = traction_forces(body, [&](const SurfacePoint& p) -> Vec3 {
    return p.label == grid::skin_label && std::abs(p.normal[2]) > 0.9 ? Vec3(p.normal[2] * Vec3::UnitZ())
                                                                       : Vec3(Vec3::Zero());
  });
  std::vector<dynamics::Support> supports = {
    hold(rest, corners_where(rest, [](const Vec3&) { return true; }), dynamics::held_axes("y")),
    hold(rest, {nearest(rest, Vec3(1, 0, 0))}, dynamics::held_axes("xz")),
    hold(rest, {nearest(rest, Vec3(1, 0, 2))}, dynamics::held_axes("x"))};
  const Points u = displacements(body, *model, f, std::move(supports), LinearSolver::direct);
  const fem::LineFront front{Vec3(0.4, 0, 1), Vec3(0.4, y, 1), Vec3::UnitX()};
  const double rate = fem::energy_release_rate(body, *model, deformed(body, u), front, {2.5 * h, 0.35});
  return {(work(f, u) / y - exact) / slope / h, std::sqrt(std::max(rate, 0.0) / (0.5 * slope))};
}

Condition condition(const double depth, const fem::HexahedraOptions& options) {
  const Box block{Vec3::Zero(), Vec3(3, 2 + depth, 2 + depth)};
  const Body body = box(block, 1, Vec3::Zero());
  const fem::Hexahedra model(body, options);
  const Points rest = body.rest();
  const Eigen::MatrixXd K = model.stiffness_matrix(rest, dynamics::Tangent::exact);
  const auto free = corners_where(rest, [](const Vec3& X) { return X[0] > 1e-9; });
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd A(3 * n, 3 * n), S = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      A.block<3, 3>(3 * i, 3 * j) = K.block<3, 3>(3 * free[i], 3 * free[j]);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Mat3 L = A.block<3, 3>(3 * i, 3 * i).llt().matrixL();
    S.block<3, 3>(3 * i, 3 * i) = L.inverse();
  }
  const auto ratio = [](const Eigen::MatrixXd& matrix) {
    const Eigen::VectorXd values = support::spectrum(matrix);
    return values[values.size() - 1] / values[0];
  };
  return {smallest_fraction(model), ratio(A), ratio(S * A * S.transpose())};
}

} // namespace kerf::verification
