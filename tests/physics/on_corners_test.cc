// Backends whose particles are corners: their models after cuts are those made anew, and states are inherited.

#include "physics/on_corners.h"

#include "dynamics/forces.h"
#include "tests/physics/cut_bodies.h"

#include <gtest/gtest.h>

namespace kerf::physics::on_corners_test {
namespace {

support::Body whole_block() { return support::block({5, 4, 4}, 0.1); }

std::unique_ptr<fem::Hexahedra> make_elements(const CutBody& b, const fem::Strain strain) {
  return std::make_unique<fem::Hexahedra>(b.solid, fem::HexahedraOptions{.material = {}, .strain = strain});
}

/// Cuts at random, batch by batch, and asks that forces, energy and mass are those of a model made of the body now.
template <class Corners, class Make>
void expect_as_made_anew(const Make& make, const typename Corners::IntegratorMaker& integrator) {
  support::Random random(11);
  GrowingCut block(whole_block());
  Corners physics(block.seen(), make, integrator);
  dynamics::State state = state_at_rest(physics);
  for (int batch = 0; batch < 6; ++batch) {
    block.cut(support::with_skin(block.body, support::random_cuts(random, block.body, 0.12)), physics, state);
    const auto anew = make(block.seen());
    const std::size_t n = block.body.complex.n_corners();
    ASSERT_EQ(physics.rest(), grid::rest_positions(block.body));
    ASSERT_EQ(physics.model().lumped_mass().size(), n);
    Points x = physics.rest();
    const Points noise = random_points(n, random);
    for (std::size_t i = 0; i < n; ++i)
      x[i] += 0.02 * noise[i];
    Points f(n), g(n);
    physics.model().force(x, f);
    anew->force(x, g);
    EXPECT_EQ(f, g);
    EXPECT_EQ(physics.model().energy(x), anew->energy(x));
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_EQ(physics.model().lumped_mass()[i], anew->lumped_mass()[i]);
  }
  EXPECT_GT(grid::n_pieces(block.body.complex), 2u) << "the cuts were real";
}

TEST(OnCorners, ElementsAfterCutsAreThoseMadeAnew) {
  for (const fem::Strain strain : {fem::Strain::trilinear, fem::Strain::enhanced})
    expect_as_made_anew<Elements>([=](const CutBody& b) { return make_elements(b, strain); }, verlet);
}

TEST(OnCorners, SpringsAfterCutsAreThoseMadeAnew) {
  expect_as_made_anew<Springs>(
    [](const CutBody& b) { return std::make_unique<spring::MassSpring>(b.solid, spring::MassSpringOptions{}); },
    verlet);
}

TEST(OnCorners, ShapeMatchingAfterCutsIsThatMadeAnew) {
  expect_as_made_anew<ShapeMatching>(
    [](const CutBody& b) { return std::make_unique<lattice::Matching>(b.solid, lattice::MatchingOptions{}); },
    [](lattice::Matching& model, const PiecesOfParticles&) {
      return std::make_unique<lattice::ShapeMatching>(model, 0);
    });
}

/// Old corners keep what they have; new ones have what their parents have, history of the integrator too. What follows
/// from forces is forgotten, what is no value a corner stays.
TEST(OnCorners, NewCornersInheritAllThatTheirParentsHave) {
  support::Random random(4);
  GrowingCut block(whole_block());
  Elements physics(
    block.seen(), [](const CutBody& b) { return make_elements(b, fem::Strain::trilinear); }, verlet);
  dynamics::State state = state_at_rest(physics);
  EXPECT_EQ(state.x, physics.rest());
  EXPECT_EQ(state.time, 0);
  const std::size_t n = state.x.size();
  state.x = random_points(n, random);
  state.v = random_points(n, random);
  state.time = 3;
  state.history = {{"before", random_points(n, random)},
                   {"acceleration", random_points(n, random)},
                   {"of all", random_points(2, random)}};
  state.numbers = {{"time step [s]", 0.1}};
  const dynamics::State before = state;
  const auto change = block.cut(support::cuts_of_plane(block.body, {Vec3::UnitX(), 0.27}), physics, state);
  ASSERT_GT(change.parents.size(), 10u);
  ASSERT_EQ(state.x.size(), block.body.complex.n_corners());
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const std::size_t from = i < n ? i : change.parents[i - n].value;
    ASSERT_LT(from, i + 1);
    EXPECT_EQ(state.x[i], state.x[from]);
    EXPECT_EQ(state.v[i], state.v[from]);
    EXPECT_EQ(state.history.at("before")[i], state.history.at("before")[from]);
    EXPECT_EQ(block.body.complex.node[grid::CornerId(static_cast<std::uint32_t>(i))],
              block.body.complex.node[grid::CornerId(static_cast<std::uint32_t>(from))]);
    if (i < n) {
      EXPECT_EQ(state.x[i], before.x[i]);
      EXPECT_EQ(state.history.at("before")[i], before.history.at("before")[i]);
    }
  }
  EXPECT_FALSE(state.history.contains("acceleration"));
  EXPECT_EQ(state.history.at("of all"), before.history.at("of all"));
  EXPECT_EQ(state.numbers, before.numbers);
  EXPECT_EQ(state.time, 3);
}

/// The piece of each particle, as statics asks for it after a cut.
TEST(OnCorners, PiecesAreAskedForAsTheyAreNow) {
  GrowingCut block(whole_block());
  std::size_t n_asked = 0;
  std::uint32_t n_pieces = 0;
  Elements physics(
    block.seen(), [](const CutBody& b) { return make_elements(b, fem::Strain::trilinear); },
    [&](fem::Hexahedra& model, const PiecesOfParticles& pieces) {
      const auto all = pieces();
      EXPECT_EQ(all.size(), model.lumped_mass().size());
      n_pieces = 1 + *std::max_element(all.begin(), all.end());
      ++n_asked;
      return verlet(model, pieces);
    });
  EXPECT_EQ(n_pieces, 1u);
  dynamics::State state = state_at_rest(physics);
  block.cut(support::cuts_of_plane(block.body, {Vec3::UnitX(), 0.27}), physics, state);
  EXPECT_EQ(n_pieces, 2u);
  EXPECT_EQ(n_asked, 2u);
}

TEST(OnCorners, PointsOfTheBodyFollowItsCorners) {
  const GrowingCut block(whole_block());
  Elements physics(
    block.seen(), [](const CutBody& b) { return make_elements(b, fem::Strain::trilinear); }, verlet);
  const Vec3 inside(0.213, 0.31, 0.144);
  const auto point = body_point(block.seen(), inside);
  ASSERT_EQ(point.n_points(), 1u);
  EXPECT_LT((point.at(0, physics.rest()) - inside).norm(), 1e-15);
  EXPECT_EQ(physics.carry(point).values, point.values);
  EXPECT_EQ(body_point(block.seen(), Vec3(0.04, 0.2, 0.2)).n_points(), 0u) << "5 mm outside";
  const auto surface = block.surface.weights;
  ASSERT_EQ(surface.n_points(), block.surface.rest.size());
  for (std::size_t i = 0; i < surface.n_points(); ++i)
    EXPECT_LT((surface.at(i, physics.rest()) - block.surface.rest[i]).norm(), 1e-14);
}

/// One heir, whose inertia is round-off, and two that lie next to each other take no angular momentum with all that it
/// was worth: joining gives no energy.
TEST(OnCorners, CornersThatLapseGiveNoEnergy) {
  support::Random random(6);
  for (int i = 0; i < 200; ++i) {
    dynamics::State state{random_points(4, random), random_points(4, random)};
    state.x[1] = state.x[0] + 1e-6 * state.x[1];
    const std::vector<double> mass = {0.1, 0.3, 0.7, 0.2};
    std::vector<grid::Lapse> lapsed = {{grid::CornerId(2), grid::CornerId(0)}};
    if (i % 2 == 0)
      lapsed.push_back({grid::CornerId(3), grid::CornerId(1)});
    std::vector<double> joined = {mass[0] + mass[2], mass[1] + (i % 2 == 0 ? mass[3] : 0), 0, i % 2 == 0 ? 0 : mass[3]};
    const auto sums = [&](const std::vector<double>& m) {
      std::pair<Vec3, double> momentum_and_energy(Vec3::Zero(), 0);
      for (std::size_t k = 0; k < m.size(); ++k) {
        momentum_and_energy.first += m[k] * state.v[k];
        momentum_and_energy.second += 0.5 * m[k] * state.v[k].squaredNorm();
      }
      return momentum_and_energy;
    };
    const auto [had, energy] = sums(mass);
    join_lapsed(
      lapsed, [&](const std::uint32_t corner) { return mass[corner]; }, state);
    const auto [has, left] = sums(joined);
    EXPECT_LT((has - had).norm(), 1e-9);
    EXPECT_LE(left, (1 + 1e-9) * energy) << i;
  }
}

/// A cut leaves slivers above a plane of nodes, whose corners ring: with an integrator that takes no energy those that
/// are far out are damped, from the first cut on. It takes energy alone, and the body's momentum stays.
TEST(OnCorners, LightCornersOfElementsAreDamped) {
  GrowingCut block(whole_block());
  Elements physics(
    block.seen(),
    [](const CutBody& b) {
      return std::make_unique<fem::Hexahedra>(b.solid,
                                              fem::HexahedraOptions{.material = {}, .inertia = fem::Inertia::extended});
    },
    verlet);
  dynamics::State state = state_at_rest(physics);
  block.cut(support::cuts_of_plane(block.body, {Vec3::UnitZ(), 0.2015}), physics, state);
  const auto riders = riders_of(physics.own_model(), block.seen());
  EXPECT_GT(riders.n_riders(), 20u);
  support::Random random(5);
  state.v = random_points(state.v.size(), random);
  const Points far_out = random_points(state.x.size(), random);
  for (std::size_t i = 0; i < state.x.size(); ++i)
    state.x[i] += far_out[i];
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < state.v.size(); ++i)
      sum += physics.model().lumped_mass()[i] * state.v[i];
    return sum;
  };
  const Vec3 before = momentum();
  double energy = dynamics::kinetic_energy(physics.model(), state.v);
  for (int i = 0; i < 20; ++i) {
    damp_riders(physics.own_model(), riders, physics.model().lumped_mass(), {}, 1e-3, state);
    const double now = dynamics::kinetic_energy(physics.model(), state.v);
    EXPECT_LT(now, energy);
    energy = now;
  }
  EXPECT_LT((momentum() - before).norm(), 1e-9 * before.norm());

  dynamics::Loads loads; // every third corner slides across z
  dynamics::Support& support = loads.supports.emplace_back();
  support.held = dynamics::held_axes("z");
  for (std::uint32_t i = 0; i < state.v.size(); i += 3)
    support.corners.push_back(i);
  state.v = random_points(state.v.size(), random);
  for (const auto i : support.corners)
    state.v[i][2] = 0;
  const Points v = state.v;
  energy = dynamics::kinetic_energy(physics.model(), state.v);
  damp_riders(physics.own_model(), riders, physics.model().lumped_mass(), loads, 1e-3, state);
  EXPECT_LT(dynamics::kinetic_energy(physics.model(), state.v), energy);
  std::size_t n_moved = 0;
  for (const auto i : support.corners) {
    EXPECT_EQ(state.v[i][2], 0);
    n_moved += state.v[i] != v[i] ? 1 : 0;
  }
  EXPECT_GT(n_moved, 0u);
}

} // namespace
} // namespace kerf::physics::on_corners_test
