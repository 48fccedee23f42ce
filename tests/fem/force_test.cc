#include "fem/corotational.h"

#include "dynamics/state.h"
#include "surface/surface.h"
#include "tests/fem/bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace kerf::fem {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

/// Bodies of full cells, of cells filled in part, and cut ones; each with a state far from rest.
struct Case {
  Body body;
  CorotationalOptions options;
  Points x;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (unsigned n = 0; n < 12; ++n) {
    Draw draw(40 + n);
    Case one{make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8}), {.material = rubber}, {}};
    if (n % 3 == 0)
      one.options.integration = Integration::full_cube;
    if (n % 3 == 2)
      cut_at_random(one.body, 0.4, draw, {0.2, 0.8});
    Mat3 F = draw.rotation();
    if (n >= 6)
      F = F * Vec3(1.3, 0.9, 0.7).asDiagonal();
    for (const Vec3& X : one.body.rest())
      one.x.push_back(F * X + 0.015 * draw.vector());
    all.push_back(std::move(one));
  }
  return all;
}

Corotational model_of(const Case& one) {
  return Corotational(one.body.grid, one.body.cuts, one.body.complex, one.options);
}

/// Central differences of fourth order.
TEST(Force, IsMinusTheGradientOfTheEnergy) {
  double worst = 0;
  for (const Case& one : cases()) {
    const Corotational model = model_of(one);
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
  EXPECT_LT(worst, 1e-8);
  RecordProperty("worst", std::to_string(worst * 1e10) + "e-10");
}

TEST(Force, HasNoResultantAndNoTorque) {
  for (const Case& one : cases()) {
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
  for (const Case& one : cases()) {
    const Corotational model = model_of(one);
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
  for (const Case& one : cases()) {
    const Corotational model = model_of(one);
    const Mat3 Q = draw.rotation();
    Points moved, force;
    for (const Vec3& X : one.body.rest())
      moved.push_back(Q * X + Vec3(1, 2, 3));
    model.force(moved, force);
    for (const Vec3& f : force)
      EXPECT_LT(f.norm(), 1e-14 * rubber.youngs_modulus);
    EXPECT_LT(model.energy(moved), 1e-28 * rubber.youngs_modulus);
  }
}

/// A state of uniform strain has the energy of its strain, in every body cut at random: volume times density of energy.
TEST(Force, UniformStretchHasItsEnergy) {
  Draw draw(62);
  for (const Case& one : cases()) {
    const Corotational model = model_of(one);
    const Vec3 strain(0.2, -0.1, 0.05);
    const Mat3 Q = draw.rotation();
    Points x;
    for (const Vec3& X : one.body.rest())
      x.push_back(Q * X.cwiseProduct(Vec3::Ones() + strain));
    const double density = 0.5 * rubber.lambda() * strain.sum() * strain.sum() + rubber.mu() * strain.squaredNorm();
    EXPECT_NEAR(model.energy(x) / (density * model.volume()), 1, 1e-3); // slivers carry their floor
    CorotationalOptions exact = one.options;
    exact.sliver_floor = 0;
    const Corotational bare(one.body.grid, one.body.cuts, one.body.complex, exact);
    EXPECT_NEAR(bare.energy(x) / (density * bare.volume()), 1, 1e-12);
  }
}

TEST(Mass, IsDensityTimesTheVolumeInsideTheSurface) {
  Draw draw(63);
  for (int n = 0; n < 20; ++n) {
    Body body = make_block({3, 2, 3}, 0.2, draw, {0, 1});
    cut_at_random(body, 0.1 * (n % 10), draw, {0, 1});
    const Corotational model(body.grid, body.cuts, body.complex, {.material = rubber});
    const auto skin = surface::build_surface(body.grid, body.cuts, body.complex);
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
  const Corotational model(body.grid, body.cuts, body.complex,
                           {.material = rubber, .integration = Integration::full_cube});
  double mass = 0;
  for (const double m : model.lumped_mass())
    mass += m;
  EXPECT_NEAR(mass / (rubber.density * 0.008 * static_cast<double>(body.complex.n_copies())), 1, 1e-13);
  EXPECT_EQ(model.n_partial(), 0u);
  EXPECT_EQ(model.n_elements(), body.complex.n_copies());
}

TEST(Mass, OfEachCornerIsPositive) {
  Draw draw(65);
  for (int n = 0; n < 10; ++n) {
    Body body = make_block({3, 2, 3}, 0.2, draw, {0.001, 0.999});
    cut_at_random(body, 0.5, draw, {0.001, 0.999});
    const Corotational model(body.grid, body.cuts, body.complex, {.material = rubber});
    for (const double m : model.lumped_mass())
      EXPECT_GT(m, 0);
  }
}

/// Each side of a full cut is a body of its own.
TEST(Pieces, DoNotFeelEachOther) {
  for (const auto integration : {Integration::octants, Integration::full_cube}) {
    Draw draw(66);
    Body body = make_block({4, 3, 3}, 0.2, draw, {0.4, 0.6});
    cut_plane(body, 0, 2, 0.3);
    ASSERT_EQ(body.complex.n_pieces, 2u);
    Corotational model(body.grid, body.cuts, body.complex, {.material = rubber, .integration = integration});
    std::vector<std::uint32_t> piece(body.complex.n_corners());
    for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
      for (const auto corner : body.complex.copies[c].corners)
        piece[corner.value] = body.complex.piece[c];

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
} // namespace kerf::fem
