// What a cut gives is let out: of bodies that are bent and crumpled, with every backend.

#include "dynamics/forces.h"
#include "dynamics/handle.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/quantities.h"
#include "physics/on_corners.h"
#include "physics/phyxels.h"
#include "tests/physics/cut_bodies.h"

#include <gtest/gtest.h>

namespace kerf::physics::relief_test {
namespace {

using MakePhysics = std::function<std::unique_ptr<Physics>(const CutBody&)>;

const material::Elastic rubber{.density = 1000, .youngs_modulus = 1e4, .poissons_ratio = 0.4};

MakePhysics elements(const fem::Strain strain) {
  return [=](const CutBody& body) {
    return std::make_unique<Elements>(
      body,
      [=](const CutBody& b) {
        return std::make_unique<fem::Hexahedra>(b.solid, fem::HexahedraOptions{.material = rubber, .strain = strain});
      },
      verlet);
  };
}

std::unique_ptr<Physics> springs(const CutBody& body) {
  return std::make_unique<Springs>(
    body, [](const CutBody& b) { return std::make_unique<spring::MassSpring>(b.solid, spring::MassSpringOptions{}); },
    verlet);
}

std::unique_ptr<Physics> shape_matching(const CutBody& body) {
  return std::make_unique<ShapeMatching>(
    body, [](const CutBody& b) { return std::make_unique<lattice::Matching>(b.solid, lattice::MatchingOptions{}); },
    [](lattice::Matching& model, const PiecesOfParticles&) {
      return std::make_unique<lattice::ShapeMatching>(model, 0);
    });
}

std::unique_ptr<Physics> points(const CutBody& body) {
  PhyxelsOptions options;
  options.phyxels = {.sampling = {.spacing = 0.07}, .n_neighbours = 24};
  options.material = rubber;
  return std::make_unique<Phyxels>(body, options, verlet);
}

const std::vector<std::pair<std::string, MakePhysics>>& backends() {
  static const std::vector<std::pair<std::string, MakePhysics>> all = {{"trilinear", elements(fem::Strain::trilinear)},
                                                                      {"enhanced", elements(fem::Strain::enhanced)},
                                                                      {"springs", springs},
                                                                      {"lattice", shape_matching},
                                                                      {"points", points}};
  return all;
}

/// Bent over its length by `bend` [1/m], and each particle off its place by about `noise` [m].
void crumple(const Physics& physics, const double bend, const double noise, support::Random& random,
             dynamics::State& state) {
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Vec3& X = physics.rest()[i];
    state.x[i] = X + Vec3(0, 0, bend * X[0] * X[0]) + noise * support::random_vector(random);
    state.v[i] = support::random_vector(random);
  }
}

struct Moments {
  double mass = 0;
  Vec3 moment = Vec3::Zero(), momentum = Vec3::Zero(), angular = Vec3::Zero();
};

Moments moments(Physics& physics, const dynamics::State& state) {
  Moments all;
  const auto mass = physics.model().lumped_mass();
  for (std::size_t i = 0; i < mass.size(); ++i) {
    all.mass += mass[i];
    all.moment += mass[i] * state.x[i];
    all.momentum += mass[i] * state.v[i];
    all.angular += mass[i] * state.x[i].cross(state.v[i]);
  }
  return all;
}

/// Where there is more energy than before, that is let out; where not, nothing happens to elements, points and springs.
/// What is free keeps its momenta and its masses' centre.
TEST(Relief, LetsOutWhatCutsGive) {
  for (const auto& [name, make] : backends()) {
    SCOPED_TRACE(name);
    int n_given = 0, n_let_out = 0;
    for (const unsigned seed : {1u, 2u, 3u}) {
      support::Random random(seed);
      GrowingCut block(support::block({5, 4, 4}, 0.1));
      const auto physics = make(block.seen());
      dynamics::State state = state_at_rest(*physics);
      for (int batch = 0; batch < 9; ++batch) {
        // Points give something where a bend is smooth, the lattice where it is steep, enhanced elements where noise is
        // most.
        const bool is_steep = batch % 3 != 2;
        crumple(*physics, is_steep ? 2 : 0.6, batch % 3 == 0 ? 0 : 0.01, random, state);
        const double had = physics->model().energy(state.x);
        const double part = is_steep ? 0.02 : 0.08;
        const auto change =
          block.cut(support::with_skin(block.body, support::random_cuts(random, block.body, part)), *physics, state);
        const double most = dynamics::most_after_cut(physics->model(), had, state.v),
                     given = physics->model().energy(state.x);
        const Moments before = moments(*physics, state);
        const dynamics::State as_cut = state;
        dynamics::Loads loads;
        loads.carried = physics->crumbs().carried();
        physics->let_out(block.seen(), change, {had, 0}, loads, state);
        const double left = physics->model().energy(state.x);
        if (given > most) {
          ++n_given;
          n_let_out += left <= most ? 1 : 0;
          EXPECT_LT(left, given);
        } else if (name != "lattice") {
          EXPECT_EQ(state.x, as_cut.x);
          EXPECT_EQ(state.v, as_cut.v);
        }
        const Moments after = moments(*physics, state);
        EXPECT_LT((after.moment - before.moment).norm(), 1e-12 * before.mass);
        EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * before.mass);
        EXPECT_LT((after.angular - before.angular).norm(), 1e-10 * before.mass);
        EXPECT_EQ(state.time, as_cut.time);
      }
    }
    EXPECT_EQ(n_let_out, n_given);
    const bool gives_none = name == "trilinear" || name == "springs"; // of these cuts
    EXPECT_GE(n_given, gives_none ? 0 : 1);
  }
}

/// Where a cut has touched one corner, which cannot let out half of the body's energy by itself.
TEST(Relief, IsOfMoreThanTheTouchedWhereThatIsNotEnough) {
  const auto body = support::with_copies(support::with_placed_skin(support::block({5, 4, 4}, 0.1)));
  const Points rest = grid::rest_positions(body);
  support::Random random(1);
  dynamics::State crumpled{rest, Points(rest.size(), Vec3::Zero())};
  for (Vec3& x : crumpled.x)
    x += Vec3(0, 0, 2 * x[0] * x[0]) + 0.01 * support::random_vector(random);
  const auto check = [&](const dynamics::ForceModel& model, const auto& relief_of) {
    dynamics::State state = crumpled;
    const double given = model.energy(state.x), most = 0.5 * given;
    dynamics::Excess excess{.most = most,
                            .touched = std::vector<std::uint8_t>(rest.size(), 0),
                            .piece = [&] { return std::vector<std::uint32_t>(rest.size(), 0); }};
    excess.touched[rest.size() / 2] = 1;
    relief_of(std::move(excess))->step(state, {}, 0);
    EXPECT_LE(model.energy(state.x), most * (1 + 1e-9));
  };
  fem::Hexahedra elements(body, {.material = rubber});
  check(elements, [&](dynamics::Excess excess) { return relief_of(elements, std::move(excess)); });
  const lattice::Matching matching(body, {});
  check(matching, [&](dynamics::Excess excess) { return relief_of(matching, std::move(excess)); });
}

/// A body that hangs in balance has nothing to let out: what a cut seems to give it stays, where the whole body would
/// otherwise shrink, and rise by more.
TEST(Relief, LiftsNothingThatHangs) {
  const auto body = support::with_copies(support::with_placed_skin(support::block({5, 4, 4}, 0.1)));
  const Points rest = grid::rest_positions(body);
  fem::Hexahedra model(body, {.material = rubber});
  dynamics::Loads loads{.gravity = Vec3(3, 0, 0), .supports = {}};
  dynamics::Support wall{{}, {}, [](double) { return Vec3(Vec3::Zero()); }};
  const auto left = std::ranges::min_element(rest, {}, [](const Vec3& X) { return X[0]; });
  for (std::uint32_t i = 0; i < rest.size(); ++i)
    if (rest[i][0] < (*left)[0] + 1e-9) {
      wall.corners.push_back(i);
      wall.rest.push_back(rest[i]);
    }
  loads.supports.push_back(std::move(wall));
  dynamics::State state{rest, Points(rest.size(), Vec3::Zero())};
  dynamics::ImplicitEulerOptions to_balance{.n_newton = 50, .cg_tolerance = 1e-12, .newton_tolerance = 1e-8};
  to_balance.line_search = dynamics::LineSearch::backtracking;
  dynamics::ImplicitEuler(model, to_balance).step(state, loads, 100);
  state.v.assign(rest.size(), Vec3::Zero());
  const dynamics::State hangs = state;
  const auto height = [&](const dynamics::State& at) { return dynamics::gravity_energy(model, loads, at.x); };
  const double elastic = model.energy(state.x);
  ASSERT_GT(elastic, 0.1 * std::abs(height(state) - dynamics::gravity_energy(model, loads, rest)));
  dynamics::Excess excess{.most = 0.8 * elastic,
                          .touched = std::vector<std::uint8_t>(rest.size(), 0),
                          .piece = [&] { return std::vector<std::uint32_t>(rest.size(), 0); }};
  relief_of(model, std::move(excess))->step(state, loads, 0);
  EXPECT_LT(std::abs(height(state) - height(hangs)), 1e-3 * elastic);
  EXPECT_LE(model.energy(state.x) + height(state), elastic + height(hangs) + 1e-9 * elastic);
}

/// What a handle holds drawn out does not snap away from it.
TEST(Relief, GivesAHandleNoMoreThanItLetsOut) {
  const auto body = support::with_copies(support::with_placed_skin(support::block({5, 4, 4}, 0.1)));
  const Points rest = grid::rest_positions(body);
  support::Random random(5);
  const auto check = [&](const dynamics::ForceModel& model, const double stiffness, const auto& relief_of) {
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero()), 0.25};
    for (Vec3& x : state.x)
      x[0] += 0.2 * x[0] + 0.005 * support::random_vector(random)[0];
    const double had = model.energy(state.x);
    std::uint32_t right = 0;
    for (std::uint32_t i = 1; i < rest.size(); ++i)
      if (model.lumped_mass()[i] > 0.5 * rubber.density * 1e-3 && rest[i][0] > rest[right][0])
        right = i;
    Interpolation point;
    point.add_entry(right, 1);
    point.end_row();
    dynamics::Loads loads;
    loads.acting.push_back(std::make_unique<dynamics::HandleSpring>(
      point, stiffness * had,
      [x = state.x[right]](const double time) { return Vec3(x + (time - 0.25) * Vec3::UnitY()); }));
    const dynamics::State drawn = state;
    dynamics::Excess excess{.most = 0.3 * had,
                            .touched = std::vector<std::uint8_t>(rest.size(), 1),
                            .piece = [&] { return std::vector<std::uint32_t>(rest.size(), 0); }};
    relief_of(std::move(excess))->step(state, loads, 0);
    const double given = dynamics::load_energy(loads, state.time, state.x);
    EXPECT_LE(model.energy(state.x) + given, 1.02 * had); // light corners of a lattice go to their goals in any case
    return given / had;
  };
  fem::Hexahedra elements(body, {.material = rubber});
  EXPECT_LT(check(elements, 1e5, [&](dynamics::Excess excess) { return relief_of(elements, std::move(excess)); }), 0.1);
  const lattice::Matching matching(body, {});
  check(matching, 1e3, [&](dynamics::Excess excess) { return relief_of(matching, std::move(excess)); });
}

/// What is drawn out and let go shrinks, but not where that lifts it by more than it lets out.
TEST(Relief, LiftsByNoMoreThanItLetsOut) {
  const auto body = support::with_copies(support::with_placed_skin(support::block({5, 4, 4}, 0.1)));
  const Points rest = grid::rest_positions(body);
  const auto left = std::ranges::min_element(rest, {}, [](const Vec3& X) { return X[0]; });
  dynamics::Support wall{{}, {}, [](double) { return Vec3(Vec3::Zero()); }};
  for (std::uint32_t i = 0; i < rest.size(); ++i)
    if (rest[i][0] < (*left)[0] + 1e-9) {
      wall.corners.push_back(i);
      wall.rest.push_back(rest[i]);
    }
  const auto check = [&](const dynamics::ForceModel& model, const auto& relief_of, const double part) {
    dynamics::State state{rest, Points(rest.size(), Vec3::Zero())};
    for (Vec3& x : state.x)
      x[0] += 0.1 * (x[0] - (*left)[0]);
    const dynamics::State drawn = state;
    const double had = model.energy(state.x);
    double moment = 0; // of what it is drawn out by
    for (std::size_t i = 0; i < rest.size(); ++i)
      moment += model.lumped_mass()[i] * (drawn.x[i] - rest[i])[0];
    dynamics::Loads loads{.gravity = Vec3(part * had / moment, 0, 0), .supports = {}};
    loads.supports.push_back(wall);
    dynamics::Excess excess{.most = 0.5 * had,
                            .touched = std::vector<std::uint8_t>(rest.size(), 1),
                            .piece = [&] { return std::vector<std::uint32_t>(rest.size(), 0); }};
    relief_of(std::move(excess))->step(state, loads, 0);
    const auto total = [&](const dynamics::State& at) {
      return model.energy(at.x) + dynamics::gravity_energy(model, loads, at.x);
    };
    EXPECT_LE(total(state) - total(drawn), 0.02 * had); // light corners of a lattice go to their goals in any case
    return model.energy(state.x) / had;
  };
  fem::Hexahedra elements(body, {.material = rubber});
  const auto of_elements = [&](dynamics::Excess excess) { return relief_of(elements, std::move(excess)); };
  const lattice::Matching matching(body, {});
  const auto of_lattice = [&](dynamics::Excess excess) { return relief_of(matching, std::move(excess)); };
  for (const double part : {0.0, 1e3}) { // of its energy, that lifting it to where it rests takes
    SCOPED_TRACE(part);
    EXPECT_EQ(check(elements, of_elements, part) < 0.6, part == 0);
    EXPECT_EQ(check(matching, of_lattice, part) < 0.6, part == 0);
  }
}

} // namespace
} // namespace kerf::physics::relief_test
