// Phyxels behind the contract of a backend: corners that follow, forces carried over, cuts seen under a budget.

#include "physics/phyxels.h"

#include "base/union_find.h"
#include "grid/locate.h"
#include "tests/physics/cut_bodies.h"

#include <gtest/gtest.h>

namespace kerf::physics::phyxels_test {
namespace {

const support::Plane middle{Vec3(0.8, 0.6, 0), 0.45};

support::Body whole_block() { return support::block({6, 4, 4}, 0.1); }

PhyxelsOptions options(const std::string& criterion = "extended visibility", const int budget = 0) {
  PhyxelsOptions o;
  o.phyxels = {.sampling = {.spacing = 0.07}, .n_neighbours = 24};
  o.material = {.density = 1000, .youngs_modulus = 1e4, .poissons_ratio = 0.3};
  o.visibility.choice.criterion = criterion;
  o.visibility.budget = budget;
  return o;
}

/// What the plane crosses where z < most: a cut with a front.
cut::SweepCuts cut_up_to(const support::Body& body, const support::Plane& plane, const double most) {
  cut::SweepCuts cuts = support::cuts_of_plane(body, plane);
  std::erase_if(cuts.cuts,
                [&](const grid::EdgeCut& c) { return body.grid.position(body.grid.ends(c.edge)[0])[2] > most; });
  std::erase_if(cuts.of_skin, [&](const grid::SkinCut& c) {
    return (c.segment.face.valid() ? grid::centre(body.grid, c.segment.face)
                                   : grid::centre(body.grid, c.segment.cell))[2] > most;
  });
  return cuts;
}

/// Sum of weights 1, weights times rest the point: so forces keep their sum and their torque.
void expect_forces_kept(const GrowingCut& block, const Phyxels& physics, support::Random& random) {
  const auto of_corners = block.surface.weights;
  const auto carried = physics.carry(of_corners);
  ASSERT_EQ(carried.n_points(), block.surface.rest.size());
  Points forces(physics.rest().size(), Vec3::Zero());
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t i = 0; i < carried.n_points(); ++i) {
    double weight = 0;
    for (auto k = carried.start[i]; k < carried.start[i + 1]; ++k)
      weight += carried.values[k];
    EXPECT_NEAR(weight, 1, 1e-12);
    EXPECT_LT((carried.at(i, physics.rest()) - block.surface.rest[i]).norm(), 1e-9);
    const Vec3 f = support::random_vector(random);
    carried.add_force(i, f, forces);
    sum += f;
    torque += block.surface.rest[i].cross(f);
  }
  for (std::size_t p = 0; p < forces.size(); ++p) {
    sum -= forces[p];
    torque -= physics.rest()[p].cross(forces[p]);
  }
  EXPECT_LT(sum.norm(), 1e-10);
  EXPECT_LT(torque.norm(), 1e-8);
}

TEST(Phyxels, CarryForcesWithTheirSumAndTorque) {
  for (const std::string& criterion : visibility::criteria()) {
    SCOPED_TRACE(criterion);
    support::Random random(2);
    GrowingCut block(whole_block());
    Phyxels physics(block.seen(), options(criterion), verlet);
    dynamics::State state = state_at_rest(physics);
    expect_forces_kept(block, physics, random);
    block.cut(cut_up_to(block.body, middle, 0.25), physics, state);
    expect_forces_kept(block, physics, random);
    block.cut(support::cuts_of_plane(block.body, middle), physics, state);
    ASSERT_EQ(grid::n_pieces(block.body.complex), 2u);
    expect_forces_kept(block, physics, random);
  }
}

/// After any cuts, even where few phyxels are in sight, no force is lost.
TEST(Phyxels, CarryForcesWithTheirSumAfterAnyCuts) {
  support::Random random(7);
  GrowingCut block(whole_block());
  Phyxels physics(block.seen(), options(), verlet);
  dynamics::State state = state_at_rest(physics);
  for (int batch = 0; batch < 5; ++batch) {
    block.cut(support::with_skin(block.body, support::random_cuts(random, block.body, 0.15)), physics, state);
    const auto carried = physics.carry(block.surface.weights);
    for (std::size_t i = 0; i < carried.n_points(); ++i) {
      double weight = 0;
      for (auto k = carried.start[i]; k < carried.start[i + 1]; ++k)
        weight += carried.values[k];
      EXPECT_NEAR(weight, 1, 1e-9);
    }
  }
  EXPECT_GT(grid::n_pieces(block.body.complex), 2u);
}

/// Whatever is cut, phyxels of one piece are joined by bonds of some weight whose direction the model knows, or by
/// links: what the copies hold together does not drift apart.
TEST(Phyxels, PiecesStayTogether) {
  support::Random random(7);
  GrowingCut block(whole_block());
  Phyxels physics(block.seen(), options(), verlet);
  dynamics::State state = state_at_rest(physics);
  const pba::PhyxelModel& model = physics.model();
  EXPECT_TRUE(model.links().pairs.empty()) << "nothing is cut";
  std::size_t n_links = 0, n_astray = 0;
  for (int batch = 0; batch < 5; ++batch) {
    block.cut(support::with_skin(block.body, support::random_cuts(random, block.body, 0.15)), physics, state);
    const auto pieces = pba::phyxel_pieces(block.body.complex, grid::copies_around(block.body, physics.rest()));
    UnionFind parts(physics.rest().size());
    const auto join = [&](const pba::Pair& pair, const double weight) {
      const auto [i, j] = pair;
      const Vec3 X = (physics.rest()[j] - physics.rest()[i]).normalized();
      const bool is_known = X.dot(model.fits()[i].used * X) > 0.3 || X.dot(model.fits()[j].used * X) > 0.3;
      if (weight < 5e-3 || !is_known) // what is lighter holds nothing
        return;
      EXPECT_EQ(pieces[i], pieces[j]);
      parts.unite(i, j);
    };
    for (std::size_t p = 0; p < model.weights().size(); ++p)
      join(model.neighbours().pairs[p], model.weights()[p]);
    for (std::size_t l = 0; l < model.link_weights().size(); ++l)
      join(model.links().pairs[l], model.link_weights()[l]);
    n_links += model.link_weights().size();
    const pba::CornerMap& map = physics.map();
    const auto pieces_of_corners = grid::corner_pieces(block.body.complex);
    for (std::size_t c = 0; c < pieces_of_corners.size(); ++c)
      for (auto s = map.source_start[c]; s < map.source_start[c + 1]; ++s)
        for (auto k = map.rows.start[map.source[s]]; k < map.rows.start[map.source[s] + 1]; ++k)
          n_astray += pieces[map.rows.columns[k]] != pieces_of_corners[c] ? 1 : 0;
    EXPECT_TRUE(n_astray == 0 || map.n_orphans > 0) << "corners follow phyxels of their piece where there are any";
    for (std::uint32_t i = 0; i < pieces.size(); ++i)
      for (std::uint32_t j = 0; j < i; ++j)
        if (pieces[i] == pieces[j]) {
          EXPECT_EQ(parts.root(i), parts.root(j)) << i << ", " << j;
        }
  }
  EXPECT_GT(grid::n_pieces(block.body.complex), 2u);
  EXPECT_GT(n_links, 10u);
}

/// Sum of what weights differ by.
double difference(const std::span<const double> a, const std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += std::abs(a[i] - b[i]);
  return sum;
}

/// A block whose phyxels see a cut in the plane z = .23 that comes from x = 0.
struct SlitBlock {
  GrowingCut block{whole_block(), cut::Fronts::of_points};
  std::vector<visibility::Face> skin = skin_of(block);
  Phyxels physics{block.seen(), options(), verlet};
  dynamics::State state = state_at_rest(physics);
  std::vector<double> whole = weights();

  static std::vector<visibility::Face> skin_of(const GrowingCut& block) {
    std::vector<visibility::Face> skin;
    for (const auto& t : block.surface.triangles)
      skin.push_back({block.surface.rest[t[0]], block.surface.rest[t[1]], block.surface.rest[t[2]]});
    return skin;
  }
  std::vector<double> weights() {
    const auto now = physics.model().weights();
    return {now.begin(), now.end()};
  }
  /// The weights that the two triangles of the slit up to x = end would leave, longer by the lag of fronts.
  std::vector<double> weights_at(const double slit_end) {
    const double end = slit_end + pba::front_lag(physics.model().phyxels());
    visibility::PairSights sights(visibility::make_criterion(options().visibility.choice, skin));
    const auto& [pairs, supports] = std::tie(physics.model().neighbours().pairs, physics.model().neighbours().support);
    std::vector<visibility::Pair> watched;
    for (std::size_t p = 0; p < pairs.size(); ++p)
      watched.push_back({physics.rest()[pairs[p][0]], physics.rest()[pairs[p][1]], supports[p]});
    sights.watch(visibility::PairId(0), watched);
    const Vec3 a(0, -0.25, 0.23), b(end, -0.25, 0.23), c(end, 0.75, 0.23), d(0, 0.75, 0.23);
    sights.add_faces(std::vector<visibility::Face>{{a, b, c}, {a, c, d}});
    sights.update(pairs.size());
    std::vector<pba::Sight> seen;
    for (std::uint32_t p = 0; p < pairs.size(); ++p)
      seen.push_back(sights.sights()[visibility::PairId(p)]);
    physics.model().update(seen);
    return weights();
  }
};

/// A rectangle that ends inside cells weakens bonds as its own two triangles would, wherever it ends.
TEST(Phyxels, SeeARectangleAsFarAsItHasCome) {
  for (const double end : {0.27, 0.31, 0.33, 0.36, 0.40, 0.43}) {
    SlitBlock slit;
    slit.block.cut(cut::Rectangle{Vec3(end / 2, 0.25, 0.23), Vec3(end, 0, 0), Vec3(0, 1, 0)}, slit.physics, slit.state);
    const auto found = slit.weights(), wanted = slit.weights_at(end);
    EXPECT_LT(difference(found, wanted), 0.05 * difference(slit.whole, wanted)) << end;
  }
}

/// So does a blade that stops there, however it steps, and comes there twice. (Right at a node, .4, round-off decides.)
TEST(Phyxels, SeeABladeAsFarAsItHasCome) {
  for (const auto& [end, step] : {std::pair(0.27, 0.021), {0.31, 0.13}, {0.33, 0.003}, {0.36, 0.021}, {0.39, 0.021},
                                  {0.39, 0.13}, {0.43, 0.06}}) {
    SlitBlock slit;
    const cut::Blade blade{
      "blade",
      {Vec3(0, -0.3, 0.23), Vec3(0, 0.8, 0.23)},
      {{0, Vec3(-0.2, 0, 0)},
       {end + 0.2, Vec3(end, 0, 0)},
       {end + 0.4, Vec3(end - 0.2, 0, 0)},
       {end + 0.6, Vec3(end, 0, 0)}}};
    for (double t = 0; t < end + 0.6 + 3 * step; t += step) // what waits is cut in the last ones
      slit.block.step(blade, t, t + step, slit.physics, slit.state);
    const auto found = slit.weights(), wanted = slit.weights_at(end);
    EXPECT_LT(difference(found, wanted), 0.05 * difference(slit.whole, wanted)) << end << " " << step;
  }
}

/// Whether all phyxels that a corner follows know their gradient in all directions; a cut may have left some too few
/// neighbours.
bool sees_whole_gradients(Phyxels& physics, const std::size_t corner) {
  const pba::CornerMap& map = physics.map();
  for (auto s = map.source_start[corner]; s < map.source_start[corner + 1]; ++s)
    for (auto k = map.rows.start[map.source[s]]; k < map.rows.start[map.source[s] + 1]; ++k)
      if (physics.model().fits()[map.rows.columns[k]].determinant < 1 - 1e-12)
        return false;
  return true;
}

TEST(Phyxels, LinearMotionMovesCornersLinearly) {
  support::Random random(5);
  GrowingCut block(whole_block());
  Phyxels physics(block.seen(), options(), verlet);
  dynamics::State state = state_at_rest(physics);
  EXPECT_EQ(state.x, physics.rest());
  Mat3 G;
  G << support::random_vector(random), support::random_vector(random), support::random_vector(random);
  const Vec3 shift = support::random_vector(random);
  for (std::size_t i = 0; i < state.x.size(); ++i)
    state.x[i] = G * physics.rest()[i] + shift;
  const auto expect_linear = [&] {
    physics.follow(state);
    const Points rest = grid::rest_positions(block.body);
    ASSERT_EQ(physics.corners(state).size(), rest.size());
    std::size_t n_known = 0;
    for (std::size_t c = 0; c < rest.size(); ++c)
      if (sees_whole_gradients(physics, c)) {
        ++n_known;
        EXPECT_LT((physics.corners(state)[c] - G * rest[c] - shift).norm(), 1e-9);
      } else {
        EXPECT_LT((physics.corners(state)[c] - G * rest[c] - shift).norm(), 0.05) << "half a cube";
      }
    EXPECT_GT(n_known, rest.size() * 3 / 4);
  };
  expect_linear();
  block.cut(cut_up_to(block.body, middle, 0.25), physics, state);
  expect_linear();
  block.cut(support::cuts_of_plane(block.body, middle), physics, state);
  expect_linear();
}

/// What lies in different pieces is parted in the step of the cut, though the criterion has looked at one pair only.
TEST(Phyxels, PiecesPartAtOnce) {
  GrowingCut block(whole_block());
  Phyxels physics(block.seen(), options("extended visibility", 1), verlet);
  dynamics::State state = state_at_rest(physics);
  EXPECT_EQ(physics.n_waiting(), 0u);
  block.cut(support::cuts_of_plane(block.body, middle), physics, state);
  EXPECT_GT(physics.n_waiting(), 100u);
  const auto piece = pba::phyxel_pieces(block.body.complex, grid::copies_around(block.body, physics.rest()));
  std::size_t n_across = 0, n_beside = 0;
  const auto& pairs = physics.model().neighbours().pairs;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const bool across = piece[pairs[p][0]] != piece[pairs[p][1]];
    n_across += across;
    n_beside += !across && physics.model().weights()[p] > 0;
    if (across) {
      EXPECT_EQ(physics.model().weights()[p], 0);
    }
  }
  EXPECT_GT(n_across, 100u);
  EXPECT_GT(n_beside, 100u);
  const Vec3 away(0.3, 0, 5);
  Points x = physics.rest(), forces(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (piece[i] == 1)
      x[i] += away;
  physics.model().force(x, forces);
  for (const Vec3& f : forces)
    EXPECT_LT(f.norm(), 1e-9) << "pieces are free of each other";
  state.x = x;
  physics.follow(state);
  const auto pieces = grid::corner_pieces(block.body.complex);
  const Points rest = grid::rest_positions(block.body);
  for (std::size_t c = 0; c < rest.size(); ++c)
    EXPECT_LT((physics.corners(state)[c] - rest[c] - (pieces[c] == 1 ? away : Vec3(Vec3::Zero()))).norm(), 1e-9);
}

/// A budget makes work wait, first come first served; in the end all is as without one.
TEST(Phyxels, ABudgetCatchesUp) {
  GrowingCut hasty(whole_block()), slow(whole_block());
  Phyxels all(hasty.seen(), options("extended visibility", 0), verlet);
  Phyxels some(slow.seen(), options("extended visibility", 60), verlet);
  dynamics::State a = state_at_rest(all), b = state_at_rest(some);
  const auto cuts = cut_up_to(hasty.body, middle, 0.25);
  hasty.cut(cuts, all, a);
  slow.cut(cuts, some, b);
  EXPECT_EQ(all.n_waiting(), 0u);
  const std::size_t n = some.n_waiting();
  ASSERT_GT(n, 200u);
  GrowingCut third(whole_block());
  Phyxels hardly_any(third.seen(), options("extended visibility", 1), verlet);
  dynamics::State c = state_at_rest(hardly_any);
  third.cut(cuts, hardly_any, c);
  EXPECT_EQ(hardly_any.n_waiting(), n) << "the cut itself takes nothing of a step's budget";
  const auto same = [&] {
    return std::equal(all.model().weights().begin(), all.model().weights().end(), some.model().weights().begin()) &&
           all.map().rows.values == some.map().rows.values && all.map().rows.columns == some.map().rows.columns;
  };
  EXPECT_FALSE(same());
  std::size_t left = n;
  for (int step = 0; left > 0; ++step) {
    some.catch_up(slow.seen());
    EXPECT_EQ(some.n_waiting(), left > 60 ? left - 60 : 0);
    left = some.n_waiting();
    ASSERT_LT(step, 1000);
  }
  EXPECT_TRUE(same());
}

/// Nothing of the cut exists before the first one; a cut weakens and never strengthens.
TEST(Phyxels, ACutOnlyWeakens) {
  for (const std::string& criterion : visibility::criteria()) {
    SCOPED_TRACE(criterion);
    GrowingCut block(whole_block());
    Phyxels physics(block.seen(), options(criterion), verlet);
    dynamics::State state = state_at_rest(physics);
    std::vector<double> before(physics.model().weights().begin(), physics.model().weights().end());
    for (const double most : {0.15, 0.25, 1.0}) {
      const cut::SweepCuts cuts = cut_up_to(block.body, middle, most);
      block.cut(cuts, physics, state);
      double lost = 0;
      for (std::size_t p = 0; p < before.size(); ++p) {
        EXPECT_LE(physics.model().weights()[p], before[p] * (1 + 1e-12));
        lost += before[p] - physics.model().weights()[p];
      }
      EXPECT_GT(lost, 1);
      before.assign(physics.model().weights().begin(), physics.model().weights().end());
    }
  }
}

/// What integrators remember of forces is no longer true after a cut; positions and velocities are.
TEST(Phyxels, StateOutlivesACut) {
  support::Random random(3);
  GrowingCut block(whole_block());
  Phyxels physics(block.seen(), options(), verlet);
  dynamics::State state = state_at_rest(physics);
  state.v = random_points(state.x.size(), random);
  state.history = {{"before", state.v}, {"acceleration", state.v}};
  const dynamics::State before = state;
  block.cut(support::cuts_of_plane(block.body, middle), physics, state);
  EXPECT_EQ(state.x, before.x);
  EXPECT_EQ(state.v, before.v);
  EXPECT_EQ(state.history.at("before"), before.v);
  EXPECT_FALSE(state.history.contains("acceleration"));
}

} // namespace
} // namespace kerf::physics::phyxels_test
