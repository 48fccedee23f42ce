#include "pba/model.h"

#include "base/error.h"
#include "base/parallel.h"
#include "tests/pba/clouds.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>

namespace kerf::pba::model_test {
namespace {

using dynamics::flat;

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

struct Case {
  const char* name;
  Points rest;
};

/// Clouds of every rank, regular and not.
std::vector<Case> clouds() {
  Draw draw(1);
  Points sheet, row;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      sheet.push_back(Vec3(0.3, 0.1, 0) * i + Vec3(-0.1, 0.2, 0.3) * j + 0.01 * draw.vector()[0] * Vec3(0.3, 0.1, 0));
  for (int i = 0; i < 5; ++i)
    row.push_back(i * Vec3(0.2, 0.1, -0.3));
  Points thin = grid_points({4, 4, 2}, 0.1, 0.3, draw);
  for (Vec3& p : thin)
    p[2] *= 0.15; // between one rank and the other
  return {{"lattice", grid_points({3, 4, 3}, 0.1, 0, draw)},
          {"jittered", grid_points({4, 3, 4}, 0.1, 0.6, draw)},
          {"random", random_points(40, draw)},
          {"thin", thin},
          {"sheet", sheet},
          {"row", row},
          {"two", {Vec3::Zero(), Vec3(0.1, 0.2, 0.1)}}};
}

PhyxelModel make_model(const Points& rest, const ModelOptions& options = {}) {
  return {make_phyxels(rest, 0.01, 12), rubber, options};
}

/// Some sights faded, some gone.
std::vector<Sight> faded(const PhyxelModel& model, Draw& draw) {
  auto sights = clear_sights(model.phyxels().rest, model.phyxels().rest, model.neighbours().pairs);
  for (Sight& sight : sights)
    sight.factor = std::max(0.0, draw(-0.5, 1));
  return sights;
}

TEST(Model, ReproducesLinearFieldsOnEveryCloudOfFullRank) {
  Draw draw(2);
  for (int n = 0; n < 200; ++n) {
    const PhyxelModel model({make_phyxels(random_points(5 + n % 40, draw), 1, 4 + n % 20), rubber, {}});
    const Mat3 G = draw.matrix();
    const Points x = mapped(model.phyxels().rest, G, draw.vector());
    std::vector<Mat3> F;
    model.deformation(x, F);
    std::size_t n_full = 0;
    for (std::size_t i = 0; i < F.size(); ++i)
      if (model.fits()[i].determinant == 1) {
        EXPECT_LT((F[i] - G).norm(), 1e-10);
        ++n_full;
      }
    if (n % 20 > 4) {
      EXPECT_GE(2 * n_full, F.size());
    }
  }
}

TEST(Model, HasTheEnergyOfAHomogeneousBody) {
  Draw draw(3);
  const PhyxelModel model = make_model(grid_points({5, 4, 3}, 0.1, 0.5, draw));
  for (const double share : {0.0, 0.4, 1.0}) {
    const PhyxelModel shared = make_model(model.phyxels().rest, {.volume_share = share});
    const Mat3 F = Mat3::Identity() + 0.1 * draw.matrix();
    const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
    const double J = F.determinant(), lambda = rubber.lambda();
    const double expected =
      0.01 * (rubber.mu() * E.squaredNorm() + 0.5 * (1 - share) * lambda * std::pow(E.trace(), 2) +
              0.5 * share * lambda * std::pow(J - 1, 2));
    EXPECT_NEAR(shared.energy(mapped(model.phyxels().rest, F, draw.vector())), expected, 1e-10 * expected);
  }
}

/// Small strains meet Lame's parameters whatever the share: here against the closed form of linear elasticity.
TEST(Model, MeetsHookesLawForEveryVolumeShare) {
  Draw draw(4);
  const Points rest = grid_points({4, 4, 4}, 0.1, 0.5, draw);
  for (const double share : {0.0, 0.5, 1.0}) {
    const PhyxelModel model = make_model(rest, {.volume_share = share});
    const Mat3 G = 1e-5 * draw.matrix(), e = 0.5 * (G + G.transpose());
    const double expected = 0.01 * (rubber.mu() * e.squaredNorm() + 0.5 * rubber.lambda() * std::pow(e.trace(), 2));
    EXPECT_NEAR(model.energy(mapped(rest, Mat3::Identity() + G, Vec3::Zero())), expected, 1e-3 * expected);
  }
}

TEST(Model, RigidMotionCostsNothing) {
  Draw draw(5);
  for (const Case& cloud : clouds()) {
    PhyxelModel model = make_model(cloud.rest);
    for (const bool cut : {false, true}) {
      if (cut)
        model.update(faded(model, draw));
      const Points x = mapped(cloud.rest, draw.rotation(), draw.vector());
      Points forces;
      model.force(x, forces);
      EXPECT_LT(greatest(forces), 1e-8) << cloud.name << " cut " << cut; // N, at forces of 1 to 100 when deformed
      EXPECT_LT(model.energy(x), 1e-12) << cloud.name << " cut " << cut;
    }
  }
}

TEST(Model, ForceIsTheDerivativeOfTheEnergy) {
  Draw draw(6);
  for (const Case& cloud : clouds())
    for (const bool cut : {false, true}) {
      PhyxelModel model = make_model(cloud.rest, {.stabilisation = 0.3, .volume_share = 0.6});
      if (cut)
        model.update(faded(model, draw));
      Points x = disturbed(mapped(cloud.rest, draw.rotation(), draw.vector()), 0.02, draw), forces;
      model.force(x, forces);
      const double eps = 1e-6;
      for (std::size_t k = 0; k < 3 * x.size(); ++k) {
        const double at = flat(x)[k];
        flat(x)[k] = at + eps;
        const double above = model.energy(x);
        flat(x)[k] = at - eps;
        const double below = model.energy(x);
        flat(x)[k] = at;
        EXPECT_NEAR(-(above - below) / (2 * eps), flat(forces)[k], 1e-6 * (greatest(forces) + 1e-3))
          << cloud.name << " cut " << cut;
      }
    }
}

TEST(Model, ForcesKeepMomentumAndAngularMomentum) {
  Draw draw(7);
  for (const Case& cloud : clouds())
    for (const bool cut : {false, true}) {
      PhyxelModel model = make_model(cloud.rest);
      if (cut)
        model.update(faded(model, draw));
      const Points x = disturbed(cloud.rest, 0.03, draw);
      Points forces;
      model.force(x, forces);
      const double scale = greatest(forces) * static_cast<double>(x.size());
      EXPECT_LE(total(forces).norm(), 1e-14 * scale) << cloud.name;
      EXPECT_LE(torque(x, forces).norm(), 1e-11 * scale) << cloud.name;
    }
}

Eigen::MatrixXd assembled(const PhyxelModel& model) {
  const auto n = static_cast<Eigen::Index>(3 * model.lumped_mass().size());
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    p[i] = 1;
    model.apply_stiffness({p.data(), p.data() + n}, {K.col(i).data(), K.col(i).data() + n});
    p[i] = 0;
  }
  return K;
}

TEST(Model, ExactTangentIsTheDerivativeOfTheForce) {
  Draw draw(8);
  for (const Case& cloud : clouds()) {
    PhyxelModel model = make_model(cloud.rest, {.volume_share = 0.6, .tangent = dynamics::Tangent::exact});
    model.update(faded(model, draw));
    Points x = disturbed(cloud.rest, 0.01, draw), above, below;
    model.linearise(x);
    const Eigen::MatrixXd K = assembled(model);
    Eigen::MatrixXd differences(K.rows(), K.cols());
    const double eps = 1e-6;
    for (std::size_t k = 0; k < 3 * x.size(); ++k) {
      const double at = flat(x)[k];
      flat(x)[k] = at + eps;
      model.force(x, above);
      flat(x)[k] = at - eps;
      model.force(x, below);
      flat(x)[k] = at;
      for (std::size_t l = 0; l < 3 * x.size(); ++l)
        differences(l, k) = -(flat(above)[l] - flat(below)[l]) / (2 * eps);
    }
    EXPECT_LT((differences - K).norm(), 1e-7 * K.norm()) << cloud.name;
    EXPECT_LT((K - K.transpose()).norm(), 1e-13 * K.norm()) << cloud.name;
  }
}

TEST(Model, PositiveTangentIsSymmetricAndPositiveSemiDefiniteWithItsBlocks) {
  Draw draw(10);
  for (const Case& cloud : clouds())
    for (const auto tangent : {dynamics::Tangent::positive, dynamics::Tangent::exact}) {
      PhyxelModel model = make_model(cloud.rest, {.volume_share = 0.6, .tangent = tangent});
      model.update(faded(model, draw));
      model.linearise(disturbed(mapped(cloud.rest, 0.7 * draw.rotation(), Vec3::Zero()), 0.03, draw));
      const Eigen::MatrixXd K = assembled(model);
      EXPECT_LT((K - K.transpose()).norm(), 1e-13 * K.norm()) << cloud.name;
      if (tangent == dynamics::Tangent::positive) {
        const Eigen::VectorXd eigenvalues = support::spectrum(K);
        EXPECT_GT(eigenvalues[0], -1e-12 * K.norm()) << cloud.name;
      }
      const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
      for (std::size_t i = 0; i < blocks.size(); ++i)
        EXPECT_LT((blocks[i] - K.block<3, 3>(3 * i, 3 * i)).norm(), 1e-12 * K.norm()) << cloud.name;
    }
}

TEST(Model, PositiveTangentIsExactAtRest) {
  Draw draw(11);
  const Points rest = grid_points({4, 3, 3}, 0.1, 0.5, draw);
  const PhyxelModel positive = make_model(rest), exact = make_model(rest, {.tangent = dynamics::Tangent::exact});
  const Eigen::MatrixXd K = assembled(exact);
  EXPECT_LT((assembled(positive) - K).norm(), 1e-14 * K.norm());
}

/// Six rigid modes, and no other that costs nothing, once gradients see every phyxel or the penalty does.
TEST(Model, StabilisationLeavesOnlyRigidModes) {
  Draw draw(12);
  for (const double jitter : {0.0, 0.5}) {
    const Points rest = grid_points({5, 4, 4}, 0.1, jitter, draw);
    double lowest[2];
    for (const double c : {0.0, 1.0}) {
      const PhyxelModel model = make_model(rest, {.stabilisation = c});
      const Eigen::VectorXd spectrum = support::spectrum(assembled(model));
      EXPECT_LT(spectrum.head<6>().cwiseAbs().maxCoeff(), 1e-12 * spectrum.maxCoeff());
      lowest[c > 0] = spectrum[6] / spectrum.maxCoeff();
      record("seventh eigenvalue, jitter " + to_text(jitter) + ", c " + to_text(c), lowest[c > 0]);
    }
    EXPECT_GT(lowest[1], 1e-3);
  }
}

TEST(Model, HalvesThatSeeNothingOfEachOtherFeelNothing) {
  Draw draw(13);
  const Points rest = grid_points({6, 4, 4}, 0.1, 0.4, draw);
  PhyxelModel model = make_model(rest);
  auto sights = clear_sights(rest, rest, model.neighbours().pairs);
  const auto is_left = [&](const std::size_t i) { return rest[i][0] < 0.3; };
  for (std::size_t p = 0; p < sights.size(); ++p)
    if (is_left(model.neighbours().pairs[p][0]) != is_left(model.neighbours().pairs[p][1]))
      sights[p].factor = 0;
  model.update(sights);
  Points x = disturbed(rest, 0.01, draw), before, after;
  model.force(x, before);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!is_left(i))
      x[i] += 0.05 * draw.vector();
  model.force(x, after);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (is_left(i)) {
      EXPECT_EQ(before[i], after[i]);
    }
}

/// The largest change of a force from step to step over the largest force, while sights fade away in n steps: all of
/// one phyxel's, and of the others those that cross a plane.
double largest_jump(const int n) {
  Draw draw(14);
  const Points rest = grid_points({4, 4, 3}, 0.1, 0.4, draw), x = disturbed(rest, 0.01, draw);
  PhyxelModel model = make_model(rest);
  auto sights = clear_sights(rest, rest, model.neighbours().pairs);
  Points last, forces;
  double jump = 0, largest_force = 0;
  for (int step = 0; step <= n; ++step) {
    for (std::size_t p = 0; p < sights.size(); ++p) {
      const auto [i, j] = model.neighbours().pairs[p];
      if (i == 20 || j == 20 || (rest[i][0] < 0.2) != (rest[j][0] < 0.2))
        sights[p].factor = 1 - static_cast<double>(step) / n;
    }
    model.update(sights);
    model.force(x, forces);
    largest_force = std::max(largest_force, greatest(forces));
    for (std::size_t i = 0; step > 0 && i < x.size(); ++i)
      jump = std::max(jump, (forces[i] - last[i]).norm());
    last = forces;
  }
  return jump / largest_force;
}

/// The finer the steps the smaller the jumps: none of them is the model's.
TEST(Model, ForcesAreContinuousWhileSightsFade) {
  const double coarse = largest_jump(500), fine = largest_jump(5000);
  record("in 500 steps", coarse);
  record("in 5000 steps", fine);
  EXPECT_LT(fine, 0.15 * coarse);
}

TEST(Model, ALonePhyxelMovesAsARigidPoint) {
  Draw draw(15);
  const Points rest = grid_points({3, 3, 3}, 0.1, 0.4, draw);
  PhyxelModel model = make_model(rest);
  auto sights = clear_sights(rest, rest, model.neighbours().pairs);
  for (std::size_t p = 0; p < sights.size(); ++p)
    if (model.neighbours().pairs[p][0] == 13 || model.neighbours().pairs[p][1] == 13)
      sights[p].factor = 0;
  model.update(sights);
  const Points x = disturbed(mapped(rest, draw.rotation(), draw.vector()), 0.01, draw);
  Points forces;
  model.force(x, forces);
  EXPECT_EQ(forces[13], Vec3(Vec3::Zero()));
  EXPECT_GT(greatest(forces), 0.1);
  std::vector<Mat3> F;
  model.deformation(x, F);
  EXPECT_EQ(F[13], Mat3(Mat3::Identity()));
}

/// A sheet carries its normal along, a row turns with its line; neither has a strain in a rigid motion.
TEST(Model, CompletesGradientsOfDeficientClouds) {
  Draw draw(16);
  for (const Case& cloud : clouds()) {
    const PhyxelModel model = make_model(cloud.rest);
    const Mat3 R = draw.rotation();
    std::vector<Mat3> F;
    model.deformation(mapped(cloud.rest, R, draw.vector()), F);
    for (std::size_t i = 0; i < F.size(); ++i) {
      EXPECT_NEAR(F[i].determinant(), 1, 1e-9) << cloud.name;
      EXPECT_LT((F[i].transpose() * F[i] - Mat3::Identity()).norm(), 1e-5) << cloud.name;
      const auto& neighbours = model.neighbours();
      for (auto k = neighbours.start[i]; k < neighbours.start[i + 1]; ++k) {
        const Vec3 offset = cloud.rest[neighbours.phyxel[k]] - cloud.rest[i];
        EXPECT_LT((F[i] * offset - R * offset).norm(), 1e-5 * offset.norm()) << cloud.name;
      }
    }
  }
}

TEST(Model, UpdatesAsIfMadeAnew) {
  Draw draw(17);
  const Points rest = grid_points({4, 4, 3}, 0.1, 0.4, draw), x = disturbed(rest, 0.02, draw);
  PhyxelModel stepwise = make_model(rest), at_once = make_model(rest);
  for (int n = 0; n < 3; ++n)
    stepwise.update(faded(stepwise, draw));
  const auto sights = faded(stepwise, draw);
  stepwise.update(sights);
  at_once.update(sights);
  Points a, b;
  stepwise.force(x, a);
  at_once.force(x, b);
  EXPECT_EQ(a, b);
}

TEST(Model, GivesTheSameBitsOnOneAndTwoThreads) {
  Draw draw(18);
  const Points rest = grid_points({12, 8, 8}, 0.1, 0.4, draw), x = disturbed(rest, 0.02, draw);
  Points forces[2], products[2];
  double energies[2];
  const int n = n_threads();
  for (const int threads : {1, 2}) {
    set_n_threads(threads);
    PhyxelModel model = make_model(rest);
    Draw same(19);
    model.update(faded(model, same));
    model.force(x, forces[threads - 1]);
    energies[threads - 1] = model.energy(x);
    model.linearise(x);
    products[threads - 1].resize(x.size());
    model.apply_stiffness(flat(x), flat(products[threads - 1]));
  }
  set_n_threads(n);
  EXPECT_EQ(forces[0], forces[1]);
  EXPECT_EQ(products[0], products[1]);
  EXPECT_EQ(energies[0], energies[1]);
}

TEST(Model, RefusesOptionsOutOfRange) {
  Draw draw(20);
  const Points rest = grid_points({3, 3, 3}, 0.1, 0.4, draw);
  EXPECT_THROW(make_model(rest, {.stabilisation = -1}), ParameterError);
  EXPECT_THROW(make_model(rest, {.volume_share = 1.5}), ParameterError);
  EXPECT_THROW(make_model(rest, {.rank_threshold = 0}), ParameterError);
  EXPECT_THROW(make_model(rest, {.stabilisation = std::nan("")}), ParameterError);
}

} // namespace
} // namespace kerf::pba::model_test
