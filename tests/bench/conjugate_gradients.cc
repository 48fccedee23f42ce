/// What deal.II's conjugate gradients cost beside ours (dynamics/conjugate_gradients.h), with the same product and the
/// same multigrid: a cube of n x n x n cells whose lower side is held, in equilibrium, so many iterations from zero.
/// CPU time, medians of alternating runs, and what each leaves: bench_conjugate_gradients CELLS ITERATIONS.

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
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace kerf::fem {
namespace {

using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

std::span<const double> span(const Vector& v) { return {v.begin(), v.locally_owned_size()}; }
std::span<double> span(Vector& v) { return {v.begin(), v.locally_owned_size()}; }

/// As deal.II asks for a matrix, or a preconditioner.
struct Map : dealii::Subscriptor {
  dynamics::Product map;
  explicit Map(dynamics::Product of) : map(std::move(of)) {}
  void vmult(Vector& y, const Vector& x) const { map(span(x), span(y)); }
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void run(const int n, const int n_iterations) {
  Draw draw(1);
  const Body body = make_block({n, n, n}, 1.0 / n, draw, {0.3, 0.7});
  const Points rest = body.rest();
  Hexahedra model(body, {.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3}});
  dynamics::Loads loads;
  dynamics::Support floor{.corners = {}, .rest = {}, .displacement = [](double) { return Vec3(Vec3::Zero()); }};
  const double lowest = std::ranges::min(rest, {}, [](const Vec3& p) { return p[2]; })[2];
  for (std::uint32_t c = 0; c < rest.size(); ++c)
    if (rest[c][2] < lowest + 0.1 / n) {
      floor.corners.push_back(c);
      floor.rest.push_back(rest[c]);
    }
  loads.supports.push_back(floor);
  const dynamics::Constraints constraints(loads, rest.size());
  model.linearise(rest);
  const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
  double trace = 0;
  std::vector<Mat3> inverse(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    trace += blocks[i].trace();
    const Mat3 S = dynamics::inverse_factor(blocks[i], constraints.freedom(i));
    inverse[i] = S.transpose() * S;
  }
  dynamics::Preconditioner* const multigrid =
    model.preconditioner({0, 1, model.lumped_mass(), trace, {}, constraints});
  const auto of = [](const std::span<double> y, const std::size_t i) { return Eigen::Map<Vec3>(y.data() + 3 * i); };
  const dynamics::Product A = [&](const auto p, const auto y) {
    model.apply_stiffness(p, y);
    for (const std::uint32_t c : floor.corners)
      of(y, c).setZero();
  };
  const dynamics::Product B = [&](const auto r, const auto z) { multigrid->apply(r, z); };
  const dynamics::Product J = [&](const auto r, const auto z) {
    for (std::size_t i = 0; i < inverse.size(); ++i)
      of(z, i) = inverse[i] * Eigen::Map<const Vec3>(r.data() + 3 * i);
  };
  Vector b(static_cast<unsigned>(3 * rest.size())), x(b), left(b);
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (constraints.is_free(i))
      of(span(b), i) = Vec3(double(i % 7) - 3, double(i % 5) - 2, double(i % 11) - 5);
  const Map matrix(A), preconditioner(B);
  const auto seconds_of = [](const auto& solve) {
    const double start = double(std::clock()) / CLOCKS_PER_SEC;
    solve();
    return double(std::clock()) / CLOCKS_PER_SEC - start;
  };
  const auto left_of = [&] {
    A(span(x), span(left));
    left.sadd(-1, b);
    return left.l2_norm() / b.l2_norm();
  };
  std::vector<double> theirs, own;
  double left_by_theirs = 0, left_by_own = 0;
  for (int k = 0; k < 15; ++k) {
    x = 0;
    theirs.push_back(seconds_of([&] {
      dealii::IterationNumberControl control(static_cast<unsigned>(n_iterations), 1e-300);
      dealii::SolverCG<Vector>(control).solve(matrix, x, b, preconditioner);
    }));
    left_by_theirs = left_of();
    x = 0;
    own.push_back(
      seconds_of([&] { dynamics::conjugate_gradients({A, B, J}, span(b), {}, n_iterations, span(x)); }));
    left_by_own = left_of();
  }
  std::printf("%8zu elements, %d iterations: deal.II %.3f ms, residual %.3g; own %.3f ms, %.3g\n", model.n_elements(),
              n_iterations, 1e3 * median(theirs), left_by_theirs, 1e3 * median(own), left_by_own);
}

} // namespace
} // namespace kerf::fem

int main(const int argc, char** const argv) {
  kerf::set_n_threads(1);
  kerf::fem::run(argc > 1 ? std::atoi(argv[1]) : 22, argc > 2 ? std::atoi(argv[2]) : 7);
}
