#include "dynamics/modal.h"

#include "base/error.h"
#include "base/parameters.h"
#include "dynamics/forces.h"
#include "dynamics/points.h"
#include "dynamics/preconditioner.h"

#include <deal.II/lac/arpack_solver.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::dynamics {

namespace {

using Vector = dealii::Vector<double>;

std::span<double> span_of(Vector& v) { return {v.begin(), v.size()}; }
std::span<const double> span_of(const Vector& v) { return {v.begin(), v.size()}; }

/// K and M among the free directions.
class Pencil {
 public:
  Pencil(ElasticModel& model, const Loads& loads, const double time, const Points& x)
    : model_(model),
      constraints_(loads, x.size()),
      at_rest_(x.size(), Vec3::Zero()),
      tangent_(load_tangent(loads, Tangent::positive, {time, x, at_rest_}, 0)) {
    model.linearise(x);
  }

  const Constraints& constraints() const { return constraints_; }
  std::size_t n_corners() const { return at_rest_.size(); }
  std::size_t n_numbers() const { return 3 * n_corners(); }

  void project(const std::span<double> y) const {
    for (std::size_t i = 0; i < n_corners(); ++i)
      if (!constraints_.is_free(i))
        at(y, i) = (constraints_.freedom(i).project * at(y, i)).eval();
  }
  void apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
    model_.apply_stiffness(p, y);
    tangent_.add_product(p, y);
    project(y);
  }
  void apply_mass(const std::span<const double> p, const std::span<double> y) const {
    const auto mass = model_.lumped_mass();
    for (std::size_t i = 0; i < n_corners(); ++i)
      at(y, i) = mass[i] * at(p, i);
    if (const MassCoupling* coupling = model_.mass_coupling())
      coupling->add_product(p, y);
    project(y);
  }
  std::vector<Mat3> stiffness_diagonal() const {
    std::vector<Mat3> blocks = stiffness_blocks(model_);
    tangent_.add_diagonal(blocks);
    return blocks;
  }
  const LoadTangent& loads() const { return tangent_; }
  ElasticModel& model() const { return model_; }

 private:
  ElasticModel& model_;
  Constraints constraints_;
  Points at_rest_;
  LoadTangent tangent_;
};

/// Far below the square of the first frequency of a body that deforms, (2 pi f)^2 [1/s^2]: of Rayleigh's quotient of a
/// strain that keeps the volume.
double shift_of(const Pencil& pencil, const Points& x) {
  constexpr double part = 1e-4; // a slender cantilever has a hundredth of it
  Mat3 strain;
  strain << 1, 1, 1, 1, -2, 1, 1, 1, 1;
  Points u = without_mean(pencil.model().lumped_mass(), x);
  for (Vec3& d : u)
    d = (strain * d).eval();
  pencil.constraints().project(u);
  std::vector<double> Ku(pencil.n_numbers()), Mu(pencil.n_numbers());
  pencil.apply_stiffness(flat(u), Ku);
  pencil.apply_mass(flat(u), Mu);
  const double quotient = dot(flat(u), Ku) / dot(flat(u), Mu);
  return std::isfinite(quotient) && quotient > 0 ? part * quotient : 1;
}

/// (K + s M)^-1 by conjugate gradients.
class Inverse {
 public:
  Inverse(const Pencil& pencil, const double shift, const ModalParameters& parameters, int& n_iterations)
    : pencil_(pencil),
      shift_(shift),
      parameters_(parameters),
      n_iterations_(n_iterations),
      inverse_blocks_(pencil.stiffness_diagonal()) {
    const auto mass = pencil.model().lumped_mass();
    double trace = 0;
    for (std::size_t i = 0; i < inverse_blocks_.size(); ++i) {
      const Mat3 block = inverse_blocks_[i] + shift * mass[i] * Mat3::Identity(),
                 factor = inverse_factor(block, pencil.constraints().freedom(i));
      trace += block.trace();
      inverse_blocks_[i] = factor.transpose() * factor;
    }
    own_ = pencil.model().preconditioner({shift, 1, mass, trace, pencil.loads(), pencil.constraints()});
  }

  void vmult(Vector& x, const Vector& b) const {
    x = 0;
    std::vector<double> right(b.begin(), b.end()), product(b.size());
    pencil_.project(right);
    const Product A =
                    [&](const auto p, const auto y) {
                      pencil_.apply_mass(p, product);
                      pencil_.apply_stiffness(p, y);
                      for (std::size_t i = 0; i < y.size(); ++i)
                        y[i] += shift_ * product[i];
                    },
                  J = [&](const auto r, const auto z) {
                    for (std::size_t i = 0; i < inverse_blocks_.size(); ++i)
                      at(z, i) = inverse_blocks_[i] * at(r, i);
                  };
    const CgEquation equation =
      own_ ? CgEquation{A, [this](const auto r, const auto z) { own_->apply(r, z); }, J} : CgEquation{A, J, {}};
    J(right, product);
    const double scale = std::sqrt(dot(right, product));
    const CgReport report = patient_conjugate_gradients(equation, right, {.residual = parameters_.cg_tolerance * scale},
                                                        parameters_.max_cg_iterations, span_of(x));
    n_iterations_ += report.n_iterations;
    if (!report.converged)
      throw NumericalError("modes: conjugate gradients left a relative residual of " +
                           to_text(report.residual / scale) + " after " + std::to_string(report.n_iterations) +
                           " iterations. Use more CG iterations or a larger CG tolerance in the section 'Modal'");
  }

 private:
  const Pencil& pencil_;
  double shift_;
  const ModalParameters& parameters_;
  int& n_iterations_;
  std::vector<Mat3> inverse_blocks_;
  Preconditioner* own_ = nullptr;
};

struct MassMatrix {
  const Pencil& pencil;
  void vmult(Vector& y, const Vector& p) const { pencil.apply_mass(span_of(p), span_of(y)); }
};

/// A mode with u.Mu = 1.
struct Eigenpair {
  double value; ///< (2 pi f)^2 [1/s^2]
  Vector u, Mu;
};

/// Leaves of vectors what is M-orthogonal to modes.
void take_out(const std::vector<Eigenpair>& modes, Vector& u) {
  for (const Eigenpair& mode : modes)
    u.add(-(mode.Mu * u), mode.u);
}

/// The inverse, among what is M-orthogonal to the modes that are known.
struct Rest {
  const Inverse& inverse;
  const std::vector<Eigenpair>& known;
  void vmult(Vector& x, const Vector& b) const {
    inverse.vmult(x, b);
    take_out(known, x);
  }
};

/// As many of the lowest modes as are wanted, beside those that are known.
std::vector<Eigenpair> further_modes(const Pencil& pencil, const Inverse& inverse, const double shift,
                                     const std::vector<Eigenpair>& known, const std::size_t n_wanted) {
  const auto n = static_cast<unsigned int>(pencil.n_numbers());
  const auto wanted = static_cast<unsigned int>(n_wanted);
  const auto room = static_cast<unsigned int>(pencil.constraints().n_free() - known.size());
  Vector start(n);
  for (unsigned int i = 0; i < n; ++i)
    start[i] = std::sin(1.0 + i + 0.37 * static_cast<double>(known.size())); // has a part in every mode
  pencil.project(span_of(start));
  take_out(known, start);
  dealii::SolverControl control(10 * n, 1e-12);
  dealii::ArpackSolver solver(control,
                              dealii::ArpackSolver::AdditionalData(std::min(2 * wanted + 20, room),
                                                                   dealii::ArpackSolver::largest_magnitude, true));
  solver.set_shift(-shift);
  solver.set_initial_vector(start);
  std::vector<std::complex<double>> values(wanted);
  std::vector<Vector> vectors(wanted, Vector(n));
  const MassMatrix M{pencil};
  try {
    solver.solve(M, M, Rest{inverse, known}, values, vectors, wanted); // the first is not asked for with a shift
  } catch (const dealii::ExceptionBase& error) {
    throw NumericalError(std::string("modes: Lanczos' method failed: ") + error.get_exc_name());
  }
  std::vector<Eigenpair> modes;
  for (Vector& u : vectors) {
    Vector Ku(n), Mu(n);
    M.vmult(Mu, u);
    const double size = std::sqrt(u * Mu);
    u /= size;
    Mu /= size;
    pencil.apply_stiffness(span_of(u), span_of(Ku));
    modes.push_back({u * Ku, u, Mu});
  }
  return modes;
}

void keep_lowest(std::vector<Eigenpair>& modes, const std::size_t n) {
  std::sort(modes.begin(), modes.end(), [](const Eigenpair& a, const Eigenpair& b) { return a.value < b.value; });
  modes.erase(modes.begin() + static_cast<std::ptrdiff_t>(std::min(n, modes.size())), modes.end());
}

/// With a largest displacement of 1, whose largest component is positive.
Points shape_of(const Vector& u) {
  Points shape(u.size() / 3);
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    shape[i] = at(span_of(u), i);
    if (shape[i].norm() > 1.000001 * shape[farthest].norm()) // the first of several
      farthest = i;
  }
  int axis = 0;
  const double length = shape[farthest].norm();
  shape[farthest].cwiseAbs().maxCoeff(&axis);
  const double factor = (shape[farthest][axis] > 0 ? 1 : -1) / length;
  for (Vec3& d : shape)
    d *= factor;
  return shape;
}

} // namespace

void ModalParameters::describe(Parameters& p) {
  p.integer("Modes [1]", n_modes, {.min = 1, .max = 1000},
            "How many of the lowest, rigid motions of a body that floats among them.");
  p.number("CG tolerance [1]", cg_tolerance, {.min = 0, .max = 1, .min_excluded = true, .max_excluded = true},
           "Residual of a linear equation over its right side.");
  p.integer("CG iterations [1]", max_cg_iterations, {.min = 1}, "At most, a linear equation.");
}

Modes lowest_modes(ElasticModel& model, const Loads& loads, const double time, const Points& x,
                   const ModalParameters& parameters, int& n_iterations) {
  const Pencil pencil(model, loads, time, x);
  const auto n_wanted = static_cast<std::size_t>(parameters.n_modes);
  constexpr std::size_t spare = 2; // that Lanczos' method asks for
  constexpr double same = 1e-9;    // of two frequencies
  if (pencil.constraints().n_free() < n_wanted + spare)
    throw ParameterError(Complaint{.rule = "a body that can move in " + std::to_string(pencil.constraints().n_free()) +
                                           " directions has no " + std::to_string(n_wanted) + " modes to find",
                                   .remedy = "Use fewer modes, fewer supports or smaller cubes"});
  const double shift = shift_of(pencil, x);
  const Inverse inverse(pencil, shift, parameters, n_iterations);
  std::vector<Eigenpair> modes = further_modes(pencil, inverse, shift, {}, n_wanted);
  keep_lowest(modes, n_wanted);
  for (bool is_new = true; is_new && modes.size() + spare < pencil.constraints().n_free();) {
    std::vector<Eigenpair> more = further_modes(pencil, inverse, shift, modes, 1);
    is_new = more.front().value + shift < (1 - same) * (modes.back().value + shift);
    modes.push_back(std::move(more.front()));
    keep_lowest(modes, n_wanted);
  }
  Modes found;
  for (const Eigenpair& mode : modes) {
    found.frequencies.push_back(std::sqrt(std::max(mode.value, 0.0)) / (2 * std::numbers::pi));
    found.shapes.push_back(shape_of(mode.u));
  }
  return found;
}

StepReport Modal::step(State& state, const Loads& loads, const double dt) {
  StepReport report;
  report.modes = lowest_modes(model_, loads, state.time + dt, state.x, parameters_, report.n_iterations);
  state.v.assign(state.x.size(), Vec3::Zero());
  state.time += dt;
  return report;
}

} // namespace kerf::dynamics
