/// What deal.II's conjugate gradients cost beside ours (dynamics/conjugate_gradients.h), with the same product and the
/// same multigrid: a cube of n x n x n cells whose lower side is held, under its weight. First so many iterations from
/// zero, in equilibrium; then a step of implicit Euler until the error in the energy norm is a part of the solution,
/// where deal.II's stops as soon as it could know: by r.Br, which it has once it has moved on. CPU time, medians of
/// alternating runs, and what each leaves: bench_conjugate_gradients CELLS ITERATIONS STEP.

#include "base/parallel.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/constraints.h"
#include "dynamics/state.h"
#include "fem/hexahedra.h"
#include "tests/fem/bodies.h"

#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>

namespace kerf::fem {
namespace {

using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
using SolverCG = dealii::SolverCG<Vector>;

std::span<const double> span(const Vector& v) { return {v.begin(), v.locally_owned_size()}; }
std::span<double> span(Vector& v) { return {v.begin(), v.locally_owned_size()}; }

/// As deal.II asks for a matrix, or a preconditioner.
struct Map : dealii::Subscriptor {
  dynamics::Product map;
  explicit Map(dynamics::Product of) : map(std::move(of)) {}
  void vmult(Vector& y, const Vector& x) const { map(span(x), span(y)); }
};

/// Ends once the error is as small as wanted by the rule of ours for a known r.Br (dynamics/conjugate_gradients.h).
struct UntilErrorIs : dealii::SolverControl {
  UntilErrorIs(const double error, const std::vector<double>& rz, const double& alpha)
    : SolverControl(1000, 0), square(error * error), rz(rz), alpha(alpha) {}
  State check(const unsigned step, const double value) override {
    if (SolverControl::check(step, value) == failure)
      return failure;
    largest = step > 1 ? std::max(largest, alpha) : 0;
    if (rz.size() < 2)
      return iterate;
    const std::size_t n = rz.size();
    const double q = n == 2 ? rz[1] / rz[0] : std::max(rz[n - 1] / rz[n - 2], rz[n - 2] / rz[n - 3]);
    const double bound_is_low = n == 2 ? 10 : 4;
    return q < 1 && bound_is_low * largest * rz.back() / (1 - q) <= square ? success : iterate;
  }
  double square, largest = 0;
  const std::vector<double>& rz; ///< r.Br of all iterates so far
  const double& alpha;           ///< of the iteration before the last one
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

double seconds_of(const auto& solve) {
  const double start = double(std::clock()) / CLOCKS_PER_SEC;
  solve();
  return double(std::clock()) / CLOCKS_PER_SEC - start;
}

/// A cube, and its equation at rest with m times its mass.
class Cube {
 public:
  Cube(const int n, const double m) {
    Draw draw(1);
    const Body body = make_block({n, n, n}, 1.0 / n, draw, {0.3, 0.7});
    const Points rest = body.rest();
    model_.emplace(
      body, HexahedraOptions{.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3}});
    dynamics::Support floor{.corners = {}, .rest = {}, .displacement = [](double) { return Vec3(Vec3::Zero()); }};
    const double lowest = std::ranges::min(rest, {}, [](const Vec3& p) { return p[2]; })[2];
    for (std::uint32_t c = 0; c < rest.size(); ++c)
      if (rest[c][2] < lowest + 0.1 / n) {
        floor.corners.push_back(c);
        floor.rest.push_back(rest[c]);
      }
    loads_.supports.push_back(floor);
    constraints_.emplace(loads_, rest.size());
    model_->linearise(rest);
    const auto mass = model_->lumped_mass();
    std::vector<Mat3> blocks = dynamics::stiffness_blocks(*model_);
    double trace = 0;
    inverse_.resize(blocks.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      trace += blocks[i].trace();
      blocks[i] += m * mass[i] * Mat3::Identity();
      const Mat3 S = dynamics::inverse_factor(blocks[i], constraints_->freedom(i));
      inverse_[i] = S.transpose() * S;
    }
    multigrid_ = model_->preconditioner({m, 1, mass, trace, {}, *constraints_});
    equation = {.A =
                  [this, m](const auto p, const auto y) {
                    model_->apply_stiffness(p, y);
                    for (std::size_t i = 0; i < inverse_.size() && m > 0; ++i)
                      of(y, i) += m * model_->lumped_mass()[i] * Eigen::Map<const Vec3>(p.data() + 3 * i);
                    for (const std::uint32_t c : loads_.supports[0].corners)
                      of(y, c).setZero();
                  },
                .B = [this](const auto r, const auto z) { multigrid_->apply(r, z); },
                .J =
                  [this](const auto r, const auto z) {
                    for (std::size_t i = 0; i < inverse_.size(); ++i)
                      of(z, i) = inverse_[i] * Eigen::Map<const Vec3>(r.data() + 3 * i);
                  }};
    weight.reinit(static_cast<unsigned>(3 * rest.size()));
    for (std::size_t i = 0; i < rest.size(); ++i)
      if (constraints_->is_free(i))
        of(span(weight), i) = Vec3(0, 0, -9.81 * mass[i]);
  }
  Cube(const Cube&) = delete;

  std::size_t n_elements() const { return model_->n_elements(); }
  bool has_multigrid() const { return multigrid_ != nullptr; }
  double energy_norm(const Vector& x) const {
    Vector Ax(x);
    equation.A(span(x), span(Ax));
    return std::sqrt(x * Ax);
  }

  dynamics::CgEquation equation;
  Vector weight;

 private:
  static Eigen::Map<Vec3> of(const std::span<double> y, const std::size_t i) {
    return Eigen::Map<Vec3>(y.data() + 3 * i);
  }

  std::optional<Hexahedra> model_;
  dynamics::Loads loads_;
  std::optional<dynamics::Constraints> constraints_;
  std::vector<Mat3> inverse_;
  dynamics::Preconditioner* multigrid_ = nullptr;
};

constexpr int n_runs = 15;

void run_iterations(const int n, const int n_iterations) {
  const Cube cube(n, 0);
  const Vector& b = cube.weight;
  Vector x(b), left(b);
  const Map matrix(cube.equation.A), preconditioner(cube.equation.B);
  const auto left_of = [&] {
    cube.equation.A(span(x), span(left));
    left.sadd(-1, b);
    return left.l2_norm() / b.l2_norm();
  };
  std::vector<double> theirs, own;
  double left_by_theirs = 0, left_by_own = 0;
  for (int k = 0; k < n_runs; ++k) {
    x = 0;
    theirs.push_back(seconds_of([&] {
      dealii::IterationNumberControl control(static_cast<unsigned>(n_iterations), 1e-300);
      SolverCG(control).solve(matrix, x, b, preconditioner);
    }));
    left_by_theirs = left_of();
    x = 0;
    own.push_back(
      seconds_of([&] { dynamics::conjugate_gradients(cube.equation, span(b), {}, n_iterations, span(x)); }));
    left_by_own = left_of();
  }
  std::printf("%zu elements, equilibrium, %d iterations: deal.II %.3f ms, residual %.3g; own %.3f ms, %.3g\n",
              cube.n_elements(), n_iterations, 1e3 * median(theirs), left_by_theirs, 1e3 * median(own), left_by_own);
}

void run_to_errors(const int n, const double dt) {
  const Cube cube(n, 1 / (dt * dt));
  if (!cube.has_multigrid()) {
    std::printf("%zu elements, a step of %g s: too soft for multigrid\n", cube.n_elements(), dt);
    return;
  }
  const Vector& b = cube.weight;
  Vector exact(b), x(b);
  exact = 0;
  dynamics::conjugate_gradients(cube.equation, span(b), {.residual = 0, .error = 0}, 60, span(exact));
  const double way = cube.energy_norm(exact);
  const auto error = [&] {
    x -= exact;
    return cube.energy_norm(x) / way;
  };
  for (const double part : {1e-1, 1e-2, 1e-3, 1e-6}) {
    std::vector<double> theirs, own;
    double error_of_theirs = 0, error_of_own = 0;
    int n_theirs = 0, n_own = 0;
    for (int k = 0; k < n_runs; ++k) {
      x = 0;
      theirs.push_back(seconds_of([&] {
        std::vector<double> rz;
        double alpha = 0;
        const Map matrix(cube.equation.A), preconditioner([&](const auto r, const auto z) {
          cube.equation.B(r, z);
          rz.push_back(dynamics::dot(r, z));
        });
        UntilErrorIs control(part * way, rz, alpha);
        SolverCG solver(control);
        solver.connect_coefficients_slot([&](const double a, double) { alpha = a; });
        solver.solve(matrix, x, b, preconditioner);
        n_theirs = static_cast<int>(control.last_step());
      }));
      error_of_theirs = error();
      x = 0;
      own.push_back(seconds_of([&] {
        const auto report = dynamics::conjugate_gradients(cube.equation, span(b), {.error = part * way}, 1000, span(x));
        n_own = report.n_iterations;
      }));
      error_of_own = error();
    }
    std::printf("%zu elements, a step of %g s, error at most %g: deal.II %d iterations, %.3f ms, error %.2g; "
                "own %d, %.3f ms, %.2g\n",
                cube.n_elements(), dt, part, n_theirs, 1e3 * median(theirs), error_of_theirs, n_own, 1e3 * median(own),
                error_of_own);
  }
}

} // namespace
} // namespace kerf::fem

int main(const int argc, char** const argv) {
  kerf::set_n_threads(1);
  const int n = argc > 1 ? std::atoi(argv[1]) : 22;
  kerf::fem::run_iterations(n, argc > 2 ? std::atoi(argv[2]) : 7);
  kerf::fem::run_to_errors(n, argc > 3 ? std::atof(argv[3]) : 1.0 / 60);
}
