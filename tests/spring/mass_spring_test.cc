/// Springs against differences, closed forms and what symmetry demands.

#include "spring/mass_spring.h"
#include "base/error.h"
#include "base/parallel.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "tests/fem/bodies.h"
#include "tests/support/parents.h"
#include "tests/support/placed.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <memory>

namespace kerf::spring::mass_spring_test {
namespace {

using fem::Body;
using fem::Draw;

constexpr double E = 1e4, h = 0.1;
const MassSpringOptions options{.density = 1000, .youngs_modulus = E};

Body cut_block(const unsigned seed, const Index3& n, const double probability) {
  Draw draw(seed);
  Body body = fem::make_block(n, h, draw, {0.05, 0.95});
  fem::cut_at_random(body, probability, draw, {0.05, 0.95});
  return body;
}

Points moved(const Body& body, Draw& draw, const double noise) {
  Points x = body.rest();
  const Mat3 Q = draw.rotation();
  const Vec3 shift = draw.vector();
  for (Vec3& p : x)
    p = Q * p + shift + noise * h * draw.vector();
  return x;
}

double largest(const Points& x) {
  double norm = 0;
  for (const Vec3& p : x)
    norm = std::max(norm, p.norm());
  return norm;
}

Eigen::MatrixXd stiffness(const MassSpring& model) {
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

TEST(MassSpring, ForceIsMinusTheGradient) {
  const Body body = cut_block(1, {3, 3, 3}, 0.3);
  const MassSpring model(body, options);
  Draw draw(2);
  Points x = moved(body, draw, 0.3), force;
  model.force(x, force);
  constexpr double step = 1e-6;
  for (std::size_t c = 0; c < x.size(); c += 5)
    for (int i = 0; i < 3; ++i) {
      const double at = x[c][i];
      x[c][i] = at + step;
      const double after = model.energy(x);
      x[c][i] = at - step;
      const double before = model.energy(x);
      x[c][i] = at;
      EXPECT_NEAR(force[c][i], (before - after) / (2 * step), 1e-6 * largest(force));
    }
}

/// Where every spring is stretched nothing is left out of K.
TEST(MassSpring, StiffnessOfStretchedSpringsIsTheDerivativeOfTheForce) {
  const Body body = cut_block(3, {2, 3, 2}, 0.2);
  MassSpring model(body, options);
  Draw draw(4);
  Points x = body.rest(), after, before;
  for (Vec3& p : x)
    p = 2 * p + 0.05 * h * draw.vector();
  model.linearise(x);
  Points p(x.size()), Kp(x.size());
  for (Vec3& q : p)
    q = draw.vector();
  model.apply_stiffness({p[0].data(), 3 * p.size()}, {Kp[0].data(), 3 * Kp.size()});
  constexpr double step = 1e-6;
  for (std::size_t c = 0; c < x.size(); ++c)
    x[c] += step * p[c];
  model.force(x, after);
  for (std::size_t c = 0; c < x.size(); ++c)
    x[c] -= 2 * step * p[c];
  model.force(x, before);
  for (std::size_t c = 0; c < x.size(); ++c)
    EXPECT_LT((Kp[c] - (before[c] - after[c]) / (2 * step)).norm(), 1e-6 * largest(Kp));
}

TEST(MassSpring, StiffnessIsSymmetricAndNowhereNegative) {
  const Body body = cut_block(5, {2, 2, 2}, 0.3);
  MassSpring model(body, options);
  for (const double noise : {0.0, 0.3, 3.0}) {
    Draw draw(6);
    model.linearise(moved(body, draw, noise));
    const Eigen::MatrixXd K = stiffness(model);
    EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
    const Eigen::VectorXd eigenvalues = support::spectrum(K);
    EXPECT_GT(eigenvalues[0], -1e-12 * K.norm()) << noise;
    const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
    for (std::size_t c = 0; c < blocks.size(); ++c)
      EXPECT_LT((blocks[c] - K.block<3, 3>(3 * c, 3 * c)).norm(), 1e-12 * K.norm());
  }
}

TEST(MassSpring, MatrixIsTheStiffness) {
  const Body body = cut_block(5, {2, 2, 2}, 0.3);
  MassSpring model(body, options);
  Draw draw(6);
  const Points x = moved(body, draw, 0.3);
  model.linearise(x);
  const Eigen::MatrixXd K = stiffness(model);
  EXPECT_LT((K - model.stiffness_matrix(x, dynamics::Tangent::positive)).norm(), 1e-13 * K.norm());
  const Eigen::MatrixXd exact = model.stiffness_matrix(x, dynamics::Tangent::exact);
  constexpr double step = 1e-6;
  for (Eigen::Index i = 0; i < exact.cols(); i += 7) {
    Points after, before, y = x;
    y[i / 3][i % 3] += step;
    model.force(y, after);
    y[i / 3][i % 3] -= 2 * step;
    model.force(y, before);
    for (std::size_t c = 0; c < x.size(); ++c)
      EXPECT_LT((exact.col(i).segment<3>(3 * c) - (before[c] - after[c]) / (2 * step)).norm(), 1e-6 * exact.norm());
  }
}

TEST(MassSpring, SixRigidModesAPiece) {
  for (const double probability : {0.0, 0.5, 1.0}) {
    const Body body = cut_block(7, {3, 2, 2}, probability);
    MassSpring model(body, options);
    model.linearise(body.rest());
    // scaled by the masses, as a sliver's springs are soft
    Eigen::MatrixXd K = stiffness(model);
    for (Eigen::Index i = 0; i < K.rows(); ++i)
      for (Eigen::Index j = 0; j < K.cols(); ++j)
        K(i, j) /= std::sqrt(model.lumped_mass()[i / 3] * model.lumped_mass()[j / 3]);
    const Eigen::VectorXd eigenvalues = support::spectrum(K);
    EXPECT_EQ((eigenvalues.array() < 1e-9 * eigenvalues.maxCoeff()).count(), 6 * grid::n_pieces(body.complex));
  }
}

TEST(MassSpring, RigidMotionCostsNothing) {
  const Body body = cut_block(8, {4, 3, 3}, 0.3);
  const MassSpring model(body, options);
  Draw draw(9);
  Points force;
  const Points x = moved(body, draw, 0);
  model.force(x, force);
  EXPECT_LT(largest(force), 1e-11);
  EXPECT_LT(model.energy(x), 1e-20);
}

TEST(MassSpring, PiecesDoNotFeelEachOther) {
  Draw draw(10);
  Body body = fem::make_block({5, 3, 3}, h, draw, {0.2, 0.8});
  fem::cut_plane(body, 0, 2, 0.4);
  const grid::Pieces pieces = grid::pieces(body.complex);
  ASSERT_EQ(pieces.n_pieces, 2u);
  const MassSpring model(body, options);
  Points x = body.rest(), force;
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    if (pieces.piece[c] == 1)
      for (const auto corner : body.complex.copies[c].corners)
        x[corner.value] = body.rest()[corner.value] + Vec3(1, 2, 3);
  model.force(x, force);
  EXPECT_LT(largest(force), 1e-10);
}

/// Cuts move mass and springs from full copies to partial ones, and add none.
TEST(MassSpring, CutsDoubleNothing) {
  Draw draw(11);
  Body body = fem::make_block({4, 4, 4}, h, draw, {0.5, 0.5});
  const auto measure = [&] {
    const MassSpring model(body, options);
    Points x = body.rest();
    const Mat3 A = Mat3::Identity() + 0.1 * (Mat3() << 1, 0.5, 0, 0, -0.3, 0.2, 0.1, 0, 0.4).finished();
    for (Vec3& p : x)
      p = A * p;
    double mass = 0;
    for (const double m : model.lumped_mass())
      mass += m;
    return std::pair(mass, model.energy(x));
  };
  const auto before = measure();
  std::vector<grid::EdgeCut> inner; // cells around these hold no empty node
  for (const auto e : fem::inner_edges(body)) {
    bool is_inside = true;
    for (const auto c : body.grid.cells(e))
      is_inside = is_inside && c.valid() && !support::is_skin_cell(body.grid, c);
    if (is_inside)
      inner.push_back({e, draw(0.05, 0.95), draw.vector().normalized(), 1});
  }
  ASSERT_GT(inner.size(), 20u);
  body.cut(inner);
  const auto after = measure();
  EXPECT_NEAR(after.first, before.first, 1e-12 * before.first);
  EXPECT_NEAR(after.second, before.second, 1e-12 * before.second);
}

/// Energy of uniform small strain: Hooke's law with nu = 1/4, whatever its directions.
TEST(MassSpring, UniformStrainFollowsHooke) {
  const auto body = support::with_copies(support::block({4, 3, 3}, h));
  const MassSpring model(body, options);
  const double lambda = 0.4 * E, mu = 0.4 * E, volume = 36 * h * h * h;
  Draw draw(12);
  for (int trial = 0; trial < 20; ++trial) {
    Mat3 strain = draw.matrix();
    strain = 1e-7 * (strain + strain.transpose()).eval();
    Points x = grid::rest_positions(body);
    for (Vec3& p : x)
      p += strain * p;
    const double expected = volume * (lambda / 2 * strain.trace() * strain.trace() + mu * strain.squaredNorm());
    EXPECT_NEAR(model.energy(x) / expected, 1, 1e-5);
  }
}

/// A body of full cubes under uniform strain: no force on any inner corner, and on the surface that of the stress.
TEST(MassSpring, FullCubesPassThePatchTest) {
  Draw draw(13);
  const auto body = support::with_copies(support::block({4, 4, 4}, h));
  const auto& complex = body.complex;
  auto full = body; // without the skin's half cells
  full.complex = {};
  full.complex.node = complex.node;
  for (const auto& copy : complex.copies)
    if (copy.nodes == 0xff)
      full.complex.copies.push_back(copy);
  const MassSpring model(full, options);
  Mat3 strain = draw.matrix();
  strain = 1e-7 * (strain + strain.transpose()).eval();
  const Mat3 stress = 0.4 * E * (strain.trace() * Mat3::Identity() + 2 * strain);
  Points x = grid::rest_positions(body), force;
  for (Vec3& p : x)
    p += strain * p;
  model.force(x, force);
  for (const auto c : ids<grid::CornerId>(complex.n_corners())) {
    const Index3 at = body.grid.index(complex.node[c]);
    Vec3 outward = Vec3::Zero(); // the area, a quarter of a face from each cube around
    int n_outside = 0;
    for (int v = 0; v < 8; ++v) {
      Vec3 side;
      bool is_cube = true;
      for (int axis = 0; axis < 3; ++axis) {
        side[axis] = (v >> axis & 1) != 0 ? -1 : 1; // this corner is at the upper end of the cube below
        const int lower = (v >> axis & 1) != 0 ? at[axis] : at[axis] - 1;
        is_cube = is_cube && lower >= 1 && lower < 4;
      }
      outward += is_cube ? Vec3(h * h / 4 * side) : Vec3(Vec3::Zero());
      n_outside += !is_cube;
    }
    EXPECT_LT((force[c.value] + stress * outward).norm(), 1e-5 * h * h * stress.norm()) << n_outside;
  }
}

/// A bar with its skin anywhere inside its cells, pulled by its own weight: far from its ends the strain is
/// density g (L - z) / E.
TEST(MassSpring, BarsHangAsTheirModulusSays) {
  const Index3 n = {2, 3, 24};
  for (const double t : {0.1, 0.5, 0.9}) {
    const auto body =
      support::make_body({Vec3::Zero(), h}, support::block_nodes(n), [&](const grid::Grid& grid, const grid::EdgeId e) {
        const bool is_upper = grid.is_material(grid.ends(e)[0]);
        const double part = grid.axis(e) == 2 ? 0.5 : t;
        return grid::EdgeCut{e, is_upper ? part : 1 - part, Vec3::Unit(grid.axis(e)), grid::skin_label};
      });
    const support::Body placed = support::with_copies(support::with_placed_skin(body));
    const auto& complex = placed.complex;
    MassSpring model(placed, options);
    const Points rest = grid::rest_positions(placed);
    dynamics::Support support{{}, {}, [](double) { return Vec3(Vec3::Zero()); }};
    for (const auto c : ids<grid::CornerId>(complex.n_corners()))
      if (placed.grid.index(complex.node[c])[2] <= 1) {
        support.corners.push_back(c.value);
        support.rest.push_back(rest[c.value]);
      }
    const double g = 1e-4 * E / (1000 * 2.4);
    dynamics::Loads loads{.gravity = Vec3(0, 0, g), .supports = {}};
    loads.supports.push_back(support);
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero()), 0};
    dynamics::ImplicitEuler stepper(model, {.cg_tolerance = 1e-12});
    for (int i = 0; i < 30; ++i)
      stepper.step(state, loads, 10);
    const auto at = [&](const int k) {
      return state.x[complex.real_corner[*placed.grid.find_node({1, 2, k})].value][2];
    };
    for (int k = 9; k < 16; ++k) {
      const double strain = (at(k + 1) - at(k)) / h - 1, expected = 1000 * g * h * (24 - k) / E;
      EXPECT_NEAR(strain / expected, 1, 2e-3) << "t " << t << ", k " << k;
    }
  }
}

/// K <= 2 diag(K summed over a corner's springs), and a copy adds to both that and the mass in proportion to its fill:
/// so whatever is cut, no frequency exceeds what follows for a lone full cube.
TEST(MassSpring, SliversDoNotRaiseTheLargestFrequency) {
  const auto largest_frequency = [](const double t) {
    Draw draw(14);
    Body body = fem::make_block({3, 3, 2}, h, draw, {0.5, 0.5});
    fem::cut_at_random(body, 0.4, draw, {t, t});
    MassSpring model(body, options);
    model.linearise(body.rest());
    Eigen::MatrixXd K = stiffness(model);
    for (Eigen::Index i = 0; i < K.rows(); ++i)
      for (Eigen::Index j = 0; j < K.cols(); ++j)
        K(i, j) /= std::sqrt(model.lumped_mass()[i / 3] * model.lumped_mass()[j / 3]);
    return std::sqrt(support::spectrum(K).maxCoeff());
  };
  const double bound = std::sqrt(2 * (3 * E * h / 10 + 3 * E * h / 5) / (1000 * h * h * h / 8));
  for (const double t : {0.5, 0.1, 1e-3, 1e-9})
    EXPECT_LT(largest_frequency(t), bound) << t;
}

TEST(MassSpring, IntegratorsKeepMomentum) {
  const Body body = cut_block(15, {3, 3, 3}, 0.3);
  MassSpring model(body, options);
  Draw draw(16);
  dynamics::State state{moved(body, draw, 0.05), {}, 0};
  for (const Vec3& x : state.x)
    state.v.push_back(Vec3(0, 0, 5).cross(x) + 0.1 * draw.vector());
  const auto angular = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < state.x.size(); ++c)
      sum += model.lumped_mass()[c] * state.x[c].cross(state.v[c]);
    return sum;
  };
  const Vec3 before = angular();
  dynamics::SymplecticEuler stepper(model);
  for (int i = 0; i < 500; ++i)
    stepper.step(state, {.supports = {}}, 2e-3);
  EXPECT_LT((angular() - before).norm(), 1e-12 * before.norm());
}

TEST(MassSpring, CollapsedBodiesStayFinite) {
  const Body body = cut_block(17, {3, 3, 3}, 0.2);
  MassSpring model(body, options);
  dynamics::ImplicitEuler stepper(model, {});
  dynamics::State state{Points(body.complex.n_corners(), Vec3::Zero()), {}, 0};
  state.v = state.x;
  for (int i = 0; i < 50; ++i)
    stepper.step(state, {.gravity = Vec3(0, 0, -9.81), .supports = {}}, 1.0 / 60);
  for (const Vec3& x : state.x)
    EXPECT_TRUE(x.allFinite());
}

/// Ground down to single nodes while it spins and shakes; with implicit Euler the energy only falls, but for what a cut
/// moves: at most 1 % of it.
TEST(MassSpring, DustCarriesOn) {
  Draw draw(21);
  Body body = fem::make_block({6, 6, 6}, h, draw, {0.1, 0.9});
  dynamics::State state{body.rest(), {}, 0};
  for (const Vec3& x : state.x)
    state.v.push_back(Vec3(1, 2, 3).cross(x) + 0.3 * draw.vector());
  auto model = std::make_unique<MassSpring>(body, options);
  const auto energy = [&] {
    double sum = model->energy(state.x);
    for (std::size_t c = 0; c < state.v.size(); ++c)
      sum += 0.5 * model->lumped_mass()[c] * state.v[c].squaredNorm();
    return sum;
  };
  double before = energy();
  for (int round = 0; round < 40; ++round) {
    const grid::CellComplex old = body.complex;
    fem::cut_at_random(body, round < 39 ? 1.0 / 12 : 2, draw, {1e-9, 1});
    const auto parents = support::parents(old, body);
    const dynamics::State whole = state;
    state.x.clear();
    state.v.clear();
    for (const auto parent : parents) {
      state.x.push_back(whole.x[parent.value]);
      state.v.push_back(whole.v[parent.value]);
    }
    model = std::make_unique<MassSpring>(body, options);
    EXPECT_LT(energy(), 1.01 * before) << round;
    dynamics::ImplicitEuler stepper(*model, {});
    for (int i = 0; i < 3; ++i) {
      before = energy();
      stepper.step(state, {.supports = {}}, 1.0 / 60);
      EXPECT_LT(energy(), (1 + 1e-9) * before) << round;
    }
    before = energy();
    ASSERT_TRUE(std::isfinite(before));
  }
  EXPECT_EQ(grid::n_pieces(body.complex), 216u);
}

TEST(MassSpring, OneAndTwoThreadsGiveTheSameBits) {
  std::array<Points, 2> force, product;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    const Body body = cut_block(18, {16, 16, 16}, 0.1);
    MassSpring model(body, options);
    Draw draw(19);
    const Points x = moved(body, draw, 0.2);
    model.force(x, force[n - 1]);
    model.linearise(x);
    product[n - 1].resize(x.size());
    model.apply_stiffness({x[0].data(), 3 * x.size()}, {product[n - 1][0].data(), 3 * x.size()});
  }
  set_n_threads(1);
  EXPECT_EQ(force[0], force[1]);
  EXPECT_EQ(product[0], product[1]);
}

TEST(MassSpring, RefusesWhatMakesNoSense) {
  const Body body = cut_block(20, {2, 2, 2}, 0);
  const auto refused = [&](const MassSpringOptions& wrong) -> std::string {
    try {
      const MassSpring model(body, wrong);
    } catch (const ParameterError& error) {
      return error.complaint().path;
    }
    return "";
  };
  EXPECT_EQ(refused({}), "");
  EXPECT_EQ(refused({.density = -1}), "Density [kg/m^3]");
  EXPECT_EQ(refused({.youngs_modulus = 0}), "Young's modulus [Pa]");
  EXPECT_EQ(refused({.youngs_modulus = std::numeric_limits<double>::infinity()}), "Young's modulus [Pa]");
}

} // namespace
} // namespace kerf::spring::mass_spring_test
