#include "dynamics/state.h"
#include "surface/surface.h"
#include "tests/fem/models.h"
#include "tests/fem/quadrature.h"

#include "material/polar.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace kerf::fem::force_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

/// Each law with each kind of strain, on bodies of full cubes, of cells filled in part, and cut ones; each with a state
/// far from rest.
struct Case {
  Body body;
  HexahedraOptions options;
  Points x;
};

Case make_case(const std::string& law, const Strain strain, const unsigned n) {
  Draw draw(40 + n);
  const std::array boundaries = {Boundary::full_cube, Boundary::octants, Boundary::octants, Boundary::volume_fraction};
  Case one{make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8}),
           {.material = with_law(rubber, law), .boundary = boundaries[n % 4], .strain = strain},
           {}};
  if (n % 4 >= 2)
    cut_at_random(one.body, 0.4, draw, {0.2, 0.8});
  Mat3 F = draw.rotation();
  if (n >= 4)
    F = F * Vec3(1.3, 0.9, 0.7).asDiagonal();
  for (const Vec3& X : one.body.rest())
    one.x.push_back(F * X + 0.015 * draw.vector());
  return one;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  unsigned n = 0;
  for (const std::string& law : all_laws)
    for (const Strain strain : all_strains)
      for (int i = 0; i < 3; ++i)
        all.push_back(make_case(law, strain, n++ % 8));
  return all;
}

/// Those of laws that turn with the frame.
std::vector<Case> objective_cases() {
  std::vector<Case> all = cases();
  std::erase_if(all, [](const Case& one) { return one.options.material.law == "small strain"; });
  return all;
}

Hexahedra model_of(const Case& one) { return make_model(one.body, one.options); }

/// Central differences of fourth order.
TEST(Force, IsMinusTheGradientOfTheEnergy) {
  double worst = 0;
  for (const Case& one : cases()) {
    const Hexahedra model = model_of(one);
    Points force, x = one.x;
    model.force(x, force);
    const double step = 1e-4 * one.body.grid.h();
    double error = 0, size = 0;
    for (std::size_t i = 0; i < 3 * x.size(); ++i) {
      const double at = dynamics::flat(one.x)[i];
      const auto energy_at = [&](const double offset) {
        dynamics::flat(x)[i] = at + offset;
        return model.energy(x);
      };
      const double derivative =
        (8 * (energy_at(step) - energy_at(-step)) - (energy_at(2 * step) - energy_at(-2 * step))) / (12 * step);
      dynamics::flat(x)[i] = at;
      error = std::max(error, std::abs(derivative + dynamics::flat(force)[i]));
      size = std::max(size, std::abs(derivative));
    }
    worst = std::max(worst, error / size);
  }
  EXPECT_LT(worst, 1e-7);
  RecordProperty("worst", std::to_string(worst * 1e10) + "e-10");
}

TEST(Force, HasNoResultantAndNoTorque) {
  for (const Case& one : objective_cases()) {
    Points force;
    model_of(one).force(one.x, force);
    Vec3 total = Vec3::Zero(), torque = Vec3::Zero();
    double size = 0;
    for (std::size_t c = 0; c < force.size(); ++c) {
      total += force[c];
      torque += one.x[c].cross(force[c]);
      size += force[c].norm();
    }
    EXPECT_GT(size, 0.1);
    EXPECT_LT(total.norm(), 1e-13 * size);
    EXPECT_LT(torque.norm(), 1e-13 * size);
  }
}

TEST(Force, TurnsWithTheBodyAndEnergyStays) {
  Draw draw(60);
  for (const Case& one : objective_cases()) {
    const Hexahedra model = model_of(one);
    const Mat3 Q = draw.rotation();
    const Vec3 shift = draw.vector();
    Points moved, force, moved_force;
    for (const Vec3& p : one.x)
      moved.push_back(Q * p + shift);
    EXPECT_NEAR(model.energy(moved) / model.energy(one.x), 1, 1e-12);
    model.force(one.x, force);
    model.force(moved, moved_force);
    double size = 0, error = 0;
    for (std::size_t c = 0; c < force.size(); ++c) {
      size = std::max(size, force[c].norm());
      error = std::max(error, (moved_force[c] - Q * force[c]).norm());
    }
    EXPECT_LT(error, 1e-11 * size);
  }
}

TEST(Force, AndEnergyVanishUnderRigidMotion) {
  Draw draw(61);
  for (const Case& one : objective_cases()) {
    const Hexahedra model = model_of(one);
    const Mat3 Q = draw.rotation();
    Points moved, force;
    for (const Vec3& X : one.body.rest())
      moved.push_back(Q * X + Vec3(1, 2, 3));
    model.force(moved, force);
    for (const Vec3& f : force)
      EXPECT_LT(f.norm(), 1e-14 * rubber.youngs_modulus);
    EXPECT_LT(model.energy(moved), 1e-16 * rubber.youngs_modulus); // round-off of the terms of the law
  }
}

/// A state of uniform strain has the energy of its strain, in every body cut at random: volume times density of energy.
TEST(Force, UniformStretchHasItsEnergy) {
  Draw draw(62);
  for (const Case& one : cases()) {
    const Mat3 F = draw.rotation() * Vec3(1.2, 0.9, 1.05).asDiagonal();
    Points x;
    for (const Vec3& X : one.body.rest())
      x.push_back(F * X);
    const Hexahedra model = model_of(one);
    const double density = std::visit([&](const auto& law) { return law.energy(F); }, model.law());
    EXPECT_NEAR(model.energy(x) / (density * model.volume()), 1, 1e-12) << name_of(one.options);
  }
}

/// Written out: the law at the mean deformation gradient, and Hooke's stiffness against the rest in the turned frame.
TEST(Force, EnergyIsThatOfTheLawAndOfTheHourglass) {
  for (const Case& one : objective_cases()) {
    const Hexahedra model = model_of(one);
    double expected = model.ghost_penalty().energy(one.x);
    for (std::size_t e = 0; e < model.n_elements(); ++e) {
      const grid::Copy& copy = one.body.complex.copies[grid::CopyId(e)];
      const Mat3 F = model.deformation_gradient(e, one.x), R = material::rotation_of(F);
      expected += model.element(e).volume * std::visit([&](const auto& law) { return law.energy(F); }, model.law());
      Vector24 g;
      for (int a = 0; a < 8; ++a)
        g.segment<3>(3 * a) =
          R.transpose() * (one.x[copy.corners[a].value] - F * one.body.rest()[copy.corners[a].value]);
      expected += 0.5 * g.dot(stiffness(model.element(e), one.options.material, Part::hourglass) * g);
    }
    EXPECT_NEAR(model.energy(one.x) / expected, 1, 1e-11) << name_of(one.options);
  }
}

/// The exact matrix is the derivative of the forces, the other one positive and the one that products are made with.
TEST(Force, StiffnessMatrixIsItsDerivative) {
  for (const Case& one : cases()) {
    Hexahedra model = model_of(one);
    const Eigen::MatrixXd exact = model.stiffness_matrix(one.x, dynamics::Tangent::exact);
    EXPECT_LT((exact - exact.transpose()).norm(), 1e-13 * exact.norm());
    Draw draw(67);
    Points d(one.x.size()), x = one.x, f;
    for (Vec3& v : d)
      v = draw.vector();
    const auto force_at = [&](const double t) {
      for (std::size_t c = 0; c < x.size(); ++c)
        x[c] = one.x[c] + t * d[c];
      model.force(x, f);
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(f[0].data(), exact.cols()));
    };
    const double t = 1e-5;
    const Eigen::VectorXd difference =
      (8 * (force_at(t) - force_at(-t)) - (force_at(2 * t) - force_at(-2 * t))) / (12 * t);
    const Eigen::VectorXd product = exact * Eigen::Map<const Eigen::VectorXd>(d[0].data(), exact.cols());
    EXPECT_LT((difference + product).norm(), 1e-7 * product.norm()) << name_of(one.options);
  }
}

TEST(Force, PositiveMatrixIsThatOfTheProducts) {
  for (const Case& one : cases()) {
    Hexahedra model = model_of(one);
    const Eigen::MatrixXd K = model.stiffness_matrix(one.x, dynamics::Tangent::positive);
    EXPECT_LT((K - K.transpose()).norm(), 1e-13 * K.norm());
    EXPECT_GT(support::spectrum(K)[0],
              -1e-13 * K.norm());
    model.linearise(one.x);
    Draw draw(68);
    Points d(one.x.size()), y(one.x.size());
    for (Vec3& v : d)
      v = draw.vector();
    model.apply_stiffness(dynamics::flat(d), dynamics::flat(y));
    const Eigen::VectorXd expected = K * Eigen::Map<const Eigen::VectorXd>(d[0].data(), K.cols());
    EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(y[0].data(), K.cols()) - expected).norm(), 1e-13 * expected.norm());
    const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
    for (std::size_t c = 0; c < blocks.size(); ++c)
      EXPECT_LT((blocks[c] - K.block<3, 3>(3 * c, 3 * c)).norm(), 1e-13 * K.norm()) << name_of(one.options);
  }
}

/// Collapsed and inverted elements have finite forces and tangents under every law.
TEST(Force, IsFiniteForEveryState) {
  for (const Case& one : cases()) {
    Hexahedra model = model_of(one);
    for (const Vec3& scale : {Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(1, 1, -1), Vec3(-1, -1, -1)}) {
      Points x, f;
      for (const Vec3& X : one.body.rest())
        x.push_back(scale.cwiseProduct(X));
      model.force(x, f);
      model.linearise(x);
      EXPECT_TRUE(std::isfinite(model.energy(x)));
      const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
      for (std::size_t c = 0; c < f.size(); ++c)
        EXPECT_TRUE(f[c].allFinite() && blocks[c].allFinite()) << name_of(one.options) << scale.transpose();
      const Eigen::SparseMatrix<double> K = model.stiffness_matrix(x, dynamics::Tangent::exact);
      EXPECT_TRUE(std::isfinite(K.norm()));
    }
  }
}

TEST(Mass, IsDensityTimesTheVolumeInsideTheSurface) {
  Draw draw(63);
  for (int n = 0; n < 20; ++n) {
    Body body = make_block({3, 2, 3}, 0.2, draw, {0, 1});
    cut_at_random(body, 0.1 * (n % 10), draw, {0, 1});
    const Hexahedra model(body, {.material = rubber});
    const auto skin = surface::build_surface(body);
    const double volume = surface::enclosed_volume(skin.rest, skin.triangles);
    double mass = 0;
    for (const double m : model.lumped_mass())
      mass += m;
    EXPECT_NEAR(mass / (rubber.density * volume), 1, 1e-12);
    EXPECT_NEAR(model.volume() / volume, 1, 1e-12);
  }
}

TEST(Mass, OfFullCubesIsACubeACopy) {
  Draw draw(64);
  Body body = make_block({3, 2, 3}, 0.2, draw, {0.3, 0.7});
  cut_at_random(body, 0.5, draw, {0.3, 0.7});
  const Hexahedra model(body, {.material = rubber, .boundary = Boundary::full_cube});
  double mass = 0;
  for (const double m : model.lumped_mass())
    mass += m;
  EXPECT_NEAR(mass / (rubber.density * 0.008 * static_cast<double>(body.complex.n_copies())), 1, 1e-13);
  EXPECT_EQ(model.n_partial(), 0u);
  EXPECT_EQ(model.n_elements(), body.complex.n_copies());
}

/// Of the right total, however it is spread over the cube.
TEST(Mass, OfVolumeFractionsIsTheOctants) {
  Draw draw(69);
  Body body = make_block({3, 2, 3}, 0.2, draw, {0.3, 0.7});
  cut_at_random(body, 0.5, draw, {0.3, 0.7});
  const Hexahedra octants = make_model(body, {.material = rubber});
  const Hexahedra fractions = make_model(body, {.material = rubber, .boundary = Boundary::volume_fraction});
  const double cube = rubber.density * 0.008;
  for (std::size_t e = 0; e < octants.n_elements(); ++e) {
    const double fraction = octants.element(e).volume / 0.008;
    EXPECT_NEAR(fractions.element(e).volume, octants.element(e).volume, 1e-17);
    for (const double m : fractions.element(e).mass)
      EXPECT_NEAR(m, fraction * cube / 8, 1e-13 * cube);
  }
}

/// A velocity field linear in X has twice its kinetic energy in p^T M p, exact for every shape of the material that is
/// not folded (fem/moments.h), and rows sum to the lumped mass.
TEST(Mass, ConsistentOneIntegratesLinearFields) {
  Draw draw(70);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.5, draw, {0.2, 0.8});
  const Hexahedra model = make_model(body, {.material = rubber});
  const Mat3 A = draw.matrix();
  const Points rest = body.rest();
  double found = 0, expected = 0;
  std::size_t n_folded = 0;
  for (std::size_t e = 0; e < model.n_elements(); ++e) {
    const grid::Copy& copy = body.complex.copies[grid::CopyId(e)];
    const Moments moments = material_moments(body, copy);
    const auto mass = consistent_mass(moments, rubber.density * 0.008);
    for (int a = 0; a < 8; ++a)
      EXPECT_NEAR(mass.row(a).sum() / model.element(e).mass[a], 1, 1e-10);
    if (without_negative_squares(moments) != moments) {
      ++n_folded;
      continue;
    }
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        found += mass(a, b) * (A * rest[copy.corners[a].value]).dot(A * rest[copy.corners[b].value]);
    for (const auto& [x, weight] : material_rule(body, copy, 4))
      expected += rubber.density * 0.008 * weight * (A * (body.grid.origin(copy.cell) + 0.2 * x)).squaredNorm();
  }
  EXPECT_NEAR(found / expected, 1, 1e-12);
  EXPECT_LT(n_folded, 0.05 * model.n_elements());
}

/// Lumped masses and their coupling, element by element against the matrices themselves; as a product and as entries;
/// built at once and after cuts.
TEST(Mass, CouplingMakesTheConsistentMatrixOfTheLumpedOne) {
  Draw draw(71);
  Body body = make_block({3, 2, 3}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.5, draw, {0.2, 0.8});
  const Hexahedra model(body, {.material = rubber, .mass = MassMatrix::consistent});
  const auto n = static_cast<Eigen::Index>(3 * model.lumped_mass().size());
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(n, n), entries = expected, products = expected;
  for (std::size_t e = 0; e < model.n_elements(); ++e) {
    const grid::Copy& copy = body.complex.copies[grid::CopyId(e)];
    const auto mass = consistent_mass(material_moments(body, copy), rubber.density * 0.008);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        expected.block<3, 3>(3 * copy.corners[a].value, 3 * copy.corners[b].value) += mass(a, b) * Mat3::Identity();
  }
  for (Eigen::Index i = 0; i < n; ++i)
    entries(i, i) = products(i, i) = model.lumped_mass()[i / 3];
  std::vector<Eigen::Triplet<double>> list;
  model.mass_coupling()->add_entries(1, list);
  for (const auto& entry : list)
    entries(entry.row(), entry.col()) += entry.value();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, i);
    model.mass_coupling()->add_product({unit.data(), static_cast<std::size_t>(n)},
                                       {products.col(i).data(), static_cast<std::size_t>(n)});
  }
  const double size = expected.lpNorm<Eigen::Infinity>();
  EXPECT_LT((entries - expected).lpNorm<Eigen::Infinity>(), 1e-13 * size);
  EXPECT_LT((products - expected).lpNorm<Eigen::Infinity>(), 1e-13 * size);
  EXPECT_EQ(make_model(body, {.material = rubber}).mass_coupling(), nullptr);
}

/// With the mass that is extended to corners of near-empty copies: still positive, of the same sum, and symmetric.
TEST(Mass, CouplingOfExtendedMassIsPositive) {
  Draw draw(72);
  for (int round = 0; round < 10; ++round) {
    Body body = make_block({3, 2, 3}, 0.2, draw, {1e-4, 1 - 1e-4});
    cut_at_random(body, 0.5, draw, {1e-4, 1 - 1e-4});
    const Hexahedra model(body, {.material = rubber, .inertia = Inertia::extended, .mass = MassMatrix::consistent});
    const auto n = static_cast<Eigen::Index>(3 * model.lumped_mass().size());
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      M(i, i) = model.lumped_mass()[i / 3];
    const double sum = M.trace() / 3;
    std::vector<Eigen::Triplet<double>> list;
    model.mass_coupling()->add_entries(1, list);
    for (const auto& entry : list)
      M(entry.row(), entry.col()) += entry.value();
    EXPECT_LT((M - M.transpose()).lpNorm<Eigen::Infinity>(), 1e-14 * M.lpNorm<Eigen::Infinity>());
    EXPECT_NEAR(M.sum() / 3 / sum, 1, 1e-12);
    const Eigen::VectorXd scale = M.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
    EXPECT_GT(support::spectrum(scaled)[0], -1e-12);
  }
}

TEST(Mass, OfEachCornerIsPositive) {
  Draw draw(65);
  for (int n = 0; n < 10; ++n) {
    Body body = make_block({3, 2, 3}, 0.2, draw, {0.001, 0.999});
    cut_at_random(body, 0.5, draw, {0.001, 0.999});
    const Hexahedra model(body, {.material = rubber});
    for (const double m : model.lumped_mass())
      EXPECT_GT(m, 0);
  }
}

/// Each side of a full cut is a body of its own.
TEST(Pieces, DoNotFeelEachOther) {
  for (const auto boundary : {Boundary::octants, Boundary::full_cube}) {
    Draw draw(66);
    Body body = make_block({4, 3, 3}, 0.2, draw, {0.4, 0.6});
    cut_plane(body, 0, 2, 0.3);
    ASSERT_EQ(grid::n_pieces(body.complex), 2u);
    Hexahedra model(body, {.material = rubber, .boundary = boundary});
    const grid::Pieces pieces = grid::pieces(body.complex);
    std::vector<std::uint32_t> piece(body.complex.n_corners());
    for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
      for (const auto corner : body.complex.copies[c].corners)
        piece[corner.value] = pieces.piece[c];

    Points x = body.rest(), force, y(x.size());
    for (std::size_t c = 0; c < x.size(); ++c)
      if (piece[c] == 1)
        x[c] += 0.1 * draw.vector();
    model.force(x, force);
    model.linearise(x);
    Points p(x.size(), Vec3::Zero());
    for (std::size_t c = 0; c < x.size(); ++c)
      if (piece[c] == 1)
        p[c] = draw.vector();
    model.apply_stiffness(dynamics::flat(p), dynamics::flat(y));
    double size = 0;
    for (std::size_t c = 0; c < x.size(); ++c) {
      size = std::max(size, piece[c] == 1 ? force[c].norm() : 0.0);
      if (piece[c] == 0) {
        EXPECT_LT(force[c].norm(), 1e-14 * rubber.youngs_modulus);
        EXPECT_EQ(y[c], Vec3::Zero());
      }
    }
    EXPECT_GT(size, 1);
  }
}

} // namespace
} // namespace kerf::fem::force_test
