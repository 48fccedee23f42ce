/// Multigrid on what random and degenerate cuts leave of a body: after every sweep symmetric and positive, in the end
/// good for conjugate gradients.

#include "dynamics/conjugate_gradients.h"
#include "dynamics/state.h"
#include "fem/hexahedra.h"
#include "tests/fuzz/cases.h"
#include "tests/fuzz/specimens.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <optional>

namespace kerf::fuzz::multigrid_test {
namespace {

using dynamics::flat;

/// Of a body's copies, with its lowest tenth held.
class Equation {
 public:
  Equation(const grid::Solid& solid, const fem::Strain strain, const double nu, Random& random)
    : model_(solid, {.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = nu}, .strain = strain}),
      loads_(held_below(grid::rest_positions(solid))),
      constraints_(loads_, solid.complex.n_corners()),
      random_(random) {
    blocks_ = dynamics::stiffness_blocks(model_);
    double stiffness = 0, mass = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      stiffness += blocks_[i].trace();
      mass += 3 * model_.lumped_mass()[i];
    }
    constexpr double ratio = 1000; // of a step in which sound goes some ten cells
    mass_factor_ = stiffness / (ratio * mass);
    trace_ = stiffness + mass_factor_ * mass;
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      blocks_[i] += mass_factor_ * model_.lumped_mass()[i] * Mat3::Identity();
  }

  /// Throws where it is not symmetric or not positive. Not there where the body is so small, or so much dust, that
  /// there is no multigrid.
  bool has_sound_multigrid() {
    dynamics::Preconditioner* const own = multigrid();
    if (!own)
      return false;
    const Points r = draw(), s = draw();
    Points Br(r.size()), Bs(r.size());
    own->apply(flat(r), flat(Br));
    own->apply(flat(s), flat(Bs));
    const double rr = dot(r, Br), ss = dot(s, Bs);
    if (!(rr > 0 && ss > 0))
      throw std::logic_error("multigrid is not positive");
    if (!(std::abs(dot(r, Bs) - dot(s, Br)) < 1e-4 * std::sqrt(rr * ss)))
      throw std::logic_error("multigrid is not symmetric: " + std::to_string(dot(r, Bs)) + ", " +
                             std::to_string(dot(s, Br)));
    return true;
  }
  /// Of conjugate gradients, to 1e-6.
  int iterations() {
    dynamics::Preconditioner* const own = multigrid();
    const auto report = solve([own](const auto b, const auto z) { own->apply(b, z); }, draw());
    if (report.indefinite || !report.converged)
      throw std::logic_error("conjugate gradients with multigrid leave " + std::to_string(report.residual));
    return report.n_iterations;
  }
  int iterations_of_block_jacobi() {
    return solve([this](const auto b, const auto z) { apply_inverse_blocks(b, z); }, draw()).n_iterations;
  }

 private:
  dynamics::Preconditioner* multigrid() {
    return model_.preconditioner({mass_factor_, 1, model_.lumped_mass(), trace_, {}, constraints_});
  }
  static dynamics::Loads held_below(const Points& rest) {
    double lowest = 1e300, highest = -1e300;
    for (const Vec3& X : rest) {
      lowest = std::min(lowest, X[2]);
      highest = std::max(highest, X[2]);
    }
    dynamics::Loads loads;
    dynamics::Support& support = loads.supports.emplace_back();
    support.displacement = [](double) { return Vec3(Vec3::Zero()); };
    for (std::uint32_t c = 0; c < rest.size(); ++c)
      if (rest[c][2] < lowest + 0.1 * (highest - lowest)) {
        support.corners.push_back(c);
        support.rest.push_back(rest[c]);
      }
    return loads;
  }
  static double dot(const Points& a, const Points& b) { return dynamics::dot(flat(a), flat(b)); }

  Points draw() {
    Points r(blocks_.size());
    for (std::size_t i = 0; i < r.size(); ++i)
      r[i] = constraints_.freedom(i).project * (std::sqrt(blocks_[i].trace()) * support::random_vector(random_));
    return r;
  }
  void apply_inverse_blocks(const std::span<const double> r, const std::span<double> z) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const Mat3 S = dynamics::inverse_factor(blocks_[i], constraints_.freedom(i));
      Eigen::Map<Vec3>(z.data() + 3 * i) = S.transpose() * (S * Eigen::Map<const Vec3>(r.data() + 3 * i));
    }
  }
  dynamics::CgReport solve(const dynamics::Product& B, const Points& b) {
    const dynamics::Product A = [this](const auto p, const auto y) {
      model_.apply_stiffness(p, y);
      for (std::size_t i = 0; i < blocks_.size(); ++i) {
        Eigen::Map<Vec3> v(y.data() + 3 * i);
        v += mass_factor_ * model_.lumped_mass()[i] * Eigen::Map<const Vec3>(p.data() + 3 * i);
        v = (constraints_.freedom(i).project * v).eval();
      }
    };
    const dynamics::Product J = [this](const auto r, const auto z) { apply_inverse_blocks(r, z); };
    Points z(b.size()), x(b.size(), Vec3::Zero());
    J(flat(b), flat(z));
    return dynamics::conjugate_gradients({A, B, J}, flat(b), {.residual = 1e-6 * std::sqrt(dot(b, z))}, 2000, flat(x));
  }

  fem::Hexahedra model_;
  dynamics::Loads loads_;
  dynamics::Constraints constraints_;
  Random& random_;
  std::vector<Mat3> blocks_;
  double mass_factor_ = 0, trace_ = 0;
};

/// Every tenth case has a large body.
void judge_cases(const std::uint32_t first, const std::uint32_t end, const int least) {
  const Specimens specimens = own_specimens();
  Tally tally;
  Random random(5);
  int n_judged = 0, n_solved = 0, most = 0, sum = 0, sum_of_jacobi = 0;
  for (std::uint32_t seed = first; seed < end; ++seed)
    EXPECT_EQ(run(whole_case(seed), seed % 10 == 0 ? specimens.large : specimens.small, tally,
                  [&](const grid::Solid& solid, const bool is_last) {
                    Equation equation(solid, seed % 2 == 0 ? fem::Strain::trilinear : fem::Strain::enhanced,
                                      std::array{0.3, 0.45, 0.49}[seed % 3], random);
                    if (!equation.has_sound_multigrid())
                      return;
                    ++n_judged;
                    if (!is_last)
                      return;
                    ++n_solved;
                    const int n = equation.iterations();
                    most = std::max(most, n);
                    sum += n;
                    sum_of_jacobi += equation.iterations_of_block_jacobi();
                  })
                .failure,
              std::nullopt)
      << "case " << seed;
  std::cout << n_judged << " complexes; " << n_solved << " bodies in the end: " << double(sum) / n_solved
            << " iterations, at most " << most << "; block Jacobi " << double(sum_of_jacobi) / n_solved << '\n';
  EXPECT_GT(n_solved, least);
  EXPECT_GT(n_judged, 3 * n_solved);
  EXPECT_LT(3 * sum, sum_of_jacobi);
}

TEST(Fuzz, MultigridIsSymmetricAndPositive) { judge_cases(700, 730, 10); }
TEST(Fuzz, MultigridWithFrontsIsSymmetricAndPositive) {
  judge_cases(Case::first_seed_with_fronts + 700, Case::first_seed_with_fronts + 715, 5);
}
TEST(Fuzz, LongMultigridIsSymmetricAndPositive) { judge_cases(1000, 3000, 1000); }

} // namespace
} // namespace kerf::fuzz::multigrid_test
