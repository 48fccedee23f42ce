#include "pba/corners.h"

#include "base/parallel.h"
#include "grid/locate.h"
#include "pba/point_grid.h"
#include "tests/pba/clouds.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

namespace kerf::pba::corners_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};
const support::Plane plane{Vec3(0.6, 0.8, 0), 0.03};

struct Scene {
  support::Body body;
  Phyxels phyxels;
  NodePairs pairs;
  std::vector<Sight> sights;
  std::vector<grid::CopyId> copies;

  CornerMap map() const { return build_corner_map(body, phyxels, copies, pairs, sights); }
  std::vector<std::uint32_t> pieces() const { return phyxel_pieces(body.complex, copies); }
};

Scene make_scene(const std::vector<grid::EdgeCut>& cuts, const support::Body& whole, const double spacing) {
  Scene scene{whole, {}, {}, {}, {}};
  scene.phyxels = fill(support::with_copies(whole), {.sampling = {.spacing = spacing}, .n_neighbours = 20});
  support::cut(scene.body, cuts);
  scene.body.complex = grid::build_complex(scene.body);
  scene.pairs = find_node_pairs(scene.body.grid, scene.phyxels);
  scene.sights = clear_sights(scene.pairs.rest, scene.phyxels.rest, scene.pairs.pairs);
  scene.copies = copies_around(scene.body, scene.phyxels.rest);
  return scene;
}

support::Body whole_ball() { return support::with_placed_skin(support::ball(0.5, 0.13, Vec3(0.2, 0.4, 0.1))); }

Scene halved_ball() {
  const support::Body ball = whole_ball();
  Scene scene = make_scene(support::plane_cuts(ball, plane), ball, 0.14);
  part(scene.pairs.pairs, node_pieces(scene.body.complex, scene.pairs), scene.pieces(), scene.sights);
  return scene;
}

Points followed(const CornerMap& map, const Points& x, const std::vector<Mat3>& F) {
  Points corners;
  follow(map, x, F, corners);
  return corners;
}

TEST(Corners, ReproduceLinearFieldsRealAndVirtual) {
  Draw draw(1);
  for (const bool cut : {false, true}) {
    const support::Body ball = whole_ball();
    const Scene scene = cut ? halved_ball() : make_scene({}, ball, 0.14);
    const CornerMap map = scene.map();
    const PhyxelModel model(scene.phyxels, rubber, {});
    const Mat3 G = draw.matrix();
    const Vec3 shift = draw.vector();
    const Points x = mapped(scene.phyxels.rest, G, shift);
    std::vector<Mat3> F;
    model.deformation(x, F);
    const Points corners = followed(map, x, F), rest = grid::rest_positions(scene.body);
    ASSERT_EQ(corners.size(), rest.size());
    ASSERT_GT(corners.size(), scene.pairs.nodes.size()); // some are virtual
    for (std::size_t c = 0; c < corners.size(); ++c)
      EXPECT_LT((corners[c] - G * rest[c] - shift).norm(), 1e-10);
  }
}

/// Each half moves by its own phyxels: real corners and virtual ones.
TEST(Corners, FollowTheirOwnPiece) {
  const Scene scene = halved_ball();
  const grid::Pieces all = grid::pieces(scene.body.complex);
  ASSERT_EQ(all.n_pieces, 2u);
  const CornerMap map = scene.map();
  EXPECT_EQ(map.n_orphans, 0u);
  const auto pieces = scene.pieces();
  Points x = scene.phyxels.rest;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (pieces[i] == 1)
      x[i] += Vec3(0, 0, 10);
  const std::vector<Mat3> F(x.size(), Mat3::Identity());
  const Points corners = followed(map, x, F), rest = grid::rest_positions(scene.body);
  std::size_t n[2] = {0, 0};
  for (const auto c : ids<grid::CopyId>(scene.body.complex.n_copies()))
    for (const auto corner : scene.body.complex.copies[c].corners) {
      const auto piece = all.piece[c];
      EXPECT_LT((corners[corner.value] - rest[corner.value] - Vec3(0, 0, 10.0 * piece)).norm(), 1e-12);
      ++n[piece];
    }
  EXPECT_GT(n[0], 100u);
  EXPECT_GT(n[1], 100u);
}

/// (2.33), written out for one node.
TEST(Corners, TakeTheWeightedMeanOfWhatTheySee) {
  Draw draw(2);
  const support::Body ball = whole_ball();
  Scene scene = make_scene({}, ball, 0.14);
  for (Sight& sight : scene.sights)
    sight.factor = std::max(0.0, draw(-0.3, 1));
  const CornerMap map = scene.map();
  const Points x = disturbed(scene.phyxels.rest, 0.05, draw);
  std::vector<Mat3> F;
  for (std::size_t i = 0; i < x.size(); ++i)
    F.push_back(Mat3::Identity() + 0.3 * draw.matrix());
  const Points corners = followed(map, x, F);
  int n_checked = 0;
  for (std::uint32_t row = 0; row < scene.pairs.nodes.size(); ++row) {
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (std::size_t p = 0; p < scene.pairs.pairs.size(); ++p) {
      const auto [r, i] = scene.pairs.pairs[p];
      if (r != row)
        continue;
      const double q = scene.sights[p].distance / scene.phyxels.support[i];
      const double w = scene.sights[p].factor * std::pow(1 - q * q, 3);
      sum += w * (x[i] + F[i] * (scene.pairs.rest[row] - scene.phyxels.rest[i]));
      weights += w;
    }
    if (weights == 0)
      continue;
    const auto corner = scene.body.complex.real_corner[scene.pairs.nodes[row]];
    EXPECT_LT((corners[corner.value] - sum / weights).norm(), 1e-12);
    ++n_checked;
  }
  EXPECT_GT(n_checked, 100);
}

/// §2.4.4: F(b) = F(a) + J(a) (b - a), from the real corner at the other end of the edge.
TEST(Corners, VirtualOnesAreExtrapolated) {
  Draw draw(3);
  const Scene scene = halved_ball();
  const CornerMap map = scene.map();
  const Points x = disturbed(scene.phyxels.rest, 0.05, draw);
  std::vector<Mat3> F;
  for (std::size_t i = 0; i < x.size(); ++i)
    F.push_back(Mat3::Identity() + 0.3 * draw.matrix());
  const Points corners = followed(map, x, F);
  int n_checked = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (map.source_start[c + 1] - map.source_start[c] != 1)
      continue;
    const auto row = map.source[map.source_start[c]];
    const auto real = scene.body.complex.real_corner[scene.pairs.nodes[row]].value;
    Mat3 J = Mat3::Zero();
    for (auto k = map.rows.start[row]; k < map.rows.start[row + 1]; ++k)
      J += map.rows.values[k] * F[map.rows.columns[k]];
    const Vec3 expected = corners[real] + J * (map.corners[c] - map.corners[real]);
    EXPECT_LT((corners[c] - expected).norm(), 1e-12);
    n_checked += c != real;
  }
  EXPECT_GT(n_checked, 50);
}

TEST(Corners, ThatSeeNothingTakeWhatTheyCanReach) {
  Scene scene = halved_ball();
  const auto pieces = scene.pieces(), nodes = node_pieces(scene.body.complex, scene.pairs);
  for (std::size_t p = 0; p < scene.sights.size(); ++p)
    if (scene.pairs.pairs[p][0] % 3 == 0)
      scene.sights[p].factor = 0;
  const CornerMap map = scene.map();
  EXPECT_GE(map.n_blind, scene.pairs.nodes.size() / 3);
  for (std::uint32_t row = 0; row < scene.pairs.nodes.size(); ++row) {
    ASSERT_LT(map.rows.start[row], map.rows.start[row + 1]);
    for (auto k = map.rows.start[row]; k < map.rows.start[row + 1]; ++k)
      EXPECT_EQ(pieces[map.rows.columns[k]], nodes[row]);
    if (row % 3 == 0) {
      EXPECT_EQ(map.rows.start[row + 1] - map.rows.start[row], 1u);
      EXPECT_LT((scene.phyxels.rest[map.rows.columns[map.rows.start[row]]] - scene.pairs.rest[row]).norm(), 0.4);
    }
  }
}

/// Pieces of two nodes, many of them without a phyxel: each follows the one nearest to its middle, as one.
TEST(Corners, OrphansMoveAsOne) {
  const support::Body ball = whole_ball();
  std::vector<grid::EdgeCut> cuts;
  for (const auto e : ids<grid::EdgeId>(ball.grid.n_edges())) {
    const bool kept = ball.grid.axis(e) == 0 && ball.grid.index(ball.grid.ends(e)[0])[0] % 2 == 0;
    if (support::is_inner(ball, e) && !kept)
      cuts.push_back({e, 0.5, Vec3::Unit(ball.grid.axis(e)), 1});
  }
  Scene scene = make_scene(cuts, ball, 0.25);
  part(scene.pairs.pairs, node_pieces(scene.body.complex, scene.pairs), scene.pieces(), scene.sights);
  const CornerMap map = scene.map();
  EXPECT_GT(map.n_orphans, 10u);
  Draw draw(5);
  const Points x = disturbed(scene.phyxels.rest, 1, draw);
  const std::vector<Mat3> F(x.size(), Mat3::Identity());
  const Points corners = followed(map, x, F);
  const auto nodes = node_pieces(scene.body.complex, scene.pairs), own = scene.pieces();
  const auto is_orphan = [&](const std::uint32_t piece) {
    return std::find(own.begin(), own.end(), piece) == own.end();
  };
  const grid::Pieces all = grid::pieces(scene.body.complex);
  Points middle(all.n_pieces, Vec3::Zero());
  std::vector<int> n_nodes(all.n_pieces, 0);
  for (std::size_t row = 0; row < nodes.size(); ++row) {
    middle[nodes[row]] += scene.pairs.rest[row];
    ++n_nodes[nodes[row]];
  }
  EXPECT_EQ(*std::max_element(n_nodes.begin(), n_nodes.end()), 2);
  const PointGrid phyxels(scene.phyxels.rest, 0.25);
  for (const auto c : ids<grid::CopyId>(scene.body.complex.n_copies())) {
    const std::uint32_t piece = all.piece[c];
    if (!is_orphan(piece))
      continue;
    const auto carrier = phyxels.nearest(middle[piece] / n_nodes[piece]);
    for (const auto corner : scene.body.complex.copies[c].corners) {
      const Vec3 moved = corners[corner.value] - map.corners[corner.value];
      EXPECT_LT((moved - (x[carrier] - scene.phyxels.rest[carrier])).norm(), 1e-12);
    }
  }
}

TEST(Corners, AreTheSameOnOneAndTwoThreads) {
  Draw draw(6);
  const Scene scene = halved_ball();
  const CornerMap map = scene.map();
  const Points x = disturbed(scene.phyxels.rest, 0.05, draw);
  const std::vector<Mat3> F(x.size(), draw.rotation());
  Points corners[2];
  const int n = n_threads();
  for (const int threads : {1, 2}) {
    set_n_threads(threads);
    follow(map, x, F, corners[threads - 1]);
  }
  set_n_threads(n);
  EXPECT_EQ(corners[0], corners[1]);
}

} // namespace
} // namespace kerf::pba::corners_test
