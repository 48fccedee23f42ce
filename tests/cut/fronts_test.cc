#include "cut/fronts.h"

#include "grid/fronts.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace kerf::cut {
namespace {

using support::Body;

Body block() { return support::with_copies(support::with_placed_skin(support::block({9, 9, 9}))); }

/// The body cut by the surfaces one after the other, by a cutter of these fronts.
struct Cutting {
  explicit Cutting(Body whole, const Fronts fronts) : body(std::move(whole)), cutter(9, Release::queued, fronts) {
    cutter.begin(body, grid::rest_positions(body));
    surface = surface::build_surface(body, index);
  }
  void cut(const Shape& shape) {
    const grid::CutChange change = cutter.at_once(body, {"cut", shape, 1}, grid::rest_positions(body));
    surface::place(body, change, {});
    surface::update_surface(body, change, surface, index);
  }

  Body body;
  Cutter cutter;
  surface::SurfaceIndex index;
  surface::Surface surface;
};

Shape random_shape(support::Random& random, const Vec3& middle, const double size) {
  const Vec3 centre = middle + 0.4 * size * support::random_vector(random), n = support::random_direction(random);
  const double radius = size * support::uniform(random, 0.1, 0.7);
  if (random() % 2 == 0)
    return Disc{centre, n, radius};
  const Vec3 side = n.unitOrthogonal();
  return Rectangle{centre, 2 * radius * side, size * support::uniform(random, 0.2, 1.4) * n.cross(side)};
}

bool is_closed(const surface::Surface& s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : s.triangles)
    for (int i = 0; i < 3; ++i) {
      const auto a = t[i], b = t[(i + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// A straight front, along a layer of cells and off its nodes: the one cell along it is passed as far as the front has
/// come, with its lag.
TEST(Fronts, ArePassedAsFarAsTheCutHasCome) {
  for (double x = 4; x < 6; x += 0.13) {
    Cutting cutting(block(), Fronts::inside_cells);
    cutting.cut(Rectangle{Vec3(0.5 * x, 5, 5.4), Vec3(x, 0, 0), Vec3(0, 20, 0)});
    const double end = x + grid::front_lag;
    int n = 0;
    for (const grid::Front& front : cutting.body.cuts.fronts()) {
      const double lower = cutting.body.grid.origin(front.cell)[0];
      ASSERT_NEAR(front.passed, std::clamp(end - lower, 0.0, 0.98), 1e-9) << x;
      EXPECT_NEAR(front.area, 1, 1e-9);
      EXPECT_NEAR(std::abs(front.normal[2]), 1, 1e-9);
      n += front.passed < 0.98;
    }
    EXPECT_EQ(n, end - std::floor(end) < 0.02 ? 0 : 10) << x;
    std::size_t n_ties = 0;
    for (const auto& [a, b, length] : grid::ties(cutting.body)) {
      EXPECT_NE(a, b);
      EXPECT_EQ(cutting.body.complex.node[a], cutting.body.complex.node[b]);
      EXPECT_GT(length, 0);
      ++n_ties;
    }
    EXPECT_GE(n_ties, 4 * std::size_t(n));
  }
}

/// Cuts of any place and size, some of which end near the skin, in bodies with much of it.
TEST(Fronts, LeaveThePiecesMassAndSurfaceAsTheyWere) {
  support::Random random(31);
  std::size_t n_fronts = 0;
  for (int i = 0; i < 60; ++i) {
    const Body whole = i % 3 == 0 ? block()
                                  : support::with_copies(support::with_placed_skin(
                                      support::ball(3 + 0.05 * i, 1, support::random_offset(random))));
    const Vec3 middle = i % 3 == 0 ? Vec3(5, 5, 5) : Vec3(0, 0, 0);
    Cutting with(whole, Fronts::inside_cells), without(whole, Fronts::at_faces);
    for (int k = 0; k < 3; ++k) {
      const Shape shape = random_shape(random, middle, 5);
      with.cut(shape);
      without.cut(shape);
      ASSERT_EQ(grid::n_pieces(with.body.complex), grid::n_pieces(without.body.complex)) << i << " " << k;
      const double volume = sum(support::octant_volumes(with.body));
      EXPECT_NEAR(volume, sum(support::octant_volumes(without.body)), 1e-9) << i << " " << k;
      EXPECT_NEAR(volume, surface::enclosed_volume(with.surface.rest, with.surface.triangles), 1e-9) << i << " " << k;
      EXPECT_TRUE(is_closed(with.surface)) << i << " " << k;
    }
    n_fronts += with.body.cuts.fronts().size();
    Body anew = with.body;
    anew.complex = grid::build_complex(anew);
    const auto names = support::renaming(with.body.complex, anew.complex);
    ASSERT_TRUE(names) << i;
    EXPECT_TRUE(support::is_same(with.surface, surface::build_surface(anew), *names)) << i;
  }
  EXPECT_GT(n_fronts, 500u);
}

/// A disc that grows: cells are passed as by the last disc at once, and what it has come through is tied no more.
TEST(Fronts, MoveOnAsTheCutGrows) {
  Cutting growing(block(), Fronts::inside_cells), at_once(block(), Fronts::inside_cells);
  const Vec3 normal = Vec3(0.2, 0.1, 1).normalized();
  for (const double radius : {2.0, 2.15, 2.3, 2.45, 2.6, 2.75, 2.9})
    growing.cut(Disc{Vec3(5.1, 4.9, 5.2), normal, radius});
  at_once.cut(Disc{Vec3(5.1, 4.9, 5.2), normal, 2.9});
  EXPECT_EQ(growing.body.complex.n_copies(), at_once.body.complex.n_copies());
  int n = 0;
  for (const grid::Front& front : at_once.body.cuts.fronts()) {
    const grid::Front* const grown = growing.body.cuts.front(front.cell);
    ASSERT_NE(grown, nullptr);
    EXPECT_NEAR(grown->passed, front.passed, 1e-9);
    n += front.passed < 1;
  }
  EXPECT_GT(n, 20);
  EXPECT_EQ(grid::ties(growing.body).size(), grid::ties(at_once.body).size());
}

} // namespace
} // namespace kerf::cut
