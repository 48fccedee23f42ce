#include "cut/cutter.h"

#include "tests/cut/cutting.h"
#include "tests/cut/random_strokes.h"

#include <iostream>

namespace kerf::cut::archive_test {
namespace {

/// Half a stroke, an archive, and the other half: as without one.
TEST(CutterArchive, IsGoneOnFrom) {
  const Body whole = support::with_copies(support::with_placed_skin(support::ball(4, 1, Vec3(0.2, 0.7, 0.4))));
  const Points x = grid::rest_positions(whole);
  const Blade blade{"blade", {Vec3(0, -20, 0), Vec3(0, 20, 0)}, {{0, Vec3(-6, 0, 0.37)}, {1, Vec3(6, 0, 0.37)}}};
  Body body = whole, again = whole;
  Cutter cutter(1, Release::queued, Fronts::of_elements), resumed(1, Release::queued, Fronts::of_elements);
  cutter.begin(body, x);
  resumed.begin(again, x);
  const auto step = [&](Cutter& by, Body& of, const int k) {
    surface::place(of, by.step(of, std::span(&blade, 1), k / 40.0, (k + 1) / 40.0, grid::rest_positions(of)), {});
  };
  for (int k = 0; k < 20; ++k)
    step(cutter, body, k);
  Archive archive;
  archive(body, cutter);
  Archive back(archive.bytes(), "a test");
  back(again, resumed);
  for (int k = 20; k < 30; ++k) {
    step(cutter, body, k);
    step(resumed, again, k);
  }
  ASSERT_GT(body.complex.tied.size(), 5u);
  EXPECT_EQ(body.complex.tied, again.complex.tied);
  ASSERT_EQ(body.cuts.fronts().size(), again.cuts.fronts().size());
  for (std::size_t i = 0; i < body.cuts.fronts().size(); ++i) {
    const grid::Front &one = body.cuts.fronts()[i], &other = again.cuts.fronts()[i];
    EXPECT_EQ(one.cell, other.cell);
    EXPECT_EQ(one.passed, other.passed);
    EXPECT_EQ(one.reached, other.reached);
    EXPECT_EQ(one.held, other.held);
  }
}

/// After every step, where blades turn and cross what others have cut, while the body swings: the same bytes.
TEST(CutterArchive, IsGoneOnFromAfterEveryStep) {
  support::Random random(43);
  const auto bytes = [](Cutter& of, Body& its) {
    Archive archive;
    archive(its, of);
    return archive.bytes();
  };
  int n_joined = 0, n_fronts = 0;
  for (int i = 0; i < 40; ++i) {
    const Body whole = i % 2 == 0 ? block()
                                  : support::with_copies(support::with_placed_skin(
                                      support::ball(3.6, 1, support::random_offset(random))));
    const Vec3 middle = i % 2 == 0 ? Vec3(5, 5, 5) : Vec3(0, 0, 0);
    std::vector<Blade> blades;
    for (int k = 0; k < 3; ++k) {
      blades.push_back(random_stroke(random, 4.5));
      blades.back().label = static_cast<grid::CutLabel>(k + 1);
      for (KeyFrame& key : blades.back().key_frames)
        key.position += middle;
    }
    const double speed = support::uniform(random, 0.02, 0.1), height = support::uniform(random, 0, 0.4);
    const auto cut = [&](Cutter& by, Body& of, const double t) {
      const Points x = swung(of, height, t);
      grid::CutChange change = by.step(of, blades, t, t + speed, x);
      surface::place(of, change, {});
      return change.lapsed.size();
    };
    Body body = whole, again = whole;
    Cutter cutter(3, Release::queued, Fronts::of_elements), resumed = cutter;
    cutter.begin(body, swung(body, height, 0));
    resumed.begin(again, swung(again, height, 0));
    for (double t = 0; t < 1; t += speed) {
      Archive back(bytes(resumed, again), "a test");
      again = whole;
      resumed = Cutter(3, Release::queued, Fronts::of_elements);
      resumed.begin(again, grid::rest_positions(again));
      back(again, resumed);
      n_joined += static_cast<int>(cut(cutter, body, t));
      cut(resumed, again, t);
      ASSERT_TRUE(bytes(cutter, body) == bytes(resumed, again)) << i << " " << t;
    }
    n_fronts += static_cast<int>(body.cuts.fronts().size());
  }
  EXPECT_GT(n_joined, 100);
  EXPECT_GT(n_fronts, 100);
  std::cout << n_joined << " corners joined, " << n_fronts << " fronts\n";
}

} // namespace
} // namespace kerf::cut::archive_test
