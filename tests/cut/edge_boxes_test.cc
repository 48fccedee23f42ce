/// Boxes around edges: none is missed, and what is found among them is what a look at every edge finds, bit by bit.

#include "cut/edge_boxes.h"

#include "base/error.h"
#include "base/parallel.h"
#include "cut/cut_surface.h"
#include "cut/recut.h"
#include "geometry/box_tree.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <iostream>
#include <limits>
#include <numbers>

namespace kerf::cut::edge_boxes_test {
namespace {

using grid::EdgeId;
using support::Body;
using support::Random;
using support::random_direction;
using support::random_vector;
using support::uniform;

/// A body somewhere, that was somewhere else before.
struct Placed {
  Body body;
  Points x = grid::rest_positions(body), x_before = x;
  EdgeBoxes boxes{body};

  Placed(Body whole) : body(support::with_copies(std::move(whole))) {}

  void cut(const std::vector<grid::EdgeCut>& cuts) {
    std::vector<EdgeId> edges;
    for (const auto& cut : cuts) {
      body.cuts.add(body.grid, cut);
      edges.push_back(cut.edge);
    }
    const auto change = grid::update_complex(body, edges);
    grid::inherit(change, x);
    grid::inherit(change, x_before);
  }
};

Placed small_sphere() { return {support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.15, {0.3, 0.1, 0.8})}; }
Placed small_liver() { return {support::embedded(support::liver_mesh(), 0.012, {0.5, 0.5, 0.5})}; }

void scramble(Points& x, Random& random, const double size) {
  for (Vec3& p : x)
    p += size * random_vector(random);
}

/// Each edge between material nodes and each cell belongs to one block; its box holds the ends, before and now.
TEST(EdgeBoxes, HoldEveryEdgeOnce) {
  Random random(61);
  for (int i = 0; i < 30; ++i) {
    auto nodes = support::some_nodes(random, {1 + i % 7, 1 + i % 11, 1 + i % 5}, i % 3 ? 0.6 : 2);
    nodes.push_back({1, 1, 1});
    Placed placed{support::make_body({}, nodes, support::midway)};
    placed.cut(support::random_cuts(random, placed.body, 0.2));
    scramble(placed.x, random, 2);
    if (i % 2)
      placed.x_before = placed.x;
    placed.boxes.fit(placed.x_before, placed.x);
    EXPECT_EQ(placed.boxes.moves(), i % 2 == 0);
    const grid::Grid& grid = placed.body.grid;
    std::vector<int> n_seen(grid.n_edges(), 0), n_cells(grid.n_cells(), 0);
    for (std::uint32_t block = 0; block < placed.boxes.n_blocks(); ++block) {
      placed.boxes.for_each_cell(block, [&](const grid::CellId c) { ++n_cells[c.value]; });
      placed.boxes.for_each_edge(block, [&](const grid::CornerId lower, const grid::CornerId upper, const int axis) {
        const EdgeId e = grid.edge(placed.body.complex.node[lower], axis);
        ++n_seen[e.value];
        ASSERT_EQ(placed.body.complex.real_corner[grid.ends(e)[0]], lower);
        ASSERT_EQ(placed.body.complex.real_corner[grid.ends(e)[1]], upper);
        const double length = (placed.x[upper.value] - placed.x[lower.value]).norm();
        const auto found = placed.boxes.blocks([&](const EdgeBoxes::Block& b) {
          return b.box.contains(placed.x[lower.value]) && b.box.contains(placed.x[upper.value]) &&
                 b.box.contains(placed.x_before[lower.value]) && b.longest >= length * (1 - 1e-15);
        });
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), block));
      });
    }
    EXPECT_EQ(std::count(n_cells.begin(), n_cells.end(), 1), static_cast<std::ptrdiff_t>(grid.n_cells()));
    for (const auto e : ids<EdgeId>(grid.n_edges()))
      ASSERT_EQ(n_seen[e.value], support::is_inner(placed.body, e) ? 1 : 0);
  }
}

/// Around a body in pieces, made before it was cut or after: no larger than the ends of the edges ask for.
TEST(EdgeBoxes, FitTightly) {
  Random random(65);
  for (int i = 0; i < 10; ++i) {
    Placed placed{support::block({6 + i, 5, 9})};
    placed.cut(support::random_cuts(random, placed.body, 0.3));
    if (i % 2)
      placed.boxes = EdgeBoxes(placed.body);
    scramble(placed.x, random, 2);
    placed.boxes.fit(placed.x_before, placed.x);
    for (std::uint32_t block = 0; block < placed.boxes.n_blocks(); ++block) {
      Points ends;
      double longest = 0;
      placed.boxes.for_each_edge(block, [&](const grid::CornerId lower, const grid::CornerId upper, int) {
        for (const Points* x : {&placed.x, &placed.x_before})
          ends.insert(ends.end(), {(*x)[lower.value], (*x)[upper.value]});
        longest = std::max(longest, (placed.x[upper.value] - placed.x[lower.value]).norm());
      });
      if (ends.empty()) // but for nodes at the body's upper end
        continue;
      const Box tight = geometry::box_around(ends);
      EXPECT_EQ(placed.boxes.block(block).box.lower, tight.lower);
      EXPECT_EQ(placed.boxes.block(block).box.upper, tight.upper);
      EXPECT_NEAR(placed.boxes.block(block).longest, longest, 1e-14);
    }
  }
}

/// Moved on from where they were fitted last, boxes are those that are fitted to both places: of a body that moves,
/// rests, is cut and moves again.
TEST(EdgeBoxes, MovedOnAreThoseFittedAnew) {
  Random random(66);
  Placed placed{support::block({9, 5, 9})};
  EdgeBoxes& moved = placed.boxes;
  EdgeBoxes anew = moved;
  moved.fit(placed.x_before, placed.x);
  for (int step = 0; step < 30; ++step) {
    placed.x_before = placed.x;
    if (step % 4 < 2)
      scramble(placed.x, random, 0.5);
    moved.move_on(placed.x_before, placed.x);
    anew.fit(placed.x_before, placed.x);
    ASSERT_EQ(moved.moves(), anew.moves());
    for (std::uint32_t block = 0; block < moved.n_blocks(); ++block) {
      ASSERT_EQ(moved.block(block).box.lower, anew.block(block).box.lower) << step;
      ASSERT_EQ(moved.block(block).box.upper, anew.block(block).box.upper);
      ASSERT_EQ(moved.block(block).longest, anew.block(block).longest);
    }
    ASSERT_EQ(moved.longest(), anew.longest());
    const auto all = [](const EdgeBoxes& boxes) {
      std::vector<Vec3> corners;
      boxes.blocks([&](const EdgeBoxes::Block& b) {
        corners.insert(corners.end(), {b.box.lower, b.box.upper});
        return true;
      });
      return corners;
    };
    ASSERT_EQ(all(moved), all(anew));
    if (step % 8 == 5)
      placed.cut(support::random_cuts(random, placed.body, 0.05));
  }
  placed.x[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(moved.move_on(placed.x_before, placed.x), NumericalError);
}

void expect_same(const SweepCuts& a, const SweepCuts& b) {
  ASSERT_EQ(a.cuts.size(), b.cuts.size());
  ASSERT_EQ(a.n_double_crossings, b.n_double_crossings);
  for (std::size_t i = 0; i < a.cuts.size(); ++i) {
    ASSERT_EQ(a.cuts[i].edge, b.cuts[i].edge);
    ASSERT_EQ(a.cuts[i].t, b.cuts[i].t);
    ASSERT_EQ(a.cuts[i].normal, b.cuts[i].normal);
  }
}

BladePath random_path(Random& random, const Placed& placed) {
  Box box = geometry::box_around(placed.x);
  const double size = (box.upper - box.lower).norm();
  const Vec3 middle = 0.5 * (box.lower + box.upper), along = random_direction(random), way = random_direction(random);
  BladePath path;
  const int n_points = 2 + static_cast<int>(random() % 3), n_places = 2 + static_cast<int>(random() % 3);
  const double length = size * uniform(random, 0.02, 1), step = size * uniform(random, 0, 0.3);
  const Vec3 start = middle + 0.3 * size * random_vector(random);
  for (int k = 0; k < n_places; ++k) {
    path.fractions.push_back(static_cast<double>(k) / (n_places - 1));
    Points line;
    for (int i = 0; i < n_points; ++i)
      line.push_back(start + length * i / (n_points - 1) * along + step * k * way +
                     0.01 * step * random_vector(random));
    path.lines.push_back(line);
  }
  return path;
}

/// Blades that rest and move, against bodies that rest, move rigidly, are scrambled, and were cut before.
TEST(EdgeBoxes, FindWhatALookAtEveryEdgeFinds) {
  Random random(62);
  std::size_t n_cut = 0, n_still = 0;
  for (Placed placed : {small_sphere(), small_liver()}) {
    placed.cut(support::random_cuts(random, placed.body, 0.02));
    const double h = placed.body.grid.h();
    for (int i = 0; i < 300; ++i) {
      placed.x_before = placed.x = grid::rest_positions(placed.body);
      if (i % 4 == 1) {
        const Eigen::AngleAxisd turn(uniform(random, 0, 0.2), random_direction(random));
        const Vec3 shift = uniform(random, 0, 3) * h * random_direction(random);
        for (Vec3& p : placed.x)
          p = turn * p + shift;
      } else if (i % 4 == 2)
        scramble(placed.x, random, uniform(random, 0, 0.3) * h);
      else if (i % 4 == 3)
        for (Vec3& p : placed.x) // a part of the body rests
          p[2] += std::max(0.0, p[0]) * 0.1;
      const BladePath path = random_path(random, placed);
      placed.boxes.fit(placed.x_before, placed.x);
      const auto find = [&](const EdgeBoxes* boxes) {
        return cut_edges(path, placed.body, placed.x_before, placed.x, 1, boxes);
      };
      const SweepCuts found = find(&placed.boxes);
      expect_same(found, find(nullptr));
      ASSERT_FALSE(HasFatalFailure()) << "path " << i;
      n_cut += found.cuts.size();
      n_still += i % 4 == 0 ? found.cuts.size() : 0;
    }
  }
  EXPECT_GT(n_still, 500u);
  EXPECT_GT(n_cut, 3 * n_still / 2);
}

TEST(EdgeBoxes, FindWhatShapesCut) {
  Random random(63);
  std::size_t n_cut = 0;
  for (Placed placed : {small_sphere(), small_liver()})
    for (int i = 0; i < 200; ++i) {
      const Box box = geometry::box_around(placed.x);
      const double size = (box.upper - box.lower).norm();
      const Vec3 centre = 0.5 * (box.lower + box.upper) + 0.2 * size * random_vector(random);
      const Vec3 direction = i % 3 ? random_direction(random) : Vec3(Vec3::Unit(i % 9 / 3));
      const double r = size * uniform(random, 0.01, 0.6);
      const Vec3 side = r * direction.unitOrthogonal();
      const std::array<Shape, 6> shapes = {Plane{centre, direction},
                                           Sphere{centre, r},
                                           Cylinder{centre, direction, r, r},
                                           Disc{centre, direction, r},
                                           Rectangle{centre, side, 2 * direction.cross(side)},
                                           geometry::sphere_mesh(r, centre, 2)};
      const CutSurface surface{"", shapes[i % 6], 1};
      placed.boxes.fit(placed.x);
      const auto find = [&](const EdgeBoxes* boxes) { return cut_edges(surface, placed.body, placed.x, boxes); };
      expect_same(find(&placed.boxes), find(nullptr));
      ASSERT_FALSE(HasFatalFailure()) << "shape " << i;
      n_cut += find(&placed.boxes).cuts.size();
    }
  EXPECT_GT(n_cut, 10000u);
}

/// The same sweep in ever larger blocks: no more blocks of edges are looked at.
TEST(EdgeBoxes, KeepTheSearchToTheCut) {
  std::vector<std::size_t> n_near;
  for (const int n : {12, 24, 48}) {
    Placed placed{support::block({n, n, n})};
    placed.boxes.fit(placed.x);
    const double top = n + 0.5;
    const Box sweep{{4.3, 1, top - 6}, {4.3, 7, top}};
    n_near.push_back(placed.boxes.blocks([&](const auto& b) { return geometry::overlap(b.box, sweep); }).size());
    EXPECT_GT(placed.boxes.n_blocks(), n_near.back());
  }
  EXPECT_GT(n_near.front(), 1u);
  EXPECT_LE(n_near[1], 2 * n_near[0]); // bricks stand elsewhere against the top
  EXPECT_LE(n_near[2], 2 * n_near[0]);
}

TEST(EdgeBoxes, AreTheSameOnOneAndTwoThreads) {
  const int before = n_threads();
  Random random(64);
  Placed placed = small_liver();
  scramble(placed.x, random, 0.1 * placed.body.grid.h());
  const BladePath path = random_path(random, placed);
  std::vector<SweepCuts> found;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    placed.boxes.fit(placed.x_before, placed.x);
    found.push_back(cut_edges(path, placed.body, placed.x_before, placed.x, 1, &placed.boxes));
  }
  set_n_threads(before);
  expect_same(found[0], found[1]);
}

TEST(EdgeBoxes, RefuseCornersThatAreNotFinite) {
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Placed placed{support::block({20, 20, 20})};
    placed.x[5000][2] = wrong;
    try {
      placed.boxes.fit(placed.x);
      FAIL() << "accepted " << wrong;
    } catch (const NumericalError& error) {
      EXPECT_NE(std::string(error.what()).find("corner 5000 "), std::string::npos) << error.what();
    }
  }
}

} // namespace
} // namespace kerf::cut::edge_boxes_test
