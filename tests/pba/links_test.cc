// Links: which phyxels the copies of a body join, along which ways, and how stiff the bonds are that they become.

#include "pba/links.h"

#include "base/union_find.h"
#include "grid/locate.h"
#include "pba/corners.h"
#include "tests/pba/clouds.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

namespace kerf::pba::links_test {
namespace {

std::vector<Link> links_of(const support::Body& body, const Points& points) {
  return find_links(body, points, grid::copies_around(body, points));
}

/// A fork: two prongs of 6 x 1 x 1 cubes with a cut between them, which ends one cube before the root.
support::Body fork() {
  support::Body body = support::with_placed_skin(support::block({6, 2, 1}));
  auto cuts = support::plane_cuts(body, {Vec3::UnitY(), 1.5});
  std::erase_if(cuts, [&](const grid::EdgeCut& cut) { return body.grid.index(body.grid.ends(cut.edge)[0])[0] == 1; });
  support::cut_through(body, support::with_skin(body, cuts));
  return body;
}

/// Phyxels at the tips of both prongs are near each other and far apart: their way leads around the root.
TEST(Links, LeadThroughMaterial) {
  const support::Body body = fork();
  ASSERT_EQ(grid::n_pieces(body.complex), 1u);
  const Points points = {Vec3(6, 1, 1), Vec3(6, 2, 1), Vec3(3, 1, 1), Vec3(3, 2, 1)};
  const auto links = links_of(body, points);
  ASSERT_EQ(links.size(), 3u);
  EXPECT_EQ(links[0].pair, (Pair{0, 2})) << "along a prong";
  EXPECT_EQ(links[1].pair, (Pair{1, 3}));
  EXPECT_EQ(links[2].pair, (Pair{2, 3})) << "around the root";
  EXPECT_NEAR(links[0].length, 3, 2) << "by cubes";
  EXPECT_GT(links[2].length, 3.5);
  for (const Link& link : links)
    EXPECT_NEAR(link.area, 1, 0.75) << "of a prong of one cube";
}

/// Whatever is cut, links join all phyxels of a piece, and none of two.
TEST(Links, JoinPiecesAndNoMore) {
  support::Random random(3);
  for (int trial = 0; trial < 5; ++trial) {
    support::Body body = support::with_placed_skin(support::block({6, 5, 4}, 0.1));
    support::cut_through(body, support::with_skin(body, support::random_cuts(random, body, 0.5)));
    Draw draw(static_cast<unsigned>(trial));
    Points points;
    for (int i = 0; i < 60; ++i)
      points.push_back(Vec3(draw(0.06, 0.64), draw(0.06, 0.54), draw(0.06, 0.44)));
    const auto copies = grid::copies_around(body, points);
    const auto pieces = phyxel_pieces(body.complex, copies);
    UnionFind joined(points.size());
    double before = 0;
    for (const Link& link : links_of(body, points)) {
      EXPECT_EQ(pieces[link.pair[0]], pieces[link.pair[1]]);
      EXPECT_GE(link.length, before);
      EXPECT_GE(link.area, 0);
      before = link.length;
      joined.unite(link.pair[0], link.pair[1]);
    }
    std::size_t n_together = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i)
      for (std::uint32_t j = 0; j < i; ++j)
        if (pieces[i] == pieces[j]) {
          ++n_together;
          EXPECT_EQ(joined.root(i), joined.root(j));
        }
    EXPECT_GT(n_together, 100u);
  }
}

/// Two prongs of 6 x 2 x 2 cubes beside each other, one cube apart, joined at their root: they are near, and nothing of
/// one counts for the other. All that a solid block has, it keeps.
TEST(Links, NothingIsSeenAcrossGaps) {
  const double h = 0.1;
  for (const bool is_open : {true, false}) {
    std::vector<Index3> nodes = support::block_nodes({8, 5, 2});
    if (is_open)
      std::erase_if(nodes, [](const Index3& n) { return n[1] == 3 && n[0] > 2; });
    const support::Body body =
      support::with_copies(support::with_placed_skin(support::make_body({Vec3::Zero(), h}, nodes, support::midway)));
    const Phyxels phyxels = fill(body, {.sampling = {.spacing = h}, .n_neighbours = 25});
    const auto copies = grid::copies_around(body, phyxels.rest);
    const auto reached = reached_copies(body, phyxels, copies);
    const auto is_across = [&](const Vec3& a, const Vec3& b) {
      return std::min(a[0], b[0]) > 4.5 * h && (a[1] - 3 * h) * (b[1] - 3 * h) < 0;
    };
    const auto n_across = [&](const Points& from, const std::vector<Pair>& pairs) {
      return std::count_if(pairs.begin(), pairs.end(),
                           [&](const Pair& pair) { return is_across(from[pair[0]], phyxels.rest[pair[1]]); });
    };
    const Neighbours all = find_neighbours(phyxels), kept = reached_neighbours(phyxels, copies, reached);
    const NodePairs nodes_all = find_node_pairs(body.grid, phyxels),
                    nodes_kept = reached_node_pairs(body, phyxels, reached);
    EXPECT_GT(n_across(phyxels.rest, all.pairs), 10);
    EXPECT_GT(n_across(nodes_all.rest, nodes_all.pairs), 10);
    if (is_open) {
      EXPECT_EQ(n_across(phyxels.rest, kept.pairs), 0);
      EXPECT_EQ(n_across(nodes_kept.rest, nodes_kept.pairs), 0);
    } else {
      EXPECT_EQ(kept.pairs, all.pairs);
      EXPECT_EQ(kept.support, all.support);
      EXPECT_EQ(nodes_kept.pairs, nodes_all.pairs);
    }
    EXPECT_EQ(nodes_kept.nodes, nodes_all.nodes);
  }
}

/// 64 phyxels, and 64 more beyond the reach of all of them.
Points two_lumps(Draw& draw) {
  Points points = grid_points({4, 4, 4}, 0.1, 0.3, draw);
  for (const Vec3& p : grid_points({4, 4, 4}, 0.1, 0.3, draw))
    points.push_back(p + Vec3(0.8, 0, 0));
  return points;
}

/// Two lumps of phyxels that see nothing of each other, with one link between them: of small moves along it and across
/// it the model's energy is that of a spring of c E area / length, and more by what strains gradients.
TEST(Links, AreAsStiffAsTheMaterialAlongThem) {
  Draw draw(8);
  const Points points = two_lumps(draw);
  const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.3};
  PhyxelModel model(make_phyxels(points, 0.064, 20), rubber, {});
  Points moved = points;
  const auto energy = [&](const Vec3& step) {
    for (std::size_t i = 64; i < points.size(); ++i)
      moved[i] = points[i] + step;
    return model.energy(moved);
  };
  const Vec3 along(1e-4, 0, 0), across(0, 1e-4, 0);
  EXPECT_LT(energy(along), 1e-20);
  const Link link{{60, 64 + 12}, 0.4, 0.002};
  model.link({&link, 1}, points, model.deformed(points));
  for (const Vec3& step : {along, across}) {
    const double spring = 2 * energy(step) / step.squaredNorm(), expected = 2e4 * link.area / link.length;
    EXPECT_GT(spring, 0.25 * expected) << "gradients take up some of it";
    EXPECT_LT(spring, 2 * expected);
  }
  Points forces(points.size());
  model.force(moved, forces);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : forces)
    sum += f;
  EXPECT_LT(sum.norm(), 1e-12);
  model.link({}, points, model.deformed(points));
  EXPECT_LT(energy(along), 1e-20);
}

/// A link that finds two lumps turned, stretched and apart brings no energy, and holds them from there on.
TEST(Links, BringNoEnergy) {
  Draw draw(9);
  const Points points = two_lumps(draw);
  const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.3};
  PhyxelModel model(make_phyxels(points, 0.064, 20), rubber, {});
  const Mat3 F = draw.rotation() * Vec3(1.2, 1, 0.9).asDiagonal();
  Points x = mapped(points, F, draw.vector());
  for (std::size_t i = 64; i < x.size(); ++i)
    x[i] += F * Vec3(0.5, 0.1, 0);
  const double before = model.energy(x);
  const Link link{{60, 64 + 12}, 0.4, 0.002};
  model.link({&link, 1}, x, model.deformed(x));
  EXPECT_NEAR(model.energy(x), before, 1e-9 * before);
  for (std::size_t i = 64; i < x.size(); ++i)
    x[i] += 0.1 * F.col(0);
  const double after = model.energy(x);
  EXPECT_GT(after, before + 0.01);
  model.link({&link, 1}, x, model.deformed(x));
  EXPECT_EQ(model.energy(x), after) << "it is strained as it was";
}

/// Nor does one to a phyxel that has just lost all of its bonds, in a body that is turned.
TEST(Links, BringNoEnergyToAPhyxelAlone) {
  Draw draw(10);
  const Points points = two_lumps(draw);
  PhyxelModel model(make_phyxels(points, 0.064, 20), {.density = 1000, .youngs_modulus = 2e4, .poissons_ratio = 0.3}, {});
  const Points x = mapped(points, draw.rotation(), draw.vector());
  const Deformed before = model.deformed(x);
  std::vector<Sight> sights = clear_sights(points, points, model.neighbours().pairs);
  Link link{{60, 60}, 0.1, 0.002};
  for (std::size_t p = 0; p < sights.size(); ++p)
    for (const auto& [alone, other] : {std::pair(0, 1), std::pair(1, 0)})
      if (const Pair& pair = model.neighbours().pairs[p]; pair[alone] == 60) {
        sights[p].factor = 0;
        link.pair = {std::min(60u, pair[other]), std::max(60u, pair[other])};
      }
  ASSERT_NE(link.pair[0], link.pair[1]);
  model.update(sights);
  model.link({&link, 1}, x, before);
  EXPECT_LT(model.energy(x), 1e-12);
}

} // namespace
} // namespace kerf::pba::links_test
