/// What keeps springs from turning inside out, against its closed form, differences, and bodies that were turned.

#include "spring/inversion.h"

#include "dynamics/implicit_euler.h"
#include "spring/mass_spring.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/SparseCore>

#include <cmath>

namespace kerf::spring::inversion_test {
namespace {

using fem::Body;
using fem::Draw;

constexpr double E = 1e4, h = 0.1;

struct Block {
  explicit Block(const unsigned seed, const double cut = 0.2) : body(make(seed, cut)) {}

  static Body make(const unsigned seed, const double cut) {
    Draw draw(seed);
    Body body = fem::make_block({3, 3, 3}, h, draw, {0.05, 0.95});
    fem::cut_at_random(body, cut, draw, {0.05, 0.95});
    return body;
  }
  Inversion inversion() const { return {body, numbers, fill, E}; }

  Body body;
  grid::CornerNumbers numbers{body, grid::Counted::all};
  std::vector<double> fill = std::vector<double>(body.complex.n_copies(), 0.5);
};

/// Half of which is squashed, turned inside out, or crumpled.
Points squashed(const Block& block, Draw& draw) {
  Points x = block.body.rest();
  const Mat3 F = draw.rotation() * Vec3(0.9, 1.1, 0.2).asDiagonal();
  for (Vec3& p : x)
    p = F * p + 0.2 * h * draw.vector();
  return x;
}

TEST(Inversion, HasItsClosedFormBelowHalfTheVolumeAndNothingAbove) {
  const Block block(1);
  const Inversion inversion = block.inversion();
  for (const double J : {1.5, 1.0, 0.5, 0.4, 0.1, 0.0, -1.0}) {
    Draw draw(2);
    const Mat3 F = draw.rotation() * Vec3(1, 2, J / 2).asDiagonal() * draw.rotation();
    Points x = block.body.rest(), forces(x.size(), Vec3::Zero());
    for (Vec3& p : x)
      p = F * p;
    const double lost = std::max(0.0, 0.5 - J),
                 expected = 0.5 * E * 0.5 * h * h * h * static_cast<double>(block.fill.size()) * lost * lost;
    EXPECT_NEAR(inversion.energy(x), expected, 1e-9 * E * h * h * h) << J;
    inversion.add_force(x, forces);
    double largest = 0;
    for (const Vec3& f : forces)
      largest = std::max(largest, f.norm());
    EXPECT_EQ(largest > 1e-9 * E * h * h, J < 0.5) << J;
  }
}

TEST(Inversion, ForceAndMatrixAreDerivatives) {
  const Block block(3);
  const Inversion inversion = block.inversion();
  Draw draw(4);
  Points x = squashed(block, draw);
  const auto forces_at = [&](const Points& at) {
    Points forces(at.size(), Vec3::Zero());
    inversion.add_force(at, forces);
    return forces;
  };
  const Points forces = forces_at(x);
  std::vector<Eigen::Triplet<double>> entries;
  inversion.add_entries(x, dynamics::Tangent::exact, entries);
  const auto n = static_cast<Eigen::Index>(3 * x.size());
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  const double force = E * h * h, stiffness = E * h;
  constexpr double step = 1e-6;
  for (std::size_t c = 0; c < x.size(); c += 3)
    for (int i = 0; i < 3; ++i) {
      const double at = x[c][i];
      x[c][i] = at + step;
      const double energy_after = inversion.energy(x);
      const Points after = forces_at(x);
      x[c][i] = at - step;
      const double energy_before = inversion.energy(x);
      const Points before = forces_at(x);
      x[c][i] = at;
      EXPECT_NEAR(forces[c][i], (energy_before - energy_after) / (2 * step), 1e-6 * force);
      for (std::size_t d = 0; d < x.size(); ++d)
        for (int j = 0; j < 3; ++j)
          EXPECT_NEAR(K.coeff(static_cast<Eigen::Index>(3 * d + j), static_cast<Eigen::Index>(3 * c + i)),
                      (before[d][j] - after[d][j]) / (2 * step), 1e-5 * stiffness);
    }
}

/// The product, the blocks and the matrix are one, symmetric, and nowhere negative.
TEST(Inversion, ItsPositivePartIsOneMatrix) {
  const Block block(5);
  Inversion inversion = block.inversion();
  Draw draw(6);
  const Points x = squashed(block, draw);
  inversion.linearise(x);
  std::vector<Eigen::Triplet<double>> entries;
  inversion.add_entries(x, dynamics::Tangent::positive, entries);
  const auto n = static_cast<Eigen::Index>(3 * x.size());
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  ASSERT_GT(K.norm(), E * h);
  EXPECT_LT((Eigen::SparseMatrix<double>(K.transpose()) - K).norm(), 1e-12 * K.norm());
  std::vector<Mat3> blocks(x.size(), Mat3::Zero());
  inversion.add_diagonal(blocks);
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd p = Eigen::VectorXd::NullaryExpr(n, [&] { return draw.normal(); });
    Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
    inversion.add_product({p.data(), p.data() + n}, {y.data(), y.data() + n});
    EXPECT_LT((y - K * p).norm(), 1e-12 * K.norm() * p.norm());
    EXPECT_GE(p.dot(y), 0);
  }
  for (std::size_t c = 0; c < blocks.size(); ++c)
    EXPECT_LT((blocks[c] - Eigen::MatrixXd(K).block<3, 3>(3 * c, 3 * c)).norm(), 1e-12 * K.norm());
}

/// A body of which one half was turned into its mirror comes back to its own volume; springs alone are at rest there.
TEST(Inversion, MirroredBodiesComeBack) {
  for (const unsigned seed : {7u, 8u, 9u}) {
    const Block block(seed, 0);
    MassSpring model(block.body, {.youngs_modulus = E});
    dynamics::ImplicitEuler stepper(model, {});
    const Points rest = block.body.rest();
    Vec3 middle = Vec3::Zero();
    for (const Vec3& X : rest)
      middle += X / static_cast<double>(rest.size());
    Draw draw(seed);
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero())};
    for (Vec3& p : state.x) {
      p[0] = middle[0] + std::abs(p[0] - middle[0]);
      p += 0.02 * h * draw.vector();
    }
    for (int i = 0; i < 400; ++i)
      stepper.step(state, {.mass_damping = 5, .supports = {}}, 0.01);
    EXPECT_LT(model.energy(state.x), 1e-6 * E * h * h * h) << seed;
    EXPECT_EQ(Inversion(block.body, grid::CornerNumbers(block.body, grid::Counted::all), block.fill, E).energy(state.x), 0)
      << seed;
  }
}

} // namespace
} // namespace kerf::spring::inversion_test
