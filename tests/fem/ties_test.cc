#include "fem/ties.h"

#include "cut/cutter.h"
#include "dynamics/state.h"
#include "fem/hexahedra.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace kerf::fem::ties_test {
namespace {

/// A block with a disc in it whose front lies inside cells.
support::Body cracked(const double radius) {
  support::Body body = support::with_copies(support::with_placed_skin(support::block({6, 6, 6})));
  cut::Cutter cutter(1, cut::Release::queued, cut::Fronts::of_elements);
  cutter.begin(body, grid::rest_positions(body));
  const cut::Disc disc{Vec3(3.6, 3.4, 3.3), Vec3(0.1, 0.2, 1).normalized(), radius};
  surface::place(body, cutter.at_once(body, {"cut", disc, 1}, grid::rest_positions(body)), {});
  return body;
}

Points moved(const Points& rest, const double by) {
  support::Random random(5);
  Points x = rest;
  for (Vec3& p : x)
    p += by * support::random_vector(random);
  return x;
}

TEST(Ties, PullByTheGradientOfTheirEnergy) {
  const support::Body body = cracked(1.9);
  Ties ties;
  ties.update(body, {});
  ASSERT_GT(ties.all().size(), 20u);
  const Points x = moved(grid::rest_positions(body), 0.1), way = moved(Points(x.size(), Vec3::Zero()), 1);
  Points forces(x.size(), Vec3::Zero()), product(x.size(), Vec3::Zero());
  ties.add_force(x, forces);
  ties.add_product(dynamics::flat(way), dynamics::flat(product));
  const double step = 1e-4;
  const auto at = [&](const double s) {
    Points y = x;
    for (std::size_t c = 0; c < y.size(); ++c)
      y[c] += s * way[c];
    return ties.energy(y);
  };
  double power = 0, curvature = 0;
  for (std::size_t c = 0; c < x.size(); ++c) {
    power += forces[c].dot(way[c]);
    curvature += product[c].dot(way[c]);
  }
  EXPECT_NEAR((at(step) - at(-step)) / (2 * step), -power, 1e-6 * std::abs(power));
  EXPECT_NEAR((at(step) - 2 * at(0) + at(-step)) / (step * step), curvature, 1e-3 * curvature);
  std::vector<double> diagonal(x.size(), 0.0);
  ties.add_diagonal(diagonal);
  std::vector<Eigen::Triplet<double>> entries;
  ties.add_entries(entries);
  double trace = 0, sum = 0;
  for (const auto& entry : entries) {
    trace += entry.row() == entry.col() ? entry.value() : 0;
    sum += entry.value();
  }
  EXPECT_NEAR(trace, 3 * std::accumulate(diagonal.begin(), diagonal.end(), 0.0), 1e-12 * trace);
  EXPECT_NEAR(sum, 0, 1e-12 * trace); // rigid translations cost nothing
}

/// What is tied hangs together, so all of it is in a crumb or nothing: and a crumb is rigid. Its corners have no
/// number.
TEST(Ties, OfACrumbAreNone) {
  support::Body body = support::with_copies(support::with_placed_skin(support::block({12, 6, 6})));
  cut::Cutter cutter(2, cut::Release::queued, cut::Fronts::of_elements);
  const Points rest = grid::rest_positions(body);
  cutter.begin(body, rest);
  surface::place(body, cutter.at_once(body, {"through", cut::Disc{Vec3(6.4, 3, 3), Vec3::UnitX(), 100}, 1}, rest), {});
  const Points x = grid::rest_positions(body);
  const cut::Disc crack{Vec3(2.6, 3.4, 3.3), Vec3(0.1, 0.2, 1).normalized(), 1.4};
  surface::place(body, cutter.at_once(body, {"crack", crack, 2}, x), {});
  ASSERT_GT(grid::ties(body).size(), 8u);
  const grid::Pieces pieces = grid::pieces(body.complex);
  ASSERT_EQ(pieces.n_pieces, 2u);
  // As if the piece with the crack were one.
  grid::Crumbs& crumbs = body.crumbs;
  crumbs.all.push_back({1, {}});
  crumbs.of_corner.assign(body.complex.n_corners(), 0);
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    if (pieces.piece[c] == pieces.piece[body.complex.tied[0][0]]) {
      crumbs.all[0].copies.push_back(c);
      crumbs.set(c, 1);
      for (const grid::CornerId corner : body.complex.copies[c].corners)
        crumbs.of_corner[corner.value] = 1;
    }
  EXPECT_TRUE(grid::ties(body).empty());
  const Hexahedra model(body, {.material = {}, .counted = grid::Counted::deforming});
  ASSERT_LT(model.numbers().size(), body.complex.n_corners());
  Points of_numbers;
  model.numbers().gather(moved(grid::rest_positions(body), 0.1), of_numbers);
  EXPECT_GT(model.energy(of_numbers), 0);
  EXPECT_TRUE(std::isfinite(model.energy(of_numbers)));
}

/// A body that has not opened exerts no force, and neither does one that was moved affinely and as one.
TEST(Ties, RestWhereTheCutIsClosed) {
  const support::Body body = cracked(1.9);
  const Hexahedra model(body, {});
  const Points rest = grid::rest_positions(body);
  Points forces;
  model.force(rest, forces);
  for (const Vec3& f : forces)
    EXPECT_LT(f.norm(), 1e-9 * model.material().youngs_modulus);
}

/// By what hangs at each corner and what it weighs, whatever the material.
TEST(Ties, AreSoftForExplicitSteps) {
  const support::Body body = cracked(1.55);
  const material::Elastic rubber{.density = 1200, .youngs_modulus = 3e5, .poissons_ratio = 0.4};
  const Hexahedra model(body, {.material = rubber, .inertia = Inertia::extended});
  const double square_frequency = 2 * std::pow(rubber.pressure_wave_speed() / body.grid.h(), 2);
  const Ties soft = model.ties(body), stiff = Hexahedra(body, {.material = rubber}).ties(body);
  const auto sums = [&](const Ties& ties) {
    std::vector<double> sums(body.complex.n_corners(), 0.0);
    for (const Tie& tie : ties.all())
      for (const std::uint32_t corner : {tie.a, tie.b})
        sums[corner] += tie.stiffness;
    return sums;
  };
  const std::vector<double> of_soft = sums(soft), of_stiff = sums(stiff);
  int n_reached = 0, n_beyond = 0;
  for (std::size_t c = 0; c < of_soft.size(); ++c) {
    const double most = model.lumped_mass()[c] * square_frequency;
    EXPECT_LE(of_soft[c], (1 + 1e-12) * most);
    n_reached += of_soft[c] > (1 - 1e-12) * most;
    n_beyond += of_stiff[c] > most;
  }
  EXPECT_GT(n_reached, 3);
  EXPECT_GT(n_beyond, n_reached);
  ASSERT_EQ(soft.all().size(), stiff.all().size());
  int n_same = 0;
  for (std::size_t i = 0; i < soft.all().size(); ++i) {
    const auto& [a, b, k] = soft.all()[i];
    const auto& [a_stiff, b_stiff, k_stiff] = stiff.all()[i];
    EXPECT_TRUE(a == a_stiff && b == b_stiff);
    EXPECT_LE(k, k_stiff);
    const bool bears_it =
      std::max(of_stiff[a] / model.lumped_mass()[a], of_stiff[b] / model.lumped_mass()[b]) < square_frequency;
    if (bears_it) {
      EXPECT_EQ(k, k_stiff);
    }
    n_same += bears_it;
  }
  EXPECT_GT(n_same, 3);
}

/// Corners that are tied are at one place at rest: no moment of the body changes.
TEST(Ties, ShareMassOfExplicitSteps) {
  const support::Body body = cracked(1.55);
  const std::vector<grid::Tie> ties = grid::ties(body);
  const Hexahedra plain(body, {.material = {}}), model(body, {.material = {}, .inertia = Inertia::extended});
  const std::vector<double>& extended = model.ghost_penalty().extended_mass();
  const auto shared = model.lumped_mass();
  const Points rest = grid::rest_positions(body);
  std::map<std::uint32_t, double> gained; // by node
  double total = 0, most = 0;
  for (std::size_t c = 0; c < rest.size(); ++c) {
    gained[body.complex.node[grid::CornerId(c)].value] += shared[c] - extended[c];
    EXPECT_GE(shared[c], (1 - 1.0 / 16) * extended[c]);
    total += shared[c];
    most = std::max(most, shared[c] / extended[c]);
  }
  for (const auto& [node, mass] : gained)
    EXPECT_NEAR(mass, 0, 1e-15 * total);
  EXPECT_NEAR(total, std::accumulate(plain.lumped_mass().begin(), plain.lumped_mass().end(), 0.0), 1e-13 * total);
  EXPECT_GT(most, 1.5);
  std::vector<double> heaviest(rest.size(), 0.0); // that each is tied to
  for (const grid::Tie& tie : ties)
    for (const auto& [c, d] : {std::pair(tie.a, tie.b), std::pair(tie.b, tie.a)})
      heaviest[c.value] = std::max(heaviest[c.value], extended[d.value]);
  for (std::size_t c = 0; c < rest.size(); ++c)
    EXPECT_LE(shared[c], std::max(extended[c], 2 * heaviest[c] / 16)); // of two at most
}

/// What the corners of a part of skin get is in proportion to its material, so that its ties bear it; and enough for
/// explicit steps.
TEST(Ties, AreNotLoadedBeyondWhatTheyHold) {
  std::vector<double> mass = {1, 1, 1e-6, 1e-7, 0.3};
  const auto corner = [](const std::uint32_t c) { return grid::CornerId(c); };
  const std::vector<grid::Tie> ties = {{corner(0), corner(2), 1}, {corner(0), corner(2), 1}, // by two cells
                                       {corner(3), corner(0), 1}, {corner(1), corner(3), 1},
                                       {corner(1), corner(4), 1}};
  const std::vector<double> enough = {9, 9, 4e-6, 0.9, 0.2};
  grid::share_mass(
    ties, [&](const grid::CornerId c) { return enough[c.value]; }, mass);
  EXPECT_NEAR(mass[2], 4e-6, 1e-12);                                 // all it needs
  EXPECT_NEAR(mass[3], 1e-7 + (1.0 / 32 - 1e-7) + (1.0 / 16 - 1e-7), 1e-12); // a 16th of each, one shared by two
  EXPECT_EQ(mass[4], 0.3);                                           // has enough
  EXPECT_NEAR(std::accumulate(mass.begin(), mass.end(), 0.0), 2.3 + 1.1e-6, 1e-14);
}

/// A cut that comes through the cells of its front leaves no ties there.
TEST(Ties, GoWithTheCut) {
  support::Body body = cracked(1.9);
  cut::Cutter cutter(1, cut::Release::queued, cut::Fronts::of_elements);
  cutter.begin(body, grid::rest_positions(body));
  const cut::Plane plane{Vec3(3.6, 3.4, 3.3), Vec3(0.1, 0.2, 1).normalized()};
  cutter.at_once(body, {"cut", plane, 1}, grid::rest_positions(body));
  Ties ties;
  ties.update(body, {});
  EXPECT_EQ(ties.all().size(), 0u);
  EXPECT_EQ(grid::n_pieces(body.complex), 2u);
}

} // namespace
} // namespace kerf::fem::ties_test
