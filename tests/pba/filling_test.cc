/// How bodies are filled: sampling, where points lie, volumes, supports, neighbours; bad input.

#include "base/error.h"
#include "base/parallel.h"
#include "grid/locate.h"
#include "pba/kernel.h"
#include "pba/point_grid.h"
#include "pba/region.h"
#include "tests/pba/clouds.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kerf::pba::filling_test {
namespace {

const Box unit_box{Vec3::Zero(), Vec3::Ones()};

Points sample_box(const SamplingOptions& options) {
  return sample(
    unit_box, [](const Vec3&) { return true; }, options);
}

double closest(const Points& points) {
  double least = 1e300;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, (points[i] - points[j]).norm());
  return least;
}

TEST(Sampling, HasOnePointASpacingCubed) {
  for (const char* const distribution : {"jittered grid", "Poisson disk"}) {
    const Points points = sample_box({.distribution = distribution, .spacing = 0.1});
    record(distribution, static_cast<double>(points.size()));
    EXPECT_NEAR(static_cast<double>(points.size()), 1000, 60) << distribution;
    for (const Vec3& p : points)
      EXPECT_TRUE(unit_box.contains(p));
  }
  EXPECT_EQ(sample_box({.spacing = 0.1}).size(), 1000u); // ten spacings are ten points
}

TEST(Sampling, PointsKeepTheirDistance) {
  EXPECT_GE(closest(sample_box({.distribution = "Poisson disk", .spacing = 0.12})), 0.88 * 0.12);
  EXPECT_GE(closest(sample_box({.spacing = 0.12, .jitter = 0.5})), 0.5 * 0.12);
  EXPECT_NEAR(closest(sample_box({.spacing = 0.125, .jitter = 0})), 0.125, 1e-12);
}

TEST(Sampling, DependsOnItsSeedAlone) {
  for (const char* const distribution : {"jittered grid", "Poisson disk"}) {
    const SamplingOptions one{.distribution = distribution, .spacing = 0.2, .seed = 1};
    SamplingOptions two = one;
    two.seed = 2;
    EXPECT_EQ(sample_box(one), sample_box(one));
    EXPECT_NE(sample_box(one), sample_box(two));
  }
  // The first number of std::mt19937_64 with seed 5489 is fixed by the C++ standard's algorithm.
  const Points first =
    sample({Vec3::Zero(), Vec3::Ones()}, [](const Vec3&) { return true; }, {.spacing = 1, .jitter = 1, .seed = 5489});
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0][0], static_cast<double>(14514284786278117030ull >> 11) * 0x1p-53);
}

TEST(Sampling, RefusesUnknownDistributions) {
  EXPECT_THROW(sample_box({.distribution = "blue noise"}), ParameterError);
}

TEST(PointGrid, FindsWhatBruteForceFinds) {
  Draw draw(1);
  for (const double cell : {0.05, 0.5, 5.0}) {
    const Points points = random_points(200, draw);
    const PointGrid grid(points, cell);
    for (int n = 0; n < 50; ++n) {
      const Vec3 p = 1.5 * draw.vector();
      const double radius = draw(0, 1);
      std::vector<std::uint32_t> found, expected;
      std::vector<double> distances;
      for (std::uint32_t i = 0; i < points.size(); ++i) {
        distances.push_back((points[i] - p).norm());
        if (distances.back() < radius)
          expected.push_back(i);
      }
      grid.within(p, radius, found);
      EXPECT_EQ(found, expected);
      EXPECT_EQ(grid.nearest(p), std::min_element(distances.begin(), distances.end()) - distances.begin());
      std::sort(distances.begin(), distances.end());
      distances.resize(7);
      EXPECT_EQ(grid.nearest_distances(p, 7), distances);
    }
  }
}

TEST(Neighbours, AreThoseOfBruteForce) {
  Draw draw(2);
  const Phyxels phyxels = make_phyxels(random_points(120, draw), 1, 15);
  const Neighbours found = find_neighbours(phyxels);
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < phyxels.size(); ++i)
    for (std::uint32_t j = i + 1; j < phyxels.size(); ++j)
      if ((phyxels.rest[i] - phyxels.rest[j]).norm() < 0.5 * (phyxels.support[i] + phyxels.support[j]))
        pairs.push_back({i, j});
  EXPECT_EQ(found.pairs, pairs);
  for (std::uint32_t i = 0; i < phyxels.size(); ++i)
    for (auto k = found.start[i]; k < found.start[i + 1]; ++k) {
      const auto [a, b] = found.pairs[found.pair[k]];
      EXPECT_TRUE((a == i && b == found.phyxel[k]) || (b == i && a == found.phyxel[k]));
      EXPECT_TRUE(k == found.start[i] || found.phyxel[k] > found.phyxel[k - 1]);
    }
  EXPECT_EQ(found.start.back(), 2 * pairs.size());
}

TEST(Supports, HoldTheNearestPoints) {
  Draw draw(3);
  const Points points = grid_points({6, 6, 6}, 0.1, 0.5, draw);
  const auto supports = make_supports(points, {.n_neighbours = 20});
  for (std::size_t i = 0; i < points.size(); ++i) {
    int n = -1; // itself
    for (const Vec3& p : points)
      n += (p - points[i]).norm() < supports[i];
    EXPECT_EQ(n, 20);
  }
}

TEST(Supports, RefuseWhatHoldsNoOther) {
  Draw draw(4);
  const Points points = grid_points({3, 3, 3}, 0.1, 0, draw);
  EXPECT_THROW(make_supports(points, {.support = 0.09}), ParameterError);
  EXPECT_NO_THROW(make_supports(points, {.support = 0.11}));
  EXPECT_THROW(make_supports({Vec3::Zero(), Vec3::Zero()}, {.n_neighbours = 5}), ParameterError);
}

support::Body cut_ball() {
  support::Body body = support::with_placed_skin(support::ball(0.5, 0.13, Vec3(0.2, 0.4, 0.1)));
  support::cut_through(body, support::cuts_of_plane(body, {Vec3(0.6, 0.8, 0), 0.11}));
  return body;
}

TEST(Region, CrumbsSumToTheBody) {
  const support::Body body = support::with_copies(cut_ball());
  const auto volumes = support::octant_volumes(body);
  const double expected = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  for (const double size : {1.0, 0.1, 0.05}) {
    double sum = 0;
    for (const Crumb& crumb : crumbs(body, size)) {
      EXPECT_GE(crumb.volume, 0);
      EXPECT_LE(crumb.volume, size * size * size);
      EXPECT_TRUE(copy_around(body, crumb.centre).valid());
      sum += crumb.volume;
    }
    EXPECT_NEAR(sum, expected, 1e-13);
  }
}

TEST(Region, KnowsInsideFromOutsideAndSideFromSide) {
  const support::Body body = support::with_copies(cut_ball());
  const grid::Pieces pieces = grid::pieces(body.complex);
  ASSERT_EQ(pieces.n_pieces, 2u);
  Draw draw(5);
  int n_inside = 0;
  std::uint32_t lower = 99, upper = 99;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 p = 0.7 * draw.vector();
    const auto copy = copy_around(body, p);
    const double height = Vec3(0.6, 0.8, 0).dot(p) - 0.11;
    if (std::abs(p.norm() - 0.5) < 0.03 || std::abs(height) < 1e-9)
      continue; // the skin is a polyhedron
    EXPECT_EQ(copy.valid(), p.norm() < 0.5);
    if (!copy.valid() || std::abs(p.norm() - 0.5) < 0.2) // near the skin, the cut is drawn to it
      continue;
    std::uint32_t& piece = height < 0 ? lower : upper;
    piece = piece == 99 ? pieces.piece[copy] : piece;
    EXPECT_EQ(pieces.piece[copy], piece);
    ++n_inside;
  }
  EXPECT_NE(lower, upper);
  EXPECT_GT(n_inside, 20);
}

TEST(Phyxels, VolumesSumToTheBodys) {
  const support::Body body = support::with_copies(cut_ball());
  const auto volumes = support::octant_volumes(body);
  const double expected = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  for (const char* const distribution : {"jittered grid", "Poisson disk"})
    for (const double spacing : {0.2, 0.1}) {
      const Phyxels phyxels = fill(body, {.sampling = {.distribution = distribution, .spacing = spacing}});
      EXPECT_NEAR(std::accumulate(phyxels.volume.begin(), phyxels.volume.end(), 0.0), expected, 1e-13);
      for (const double volume : phyxels.volume)
        EXPECT_GT(volume, 0.05 * spacing * spacing * spacing);
      const material::Elastic material{.density = 700};
      const PhyxelModel model(phyxels, material, {});
      double mass = 0;
      for (const double m : model.lumped_mass())
        mass += m;
      EXPECT_NEAR(mass, 700 * expected, 1e-10);
    }
}

/// A lattice in a block of cubes: each phyxel stands for its own cube.
TEST(Phyxels, HaveTheirVoronoiVolumes) {
  const support::Body body = support::with_copies(support::with_placed_skin(support::block({4, 3, 3}, 0.1)));
  const Phyxels phyxels = fill(body, {.sampling = {.spacing = 0.1, .jitter = 0}, .n_neighbours = 10});
  EXPECT_EQ(phyxels.size(), 36u);
  for (const double volume : phyxels.volume)
    EXPECT_NEAR(volume, 1e-3, 1e-14);
}

TEST(Phyxels, AreTheSameOnOneAndTwoThreads) {
  const support::Body body = support::with_copies(cut_ball());
  Phyxels phyxels[2];
  const int n = n_threads();
  for (const int threads : {1, 2}) {
    set_n_threads(threads);
    phyxels[threads - 1] = fill(body, {.sampling = {.spacing = 0.1}});
  }
  set_n_threads(n);
  EXPECT_EQ(phyxels[0].rest, phyxels[1].rest);
  EXPECT_EQ(phyxels[0].volume, phyxels[1].volume);
  EXPECT_EQ(phyxels[0].support, phyxels[1].support);
}

TEST(Phyxels, FewerThanFourAreRefused) {
  const support::Body body = support::with_copies(cut_ball());
  try {
    fill(body, {.sampling = {.spacing = 2, .jitter = 0}});
    FAIL() << "no error";
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("at least 4 phyxels"), std::string::npos) << error.what();
  }
  try {
    fill(body, {.sampling = {.spacing = 0.1}, .support = 0.02});
    FAIL() << "no error";
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("within its support"), std::string::npos) << error.what();
  }
}

TEST(Phyxels, OptionsSayWhatTheyTake) {
  PhyxelOptions options;
  Parameters parameters;
  options.describe(parameters);
  for (const auto& [name, bad] : std::vector<std::pair<std::string, std::string>>{{"Distribution", "random"},
                                                                                  {"Spacing [m]", "-1"},
                                                                                  {"Jitter [1]", "1.1"},
                                                                                  {"Neighbours [1]", "2"},
                                                                                  {"Support [m]", "-1"}}) {
    const auto it = std::find_if(parameters.list().begin(), parameters.list().end(),
                                 [&](const Parameter& parameter) { return parameter.name == name; });
    ASSERT_NE(it, parameters.list().end()) << name;
    EXPECT_NE(it->check(bad), "") << name;
    EXPECT_EQ(it->check(it->fallback), "") << name;
  }
}

} // namespace
} // namespace kerf::pba::filling_test
