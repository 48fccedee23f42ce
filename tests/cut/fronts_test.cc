#include "cut/fronts.h"

#include "cut/cell_at_plane.h"
#include "grid/fronts.h"
#include "tests/cut/cutting.h"
#include "tests/support/cap.h"

#include <gtest/gtest.h>

#include <iostream>

namespace kerf::cut::fronts_test {
namespace {

Shape random_shape(support::Random& random, const Vec3& middle, const double size) {
  const Vec3 centre = middle + 0.4 * size * support::random_vector(random), n = support::random_direction(random);
  const double radius = size * support::uniform(random, 0.1, 0.7);
  if (random() % 2 == 0)
    return Disc{centre, n, radius};
  const Vec3 side = n.unitOrthogonal();
  return Rectangle{centre, 2 * radius * side, size * support::uniform(random, 0.2, 1.4) * n.cross(side)};
}

/// A straight front, along a layer of cells and off its nodes: the one cell along it is passed as far as the front has
/// come, with its lag.
TEST(Fronts, ArePassedAsFarAsTheCutHasCome) {
  for (double x = 4.01; x < 6; x += 0.13) {
    Cutting cutting(block(), Fronts::of_elements);
    cutting.cut(Rectangle{Vec3(0.5 * x, 5, 5.4), Vec3(x, 0, 0), Vec3(0, 20, 0)});
    const double end = x + grid::front_lag(Vec3::UnitX());
    int n = 0;
    for (const grid::Front& front : cutting.body.cuts.fronts()) {
      const double lower = cutting.body.grid.origin(front.cell)[0];
      ASSERT_NEAR(front.passed, std::clamp(end - lower, 0.0, most_passed), 1e-9) << x;
      EXPECT_NEAR(std::abs(front.normal[2]), 1, 1e-9);
      n += front.passed < most_passed;
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

/// Right midway through a box, where points of its skin lie in the plane to round-off, cells in a row are parted alike:
/// along the front all the copies have corners of their own, behind as well as in a cell that is passed but not cut.
TEST(Fronts, LieMidwayThroughABox) {
  for (const double size : {0.1, 0.37, 1.0}) {
    const auto n_corners = [&](const double end) {
      const auto mesh = geometry::box_mesh(Vec3::Zero(), size * Vec3(12, 2, 10));
      const Body bar = support::with_copies(support::embedded(mesh, size, Vec3::Constant(0.5)));
      Cutting cutting(bar, Fronts::of_elements);
      cutting.cut(Rectangle{size * Vec3(0, 1, 5), size * Vec3(2 * end, 0, 0), size * Vec3(0, 6, 0)});
      expect_as_built(cutting);
      return cutting.body.complex.n_corners();
    };
    const auto before = n_corners(5.2);
    for (const double end : {5.3, 5.4, 5.49, 5.51, 5.6, 6.0, 6.2}) // enters the next cell at 5.25, cuts at 5.5
      EXPECT_EQ(n_corners(end), before + 8) << size << ' ' << end;
  }
}

/// A rectangle that ends in cells which the skin passes through: they are passed by as much of their material as it has
/// come through, with its lag. One that ends outside, in the same cubes, parts the body, and leaves nothing tied.
TEST(Fronts, ArePassedByTheirMaterial) {
  const double lag = grid::front_lag(Vec3::UnitX());
  for (const double thickness : {0.2, 0.5, 0.8}) { // of material in the last layer of cubes
    const Body bar = support::with_copies(
      support::embedded(geometry::box_mesh(Vec3::Zero(), Vec3(5 + thickness, 3, 3)), 1, Vec3::Zero()));
    for (double ligament = 0.05; ligament < thickness; ligament += 0.11) {
      Cutting cutting(bar, Fronts::of_elements);
      const double end = 5 + thickness - ligament;
      cutting.cut(Rectangle{Vec3(0.5 * end, 1.5, 1.4), Vec3(end, 0, 0), Vec3(0, 20, 0)});
      int n = 0;
      for (const grid::Front& front : cutting.body.cuts.fronts())
        if (cutting.body.grid.origin(front.cell)[0] > 4.5) {
          EXPECT_NEAR(front.passed, std::min(most_passed, 1 - (ligament - lag) / thickness), 1e-6)
            << thickness << ' ' << ligament;
          ++n;
        }
      EXPECT_GE(n, 3);
      EXPECT_EQ(grid::n_pieces(cutting.body.complex), 1u);
    }
    for (const double beyond : {0.01, 0.3, 0.6}) {
      Cutting cutting(bar, Fronts::of_elements);
      const double end = 5 + thickness + beyond;
      cutting.cut(Rectangle{Vec3(0.5 * end, 1.5, 1.4), Vec3(end + 0.1, 0, 0), Vec3(0, 20, 0)});
      EXPECT_EQ(grid::n_pieces(cutting.body.complex), 2u) << thickness << ' ' << beyond;
      EXPECT_TRUE(grid::ties(cutting.body).empty());
    }
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
    Cutting with(whole, Fronts::of_elements), without(whole, Fronts::at_faces);
    for (int k = 0; k < 3; ++k) {
      const Shape shape = random_shape(random, middle, 5);
      with.cut(shape);
      without.cut(shape);
      SCOPED_TRACE(testing::Message() << i << " " << k);
      expect_alike(with, without);
    }
    n_fronts += with.body.cuts.fronts().size();
    expect_as_built(with);
  }
  EXPECT_GT(n_fronts, 500u);
}

/// A disc that grows: cells are passed as by the last disc at once, and what it has come through is tied no more.
TEST(Fronts, MoveOnAsTheCutGrows) {
  Cutting growing(block(), Fronts::of_elements), at_once(block(), Fronts::of_elements);
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

/// A flat mesh, however fine, is the disc that it fills.
TEST(Fronts, OfAFlatMeshAreThoseOfADisc) {
  support::Random random(5);
  std::size_t n_all = 0, n_common = 0;
  double difference = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 middle = Vec3::Constant(5) + 0.7 * support::random_vector(random), n = support::random_direction(random);
    const double radius = support::uniform(random, 1.5, 3.8);
    Cutting by_disc(block(), Fronts::of_elements), by_mesh(block(), Fronts::of_elements);
    by_disc.cut(Disc{middle, n, radius});
    by_mesh.cut(support::cap(middle, n, 0, radius, i % 2 == 0 ? 1 : 30));
    for (const grid::Front& front : by_disc.body.cuts.fronts()) {
      const grid::Front* const other = by_mesh.body.cuts.front(front.cell);
      n_common += other != nullptr;
      difference += std::abs((other ? other->passed : 0) - front.passed);
    }
    n_all += std::max(by_disc.body.cuts.fronts().size(), by_mesh.body.cuts.fronts().size());
    SCOPED_TRACE(i);
    expect_alike(by_mesh, by_disc);
    expect_as_built(by_mesh);
  }
  std::cout << n_common << " of " << n_all << ", off by " << difference / double(n_all) << " of a cell in the mean\n";
  EXPECT_GT(n_all, 1000u);
  EXPECT_GT(n_common, 0.93 * double(n_all)); // 97 %
  EXPECT_LT(difference, 0.02 * double(n_all));
}

/// Of curved meshes that end in the body: about as many as flat ones have.
TEST(Fronts, OfCurvedMeshesLeaveThePiecesMassAndSurfaceAsTheyWere) {
  support::Random random(6);
  std::size_t n_fronts = 0, n_flat = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 middle = Vec3::Constant(5) + 0.7 * support::random_vector(random), n = support::random_direction(random);
    const double radius = support::uniform(random, 3, 12), reach = support::uniform(random, 1.5, std::min(3.8, radius));
    Cutting with(block(), Fronts::of_elements), without(block(), Fronts::at_faces);
    with.cut(support::cap(middle, n, radius, reach, 20));
    without.cut(support::cap(middle, n, radius, reach, 20));
    SCOPED_TRACE(i);
    expect_alike(with, without);
    expect_as_built(with);
    Cutting flat(block(), Fronts::of_elements);
    flat.cut(support::cap(middle, n, 0, reach, 20));
    n_fronts += with.body.cuts.fronts().size();
    n_flat += flat.body.cuts.fronts().size();
  }
  std::cout << n_fronts << ", flat " << n_flat << "\n";
  EXPECT_GT(n_fronts, 0.9 * double(n_flat));
}

} // namespace
} // namespace kerf::cut::fronts_test
