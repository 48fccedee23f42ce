#include "tests/verification/beams.h"

#include "fem/energy_release.h"

#include <Eigen/SparseCholesky>

#include <cmath>
#include <numbers>

namespace kerf::verification {

namespace {

constexpr double end_tolerance = 1e-9; // [m]

fem::HexahedraOptions options_of(const BeamModel& model, const double E, const double nu) {
  return hooke(E, nu, model.strain, model.boundary, model.ghost_weight);
}

dynamics::Support clamp(const Points& rest) {
  return hold(rest, corners_where(rest, [](const Vec3& X) { return X[0] < end_tolerance; }));
}

/// What a run gave, `timer` having run since the elements were made.
BeamResult result_of(const Built& built, const CpuTimer& timer, const double value) {
  BeamResult result{value, built.body.complex.n_copies(), built.cost};
  result.cost.solution = timer.seconds();
  return result;
}

/// Mean displacement over some points.
Vec3 mean_at(const Body& body, const Points& u, const Points& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& X : points)
    sum += value_at(body, u, X);
  return sum / static_cast<double>(points.size());
}

/// A length h of thickness t in z, width 2 h.
struct Strip {
  double length, thickness, h;

  double width() const { return 2 * h; }
  Box box() const { return {Vec3::Zero(), Vec3(length, width(), thickness)}; }
  double area() const { return width() * thickness; }
  double inertia() const { return width() * std::pow(thickness, 3) / 12; }
  /// Of a force P = 1 N, E = 1 Pa, nu = 0, as n equal layers.
  double timoshenko_deflection(const int n) const {
    return std::pow(length, 3) * n * n / (3 * inertia()) + length / (5.0 / 6 * 0.5 * area());
  }
  /// A point at the end, just inside its cells.
  Vec3 at_end(const double z) const { return {length * (1 - 1e-12) - 1e-9 * h, h * (1 + 1e-9), z}; }
};

} // namespace

BeamResult heavy_cantilever(const int n_over_height, const Vec3& offset, const BeamModel& model) {
  const Box beam{Vec3(0, -0.1, -0.1), Vec3(1, 0.1, 0.1)};
  Built built = build([&] { return box(beam, 0.2 / n_over_height, Vec3(0, offset[1], offset[2])); },
                      options_of(model, 1e6, model.poissons_ratio));
  const CpuTimer timer;
  const Points rest = built.body.rest();
  Points f(rest.size(), Vec3::Zero());
  for (std::size_t c = 0; c < f.size(); ++c)
    f[c][2] = -9.81 * built.model->lumped_mass()[c];
  const Points u = displacements(built.body, *built.model, f, {clamp(rest)}, LinearSolver::conjugate_gradients);
  return result_of(built, timer, -value_at(built.body, u, Vec3(1 - 1e-9, 1e-9, 1e-9))[2]);
}

BeamResult end_loaded_cantilever(const double slenderness, const int n_over_thickness, const BeamModel& model) {
  const Strip strip{slenderness, 1, 1.0 / n_over_thickness};
  Built built = build([&] { return box(strip.box(), strip.h, Vec3::Zero()); }, options_of(model, 1, 0));
  const CpuTimer timer;
  const Points f = end_forces(built.body, strip.length, Vec3(0, 0, 1 / strip.area()));
  const Points u = displacements(built.body, *built.model, f, {clamp(built.body.rest())}, LinearSolver::direct);
  return result_of(built, timer, value_at(built.body, u, strip.at_end(0.5 + 1e-9))[2] / strip.timoshenko_deflection(1));
}

BeamResult split_beam(const SplitBeam& beam, const BeamModel& model) {
  const int n_cells = beam.n_layers * beam.n_over_layer;
  const Strip strip{beam.slenderness, 1, 1.0 / n_cells};
  const auto make = [&] {
    Body body = box(strip.box(), strip.h, Vec3(0, 0, beam.shift));
    for (int i = 1; i < beam.n_layers; ++i)
      cut(body, {Vec3::UnitZ(), i / static_cast<double>(beam.n_layers)}, [](const Vec3&) { return true; });
    return body;
  };
  Built built = build(make, options_of(model, 1, 0));
  const CpuTimer timer;
  const Points f = end_forces(built.body, strip.length, Vec3(0, 0, 1 / strip.area()));
  const Points u = displacements(built.body, *built.model, f, {clamp(built.body.rest())}, LinearSolver::direct);
  Points tips;
  for (int i = 0; i < beam.n_layers; ++i)
    tips.push_back(strip.at_end((i + 0.5) / beam.n_layers));
  return result_of(built, timer, mean_at(built.body, u, tips)[2] / strip.timoshenko_deflection(beam.n_layers));
}

BeamResult elastica(const double alpha, const double slenderness, const int n_over_thickness) {
  const Strip strip{slenderness, 1, 1.0 / n_over_thickness};
  auto options = options_of({}, 1, 0);
  options.material.law = "corotational";
  Built built = build([&] { return box(strip.box(), strip.h, Vec3::Zero()); }, options);
  const CpuTimer timer;
  dynamics::QuasiStaticOptions newton;
  newton.newton.solver = LinearSolver::direct;
  newton.newton.tangent = dynamics::Tangent::exact;
  dynamics::QuasiStatic stepper(*built.model, newton);
  const Points rest = built.body.rest();
  dynamics::State state{rest, Points(rest.size(), Vec3::Zero()), 0};
  const double force = alpha * strip.inertia() / std::pow(strip.length, 2);
  const Points whole = end_forces(built.body, strip.length, Vec3(0, 0, force / strip.area()));
  constexpr int n_steps = 8;
  for (int i = 1; i <= n_steps; ++i) {
    Points f = whole;
    for (Vec3& one : f)
      one *= i / static_cast<double>(n_steps);
    dynamics::Loads loads;
    loads.supports.push_back(clamp(rest));
    loads.acting.push_back(std::make_unique<NodalForces>(f));
    stepper.step(state, loads, 1);
  }
  const Vec3 end = strip.at_end(0.5 + 1e-9);
  return result_of(built, timer, (value_at(built.body, state.x, end) - end)[2] / strip.length);
}

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

Sparse mass_matrix(const Built& built) {
  const fem::Hexahedra& model = *built.model;
  Vector diagonal(3 * model.lumped_mass().size());
  for (Eigen::Index i = 0; i < diagonal.size(); ++i)
    diagonal[i] = model.lumped_mass()[i / 3];
  Sparse mass(diagonal.size(), diagonal.size());
  std::vector<Eigen::Triplet<double>> coupling;
  if (model.mass_coupling())
    model.mass_coupling()->add_entries(1, coupling);
  mass.setFromTriplets(coupling.begin(), coupling.end());
  return mass + Sparse(diagonal.asDiagonal());
}

/// omega^2 of the mode of the symmetry of `shape`, by inverse iteration; `guess` of it shifts away rigid motions.
double lowest_eigenvalue(const Sparse& K, const Sparse& M, const Sparse& free, const Vector& shape,
                         const double guess) {
  const Sparse k = free.transpose() * K * free, m = free.transpose() * M * free;
  const Eigen::SimplicialLDLT<Sparse> solver(k + guess * m);
  Vector x = free.transpose() * shape;
  for (int i = 0; i < 12; ++i)
    x = solver.solve(m * (x / x.norm()));
  return x.dot(k * x) / x.dot(m * x);
}

/// What theory expects of the modes of a square beam of thickness 1 and E = 1 Pa, density 1000 kg/m^3.
struct BeamWave {
  double k, nu, density = 1000;

  double shear_modulus() const { return 0.5 / (1 + nu); }
  double squared_frequency(const Vibration kind) const {
    return kind == Vibration::bending ? bending() : kind == Vibration::axial ? axial() : torsion();
  }
  /// The lower root of (E I k^2 + S - rho I w)(S k^2 - rho A w) = S^2 k^2 with S = kappa G A.
  double bending() const {
    const double I = 1.0 / 12, S = 5 * (1 + nu) / (6 + 5 * nu) * shear_modulus();
    const double a = density * density * I, b = density * (I * k * k + S) + density * I * S * k * k,
                 c = (I * k * k + S) * S * k * k - S * S * k * k;
    return 2 * c / (b + std::sqrt(b * b - 4 * a * c));
  }
  double axial() const { return k * k / density / (1 + nu * nu * k * k / 6); }
  double torsion() const { return k * k * shear_modulus() * 0.140577 * 6 / density; }
  Vec3 shape(const Vibration kind, const Vec3& X) const {
    if (kind == Vibration::bending)
      return {0, 0, std::cos(k * X[0])};
    if (kind == Vibration::axial)
      return {std::sin(k * X[0]), 0, 0};
    return std::cos(k * X[0]) * Vec3(0, 0.5 - X[2], X[1] - 0.5);
  }
};

/// Columns: the components that may move, all but x at the two ends.
Sparse free_components(const Points& rest, const double length) {
  std::vector<Eigen::Triplet<double>> entries;
  int column = 0;
  for (std::size_t c = 0; c < rest.size(); ++c)
    for (int d = 0; d < 3; ++d)
      if (d != 0 || (rest[c][0] > end_tolerance && rest[c][0] < length - end_tolerance))
        entries.emplace_back(3 * c + d, column++, 1);
  Sparse free(3 * rest.size(), column);
  free.setFromTriplets(entries.begin(), entries.end());
  return free;
}

} // namespace

BeamResult frequency(const Vibration kind, const double slenderness, const int n_over_thickness, const MassMatrix mass,
                     const BeamModel& model) {
  const BeamWave wave{std::numbers::pi / slenderness, 0.3};
  auto options = options_of(model, 1, wave.nu);
  options.mass = mass;
  Built built = build(
    [&] {
      return box({Vec3::Zero(), Vec3(slenderness, 1, 1)}, 1.0 / n_over_thickness, Vec3::Zero());
    },
    options);
  const CpuTimer timer;
  const Points rest = built.body.rest();
  Vector shape(3 * rest.size());
  for (std::size_t c = 0; c < rest.size(); ++c)
    shape.segment<3>(3 * c) = wave.shape(kind, rest[c]);
  const double expected = wave.squared_frequency(kind);
  const double found = lowest_eigenvalue(built.model->stiffness_matrix(rest, dynamics::Tangent::exact),
                                         mass_matrix(built), free_components(rest, slenderness), shape, expected);
  return result_of(built, timer, std::sqrt(found / expected));
}

namespace {

using Tractions = std::function<Vec3(const SurfacePoint&)>;

/// A split beam at rest under tractions, and its cost so far.
struct SplitArms {
  Built built;
  Points u;
  BeamResult result;
};

SplitArms split_arms(const DoubleCantilever& beam, const std::function<void(Body&)>& cut, const Tractions& tractions,
                     const BeamModel& model) {
  const double h = beam.arm / beam.n_over_arm;
  const Strip strip{beam.a + 4 * beam.arm, 2 * beam.arm, h};
  const auto make = [&] {
    Body body = box(strip.box(), h, Vec3(0, 0, 0.5));
    cut(body);
    return body;
  };
  Built built = build(make, options_of(model, 1, 0));
  const CpuTimer timer;
  const Points rest = built.body.rest(), f = traction_forces(built.body, tractions);
  const auto far = hold(rest, corners_where(rest, [&](const Vec3& X) { return X[0] > strip.length - end_tolerance; }));
  Points u = displacements(built.body, *built.model, f, {far}, LinearSolver::direct);
  const BeamResult result = result_of(built, timer, 0);
  return {std::move(built), std::move(u), result};
}

double length_of_cut(const DoubleCantilever& beam) { return beam.a + beam.front * beam.arm / beam.n_over_arm; }

std::function<void(Body&)> by_rectangle(const DoubleCantilever& beam, const cut::Fronts fronts) {
  const double h = beam.arm / beam.n_over_arm;
  const cut::Rectangle cut{Vec3(0, h, beam.arm), Vec3(2 * length_of_cut(beam), 0, 0), Vec3(0, 4 * h, 0)};
  return [=](Body& body) { cut_at_once(body, cut, fronts); };
}

/// P on each arm.
Tractions pull(const DoubleCantilever& beam) {
  const double h = beam.arm / beam.n_over_arm, traction = 1 / (2 * h * beam.arm);
  return [=](const SurfacePoint& p) -> Vec3 {
    if (p.position[0] > 1e-6 * h || std::abs(p.normal[0]) < 0.99)
      return Vec3::Zero();
    return {0, 0, p.position[2] > beam.arm ? traction : -traction};
  };
}

} // namespace

BeamResult double_cantilever(const DoubleCantilever& beam, const BeamModel& model) {
  const double h = beam.arm / beam.n_over_arm, b = 2 * h, c = length_of_cut(beam);
  SplitArms arms = split_arms(beam, by_rectangle(beam, cut::Fronts::of_elements), pull(beam), model);
  const fem::LineFront front{Vec3(c, 0, beam.arm), Vec3(c, b, beam.arm), Vec3::UnitX()};
  const double G = fem::energy_release_rate(arms.built.body, *arms.built.model, deformed(arms.built.body, arms.u), front,
                                            {0.5 * beam.a, 0.9 * beam.a});
  arms.result.value = G / (12 * c * c / (b * b * std::pow(beam.arm, 3)) * std::pow(1 + 0.673 * beam.arm / c, 2));
  return arms.result;
}

namespace {

double work(const SplitArms& arms, const DoubleCantilever& beam) {
  const Points f = traction_forces(arms.built.body, pull(beam));
  double sum = 0;
  for (std::size_t i = 0; i < f.size(); ++i)
    sum += f[i].dot(arms.u[i]);
  return sum;
}

} // namespace

BeamResult work_on_double_cantilever(const DoubleCantilever& beam, const BeamModel& model) {
  SplitArms arms = split_arms(beam, by_rectangle(beam, cut::Fronts::of_elements), pull(beam), model);
  arms.result.value = work(arms, beam);
  return arms.result;
}

BeamResult double_cantilever_by_work(const DoubleCantilever& beam, const BeamModel& model) {
  const double b = 2 * beam.arm / beam.n_over_arm, c = length_of_cut(beam) / beam.arm;
  const auto of = [&](const int n_more) {
    DoubleCantilever other = beam;
    other.front += n_more;
    return split_arms(other, by_rectangle(other, cut::Fronts::of_elements), pull(other), model);
  };
  SplitArms longer = of(beam.n_over_arm);
  const double grown = work(longer, beam) - work(of(-beam.n_over_arm), beam);
  longer.result.value = grown / (2 * b) / (4 / (b * b) * (std::pow(c + 1.673, 3) - std::pow(c - 0.327, 3)));
  return longer.result;
}

BeamResult blade_over_rectangle(const DoubleCantilever& beam, const int n_steps, const BeamModel& model) {
  const double h = beam.arm / beam.n_over_arm;
  const cut::Blade blade{
    .name = "blade",
    .edge = {Vec3(0, -h, beam.arm), Vec3(0, 3 * h, beam.arm)},
    .key_frames = {{0, Vec3(-h, 0, 0), Vec3::Zero()}, {1, Vec3(length_of_cut(beam), 0, 0), Vec3::Zero()}}};
  SplitArms arms = split_arms(
    beam, [&](Body& body) { cut_with_blade(body, blade, n_steps); }, pull(beam), model);
  arms.result.value =
    work(arms, beam) / work(split_arms(beam, by_rectangle(beam, cut::Fronts::of_elements), pull(beam), model), beam);
  return arms.result;
}

BeamResult pressed_arms(const DoubleCantilever& beam, const BeamModel& model) {
  const double h = beam.arm / beam.n_over_arm;
  const auto press = [&](const SurfacePoint& p) -> Vec3 {
    const bool is_pressed = p.label != grid::skin_label && p.position[0] < beam.a;
    return is_pressed ? Vec3(-p.normal) : Vec3(Vec3::Zero());
  };
  SplitArms arms = split_arms(beam, by_rectangle(beam, cut::Fronts::at_faces), press, model);
  const auto at = [&](const double z) {
    return value_at(arms.built.body, arms.u, Vec3(1e-9 * h, h * (1 + 1e-9), z))[2];
  };
  arms.result.value = at(1.5 * beam.arm + 1e-9) - at(0.5 * beam.arm + 1e-9);
  return arms.result;
}

} // namespace kerf::verification
