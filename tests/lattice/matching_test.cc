/// The potential against its definition, its forces against differences, and what symmetry demands of both.

#include "lattice/matching.h"
#include "base/error.h"
#include "lattice/kernels.h"
#include "tests/lattice/bodies.h"

#include <gtest/gtest.h>

#include <limits>

namespace kerf::lattice::matching_test {
namespace {

constexpr double k = 3600;

TEST(Matching, GoalsAndEnergyAreThoseOfTheDefinition) {
  unsigned seed = 20;
  for (const double probability : {0.0, 0.1, 0.3, 0.6})
    for (const int w : {1, 2, 4}) {
      const Body body = cut_block(++seed, {4, 5, 3}, probability);
      const Matching model(body, {.half_width = w, .stiffness = k});
      const Reference reference(body, w, 1000);
      Draw draw(seed);
      const Points x = moved(body, draw, 0.1);
      Points g;
      model.goals(x, g);
      EXPECT_LT(largest_difference(g, reference.goals(x)), 1e-12) << seed;
      EXPECT_NEAR(model.energy(x), reference.energy(k, x), 1e-12 * k * 60) << seed; // 60 kg within about a metre
      for (std::size_t c = 0; c < x.size(); ++c)
        EXPECT_NEAR(model.lumped_mass()[c], reference.mass[c], 1e-15);
    }
}

TEST(Matching, ForceIsMinusTheGradient) {
  const Body body = cut_block(35, {3, 3, 3}, 0.3);
  const Matching model(body, {.half_width = 1, .stiffness = k});
  Draw draw(36);
  Points x = moved(body, draw, 0.2), force;
  model.force(x, force);
  double scale = 0;
  for (const Vec3& f : force)
    scale = std::max(scale, f.norm());
  constexpr double step = 1e-5;
  for (std::size_t c = 0; c < x.size(); c += 7)
    for (int i = 0; i < 3; ++i) {
      const double at = x[c][i];
      x[c][i] = at + step;
      const double after = model.energy(x);
      x[c][i] = at - step;
      const double before = model.energy(x);
      x[c][i] = at;
      EXPECT_NEAR(force[c][i], (before - after) / (2 * step), 1e-6 * scale);
    }
}

TEST(Matching, RigidMotionCostsNothing) {
  const Body body = cut_block(37, {5, 4, 4}, 0.3);
  const Matching model(body, {.half_width = 2, .stiffness = k});
  Draw draw(38);
  const Points x = moved(body, draw, 0);
  Points g;
  model.goals(x, g);
  EXPECT_LT(largest_difference(g, x), 1e-13);
  EXPECT_LT(model.energy(x), 1e-11);
}

/// Each piece by itself: so no piece pulls at another.
TEST(Matching, ForcesAndTorquesOfEachPieceVanish) {
  const Body body = cut_block(39, {5, 5, 5}, 0.5);
  const grid::Pieces pieces = grid::pieces(body.complex);
  ASSERT_GT(pieces.n_pieces, 5u);
  const Matching model(body, {.half_width = 2, .stiffness = k});
  Draw draw(40);
  const Points x = moved(body, draw, 1);
  Points force;
  model.force(x, force);
  Points sum(pieces.n_pieces, Vec3::Zero()), torque = sum;
  std::vector<std::uint8_t> seen(x.size(), 0);
  double size = 0;
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    for (const auto corner : body.complex.copies[c].corners)
      if (!seen[corner.value]++) {
        sum[pieces.piece[c]] += force[corner.value];
        torque[pieces.piece[c]] += x[corner.value].cross(force[corner.value]);
        size += force[corner.value].norm();
      }
  for (std::uint32_t p = 0; p < pieces.n_pieces; ++p) {
    EXPECT_LT(sum[p].norm(), 1e-13 * size);
    EXPECT_LT(torque[p].norm(), 1e-13 * size);
  }
}

TEST(Matching, PiecesDoNotFeelEachOther) {
  Draw draw(41);
  Body body = fem::make_block({6, 4, 4}, 0.1, draw, {0.2, 0.8});
  fem::cut_plane(body, 0, 3, 0.4);
  const grid::Pieces pieces = grid::pieces(body.complex);
  ASSERT_EQ(pieces.n_pieces, 2u);
  const Matching model(body, {.half_width = 3, .stiffness = k});
  Points x = moved(body, draw, 0.2), before, after;
  model.force(x, before);
  std::vector<std::uint8_t> is_second(x.size(), 0);
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    for (const auto corner : body.complex.copies[c].corners)
      is_second[corner.value] = pieces.piece[c] == 1;
  for (std::size_t c = 0; c < x.size(); ++c)
    if (is_second[c])
      x[c] = 3 * x[c] + draw.vector();
  model.force(x, after);
  double largest = 0, change = 0;
  for (std::size_t c = 0; c < x.size(); ++c)
    if (!is_second[c]) {
      largest = std::max(largest, before[c].norm());
      change = std::max(change, (after[c] - before[c]).norm());
    }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(change, 1e-11 * largest);
}

/// What the region damping relaxes to: keeps both momenta, loses energy, and leaves rigid motion alone.
TEST(Matching, RigidVelocitiesKeepMomentum) {
  const Body body = cut_block(42, {5, 4, 4}, 0.3);
  const Matching model(body, {.half_width = 2, .stiffness = k});
  Draw draw(43);
  const Points x = moved(body, draw, 0.3);
  Points v(x.size()), u;
  for (Vec3& velocity : v)
    velocity = draw.vector();
  model.rigid_velocities(x, v, u);
  const Momentum before = momentum(model.lumped_mass(), x, v), after = momentum(model.lumped_mass(), x, u);
  EXPECT_LT((after.linear - before.linear).norm(), 1e-12 * before.linear.norm());
  EXPECT_LT((after.angular - before.angular).norm(), 1e-12 * before.angular.norm());
  EXPECT_LT(kinetic_energy(model.lumped_mass(), u), 0.5 * kinetic_energy(model.lumped_mass(), v));
  const Vec3 omega = draw.vector();
  for (std::size_t c = 0; c < x.size(); ++c)
    v[c] = Vec3(1, 2, 3) + omega.cross(x[c]);
  model.rigid_velocities(x, v, u);
  EXPECT_LT(largest_difference(u, v), 1e-11);
}

/// To a point, a line, a plane, somewhere in space: what is left of the regions' extents is round-off.
TEST(Matching, RigidVelocitiesOfCollapsedBodiesAreFinite) {
  const Body body = cut_block(44, {3, 3, 3}, 0.3);
  const Matching model(body, {.half_width = 1, .stiffness = k});
  Draw draw(45);
  Points v(body.complex.n_corners());
  for (Vec3& velocity : v)
    velocity = draw.vector();
  for (const double extent : {0.0, 1e-18, 1e-15, 1e-12, 1e-6})
    for (const Vec3& keep : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0)}) {
      Points x = body.rest(), u;
      for (Vec3& p : x)
        p = Vec3(0.37, 0.11, 0.73) + p.cwiseProduct(keep) + extent * draw.vector();
      model.rigid_velocities(x, v, u);
      const Momentum before = momentum(model.lumped_mass(), x, v), after = momentum(model.lumped_mass(), x, u);
      EXPECT_LT((after.linear - before.linear).norm(), 1e-11);
      EXPECT_LT((after.angular - before.angular).norm(), 1e-11) << extent << ", keep " << keep.transpose();
      EXPECT_LE(kinetic_energy(model.lumped_mass(), u), 1.001 * kinetic_energy(model.lumped_mass(), v))
        << extent << ", keep " << keep.transpose();
    }
}

TEST(Rotations, AreThoseOfThePolarDecomposition) {
  Draw draw(46);
  int n_left = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    double matrices[96];
    for (int l = 0; l < 8; ++l) {
      Mat3 A = std::pow(10, draw(-8, 8)) * draw.rotation() *
               Vec3(1, std::pow(10, draw(-2, 0)), std::pow(10, draw(-2, 0))).asDiagonal() * draw.rotation();
      if (l == trial % 16)
        A.col(0) *= -1;
      Eigen::Map<Mat3>(matrices + 12 * l) = A;
    }
    double rotated[96];
    std::copy(std::begin(matrices), std::end(matrices), rotated);
    const unsigned left = rotate_in_place(8, rotated);
    for (int l = 0; l < 8; ++l) {
      const Mat3 A = Eigen::Map<Mat3>(matrices + 12 * l), R = Eigen::Map<Mat3>(rotated + 12 * l);
      n_left += left >> l & 1;
      if (left >> l & 1)
        EXPECT_EQ(R, A);
      else
        EXPECT_LT((R - material::rotation_of(A)).norm(), 1e-12);
      // alone, it comes out the same to the last bit
      double alone[9];
      Eigen::Map<Mat3>{alone} = A;
      rotate_in_place(1, alone);
      EXPECT_EQ(Mat3(Eigen::Map<Mat3>(alone)), R);
    }
  }
  EXPECT_GE(n_left, 1000); // the inverted ones
  EXPECT_LT(n_left, 3000);
}

TEST(Rotations, LeaveWhatHasNone) {
  double matrices[36] = {};
  for (int i = 0; i < 9; ++i)
    matrices[12 + i] = std::numeric_limits<double>::quiet_NaN();
  Eigen::Map<Mat3>(matrices + 24).setIdentity();
  EXPECT_EQ(rotate_in_place(3, matrices), 3u);
  EXPECT_EQ(Mat3(Eigen::Map<Mat3>(matrices + 24)), Mat3::Identity());
}

TEST(Matching, RefusesWhatMakesNoSense) {
  const Body body = cut_block(47, {2, 2, 2}, 0);
  const auto refused = [&](const MatchingOptions& options) -> std::string {
    try {
      const Matching model(body, options);
    } catch (const ParameterError& error) {
      return error.complaint().path;
    }
    return "";
  };
  EXPECT_EQ(refused({}), "");
  EXPECT_EQ(refused({.half_width = 1000}), "");
  EXPECT_EQ(refused({.half_width = 0}), "Half width [cells]");
  EXPECT_EQ(refused({.density = 0}), "Density [kg/m^3]");
  EXPECT_EQ(refused({.density = std::nan("")}), "Density [kg/m^3]");
  EXPECT_EQ(refused({.stiffness = 0}), "Stiffness [1/s^2]");
  EXPECT_EQ(refused({.stiffness = -1}), "Stiffness [1/s^2]");
  EXPECT_EQ(refused({.stiffness = std::numeric_limits<double>::infinity()}), "Stiffness [1/s^2]");
}

} // namespace
} // namespace kerf::lattice::matching_test
