#include "cut/advance.h"

#include "grid/fronts.h"
#include "grid/in_use.h"
#include "tests/cut/cutting.h"
#include "tests/cut/patient.h"
#include "tests/cut/random_strokes.h"

#include <cmath>
#include <iostream>
#include <set>

namespace kerf::cut::advance_test {
namespace {

/// In the plane z = 5.4, from x = -2 on, its edge along y, by 1 a second.
Blade along_x(const double y0 = -20, const double y1 = 20) {
  return {"blade", {Vec3(0, y0, 0), Vec3(0, y1, 0)}, {{0, Vec3(-2, 0, 5.4)}, {100, Vec3(98, 0, 5.4)}}};
}

/// A blade that stops anywhere leaves the fronts that a rectangle up to there leaves.
TEST(Advance, LeavesTheFrontsOfARectangle) {
  for (const double speed : {0.05, 0.3, 2.0}) {
    Cutting moving(block(), Fronts::of_elements);
    double t = 0;
    for (int k = 0; t < 9; ++k, t += speed) {
      moving.step(along_x(), t, t + speed);
      const double end = t + speed - 2;
      if (end < 0.8 || std::abs(end - std::round(end)) < 1e-9 || moving.cutter.n_waiting() > 0)
        continue; // right at a node round-off decides
      Cutting at_once(block(), Fronts::of_elements);
      at_once.cut(Rectangle{Vec3(0.5 * end, 5, 5.4), Vec3(end, 0, 0), Vec3(0, 40, 0)});
      ASSERT_EQ(moving.body.complex.tied.size(), at_once.body.complex.tied.size()) << speed << " " << end;
      for (const auto& [a, b] : at_once.body.complex.tied) {
        const grid::CellId c = at_once.body.complex.copies[a].cell;
        const grid::Front *const one = moving.body.cuts.front(c), *const other = at_once.body.cuts.front(c);
        ASSERT_NE(one, nullptr);
        EXPECT_NEAR(one->passed, other->passed, 0.04) << speed << " " << end;
        EXPECT_EQ(grid::cuts_of_copies(moving.body, c).blades, grid::cuts_of_copies(at_once.body, c).blades);
      }
    }
  }
}

/// Where one blade has stopped, another one goes on in its plane: what a rectangle up to there leaves. One that passes
/// across that plane, ahead of the front, moves nothing.
TEST(Advance, GoesOnWhereAnotherBladeHasStopped) {
  const auto at = [](const double x) { return Vec3(x, 0, 5.4); };
  for (const double stop : {3.1, 3.6})
    for (const double further : {0.15, 0.3, 1.7}) {
      const double end = stop + further, across = std::floor(stop) + 0.9;
      const std::vector<Vec3> edge = {Vec3(0, -20, 0), Vec3(0, 20, 0)};
      const std::array blades = {
        Blade{.name = "first", .edge = edge, .key_frames = {{0, at(-2)}, {1, at(stop)}}, .label = 1},
        Blade{.name = "second", .edge = edge, .key_frames = {{0, at(-2)}, {2, at(-2)}, {3, at(end)}}, .label = 2},
        Blade{.name = "across",
              .edge = {Vec3(0, 0, -0.15), Vec3(0, 0, 0.15)},
              .key_frames = {{1, at(across)}, {2, at(across) + 20 * Vec3::UnitY()}},
              .label = 3}};
      Cutting moving(block(), Fronts::of_elements), at_once(block(), Fronts::of_elements);
      const auto expect_fronts_up_to = [&](const double x) {
        at_once = Cutting(block(), Fronts::of_elements);
        at_once.cut(Rectangle{0.5 * at(x) + Vec3(0, 5, 2.7), Vec3(x, 0, 0), Vec3(0, 40, 0)});
        EXPECT_EQ(moving.body.complex.tied.size(), at_once.body.complex.tied.size()) << stop << " " << x;
        for (const auto& [a, b] : at_once.body.complex.tied) {
          const grid::CellId c = at_once.body.complex.copies[a].cell;
          const grid::Front* const front = moving.body.cuts.front(c);
          ASSERT_NE(front, nullptr);
          EXPECT_NEAR(front->passed, at_once.body.cuts.front(c)->passed, 0.04) << stop << " " << x;
        }
      };
      for (int k = 0; k < 75; ++k) {
        if (k == 25 || k == 50)
          expect_fronts_up_to(stop);
        moving.follow(moving.cutter.step(moving.body, blades, k / 25.0, (k + 1) / 25.0, grid::rest_positions(moving.body)));
      }
      expect_fronts_up_to(end);
    }
}

/// Whichever way it comes, however it steps and wherever it stops: where cuts waited, cells beside them are asked again
/// (a crack was a cube short where a blade came from below and stopped just before a layer of nodes).
TEST(Advance, LeavesThemWhicheverWayItComes) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_down : {false, true})
      for (const double end : {4.995, 5.005, 5.5, 6.1})
        for (const double step : {0.7, 1.87, 2.4}) {
          const Vec3 along = Vec3::Unit(axis), edge = Vec3::Unit((axis + 1) % 3), normal = Vec3::Unit((axis + 2) % 3);
          const auto place = [&](const double s) {
            return Vec3((is_down ? 10 - s : s) * along + 5.4 * normal + 5 * edge);
          };
          Cutting moving(block(), Fronts::of_elements);
          const Blade blade = {"blade", {-20 * edge, 20 * edge}, {{0, place(-2)}, {end + 2, place(end)}}};
          double t = 0;
          for (; t < end + 2; t += step)
            moving.step(blade, t, t + step);
          for (int k = 0; k < 4; ++k, t += step)
            moving.step(blade, t, t + step);
          ASSERT_EQ(moving.cutter.n_waiting(), 0u);
          Cutting at_once(block(), Fronts::of_elements);
          at_once.cut(Rectangle{0.5 * (place(-2) + place(end)), place(end) - place(-2), 40 * edge});
          EXPECT_EQ(moving.body.complex.tied.size(), at_once.body.complex.tied.size())
            << axis << is_down << " " << end << " " << step;
        }
}

/// Where corners are once a wound from the side x = 0 to `end` gapes, and the body has moved on: what lies above and
/// below the plane through z turns away from it.
Points gaping(const Body& body, const double end, const double z, const double gape, const Vec3& shift) {
  const Points rest = grid::rest_positions(body);
  Points x = rest;
  const auto put = [&](const std::uint32_t corner, const bool is_above) {
    const double opening = gape * std::max(0.0, end - rest[corner].x());
    x[corner] = rest[corner] + shift + (is_above ? opening : -opening) * Vec3::UnitZ();
  };
  for (const bool is_real : {false, true})
    for (const grid::Copy& copy : body.complex.copies) {
      const auto has = [&](const int v) { return (copy.nodes >> v & 1) != 0; };
      const auto is_above = [&](const int v) { return rest[copy.corners[v].value].z() > z; };
      int n_above = 0;
      for (int v = 0; v < 8; ++v)
        n_above += !has(v) ? 0 : is_above(v) ? 1 : -1;
      for (int v = 0; v < 8; ++v)
        if (has(v) == is_real)
          put(copy.corners[v].value, is_real ? is_above(v) : n_above > 0);
    }
  return x;
}

/// The blade has come in a step, cuts wait, and the body gives way meanwhile: what moves across a blade that rests does
/// not tell where it goes (a bar that sagged about one hung together by single cells, 20 % too stiff).
TEST(Advance, LeavesThemWhereABodyGivesWayUnderABladeThatRests) {
  support::Random random(31);
  constexpr int n = 200;
  int n_waited = 0, n_lacking = 0;
  for (int i = 0; i < n; ++i) {
    const double tilt = support::uniform(random, -0.05, 0.05);
    const double height = support::uniform(random, 4.2, 4.8), end = support::uniform(random, 4.1, 6.9);
    const auto place = [&](const double s) { return Vec3(s, 5, height + 0.06 * (s - end)); };
    const Vec3 edge = Vec3::UnitY() + tilt * Vec3::UnitZ();
    Cutting moving(block(), Fronts::of_elements);
    const Blade blade = {"blade", {-20 * edge, 20 * edge}, {{0, place(-2)}, {1, place(end)}}};
    moving.step(blade, 0, 1);
    n_waited += moving.cutter.n_waiting() > 0;
    for (int k = 1; k < 8; ++k) {
      const double part = std::min(k, 4) / 4.0;
      moving.step(blade, k, k + 1, gaping(moving.body, end, height, 0.3 * part, part * Vec3(0.6, 0, 0.2)));
    }
    ASSERT_EQ(moving.cutter.n_waiting(), 0u);
    Cutting at_once(block(), Fronts::of_elements);
    const double before = end - 0.03; // cells that the front has only just come to are not asked for
    at_once.cut(Rectangle{0.5 * (place(-2) + place(before)), place(before) - place(-2), 40 * edge});
    n_lacking += moving.body.complex.tied.size() < at_once.body.complex.tied.size();
  }
  std::cout << n_lacking << " of " << n << " lack a front\n";
  EXPECT_GT(n_waited, n / 2);
  EXPECT_LE(n_lacking, n / 15); // where the wound's side comes upon the blade: 34 when that told where it went
}

/// A blade comes along a wound that gapes, and turns away from where it was to go: what the front has parted and does
/// not divide any more stays apart where it gapes (a crack that closed over half a cube gave a liver .3 J where it had
/// .1), unless a shred would come free.
TEST(Advance, JoinsNothingThatGapes) {
  support::Random random(19);
  constexpr double most = 0.25;
  int n_joined = 0, n_gaping = 0, n_far = 0;
  for (int i = 0; i < 80; ++i) {
    const double height = uniform(random, 4, 5), turn = uniform(random, 2.5, 6.5), slope = uniform(random, -1.5, 1.5);
    const Vec3 edge = Vec3::UnitY() + uniform(random, -0.2, 0.2) * Vec3::UnitZ();
    Cutting moving(block(), Fronts::of_elements);
    const Vec3 at_turn(turn, 5, height);
    const Blade blade = {"blade",
                         {-20 * edge, 20 * edge},
                         {{0, at_turn - (turn + 2) * Vec3::UnitX()},
                          {turn + 2, at_turn},
                          {turn + 4, at_turn + 2 * Vec3(1, 0, slope)}}};
    const double step = uniform(random, 0.1, 0.6);
    for (double t = 0; t < turn + 4; t += step) {
      Points x = gaping(moving.body, std::min(t - 2, turn), height, 0.15, Vec3::Zero());
      const grid::CutChange change = moving.step(blade, t, t + step, x);
      grid::inherit(change, x);
      for (const grid::Lapse& lapse : change.lapsed) {
        const double way = (x[lapse.corner.value] - x[lapse.heir.value]).norm();
        ++n_joined;
        n_gaping += way > 0.1;
        n_far += way > most;
      }
    }
    expect_as_built(moving);
    EXPECT_TRUE(is_closed(moving.surface));
    EXPECT_NEAR(sum(support::octant_volumes(moving.body)), 729, 1e-9);
  }
  std::cout << n_joined << " corners joined, " << n_gaping << " over more than a tenth of a cube, " << n_far
            << " over more than a quarter\n";
  EXPECT_GT(n_joined, 100);
  EXPECT_LE(n_far, 8); // those of two shreds
}

/// Do cells whose fronts are new part the faces that they share with others as these do, as far as they do?
void expect_faces_parted_alike(const Body& body, const std::set<grid::CellId>& with_fronts) {
  const auto& copies = body.complex.copies;
  for (const grid::Front& front : body.cuts.fronts())
    for (int face = 0; face < grid::cube::n_faces && !with_fronts.contains(front.cell); ++face) {
      const grid::CellId next = body.grid.neighbour(front.cell, face);
      if (!next.valid())
        continue;
      std::set<grid::CopyId> own, others;
      int n_glued = 0;
      for (const grid::CopyId a : body.complex.copies_of(front.cell))
        for (const grid::CopyId b : body.complex.copies_of(next)) {
          const grid::Part mine = copies[a].part(), its = copies[b].part();
          if (face % 2 == 1 ? !grid::are_glued(mine, its, face / 2) : !grid::are_glued(its, mine, face / 2))
            continue;
          own.insert(a);
          others.insert(b);
          ++n_glued;
        }
      if (own.size() > 1 && others.size() > 1) {
        EXPECT_EQ(n_glued, own.size());
        EXPECT_EQ(n_glued, others.size());
      }
    }
}

/// What fronts have parted stays apart, however a blade goes on: it may gape, and would snap together.
void expect_apart(const Body& body, const std::set<grid::CellId>& with_fronts) {
  for (const grid::CellId c : with_fronts) {
    int n = 0;
    for (const grid::CopyId copy : body.complex.copies_of(c))
      n += body.complex.copies[copy].nodes != 0;
    EXPECT_GE(n, 2);
  }
}

std::set<grid::CellId> cells_with_fronts(const Body& body) {
  std::set<grid::CellId> cells;
  for (const grid::Front& front : body.cuts.fronts())
    cells.insert(front.cell);
  return cells;
}

/// Blades that stop in the body, turn, come back and meet what others have cut, slow and fast, while it rests or
/// swings.
TEST(Advance, LeavesThePiecesMassAndSurfaceAsTheyWere) {
  support::Random random(7);
  std::array<std::size_t, 2> n_fronts{};
  for (int i = 0; i < 40; ++i) {
    const bool swings = i % 2 == 1;
    const Body whole =
      support::with_copies(support::with_placed_skin(support::ball(3 + 0.05 * i, 1, support::random_offset(random))));
    Cutting with(whole, Fronts::of_elements), without(whole, Fronts::at_faces);
    double time = 0;
    for (int stroke = 0; stroke < 2; ++stroke) {
      const Blade blade = random_stroke(random, 4);
      const int n_steps = std::array{3, 17, 60}[i % 3], n_back = static_cast<int>(random() % 4);
      for (int k = 0; k < n_steps + n_back; ++k, time += 1.0 / n_steps) {
        const double t0 = std::min(1.0, double(k) / n_steps), t1 = k < n_steps ? double(k + 1) / n_steps : 0.9;
        const std::set<grid::CellId> before = cells_with_fronts(with.body);
        for (Cutting* const cutting : {&with, &without})
          cutting->step(blade, t0, t1, swung(cutting->body, swings ? 0.3 : 0, time));
        expect_faces_parted_alike(with.body, before);
        expect_apart(with.body, before);
      }
      SCOPED_TRACE(testing::Message() << i << " " << stroke);
      expect_alike(with, without);
    }
    n_fronts[swings] += with.body.complex.tied.size();
    expect_as_built(with);
  }
  EXPECT_GT(n_fronts[0], 200u);
  EXPECT_GT(n_fronts[1], 20u);
}

/// From one side of a body to the other in curves, turning, with an edge that reaches beyond it.
Blade winding(support::Random& random) {
  const Vec3 towards = random_direction(random), side = towards.unitOrthogonal(), up = side.cross(towards);
  Blade blade{"blade", {-20 * side, 20 * side}, {}};
  for (int k = 0; k <= 4; ++k)
    blade.key_frames.push_back({0.25 * k, (4 * k - 8) * towards + uniform(random, -1, 1) * up,
                                uniform(random, -15, 15) * random_direction(random)});
  return blade;
}

/// What fronts had divided ahead of a blade is joined where the blade has gone on otherwise: copies, corners and
/// surface of a completed cut are those without fronts.
TEST(Advance, LeavesACompletedCutAsItIsWithoutFronts) {
  support::Random random(11);
  std::size_t n_begun = 0, n_lapsed = 0, n_lapsed_copies = 0, n_left = 0, n_same = 0, n_led_same = 0;
  constexpr int n_bodies = 36, n_led = 24; // by the blade; the others move through one that rests
  for (int i = 0; i < n_bodies; ++i) {
    const Body whole =
      support::with_copies(support::with_placed_skin(support::ball(3 + 0.05 * i, 1, support::random_offset(random))));
    Cutting with(whole, Fronts::of_elements), without(whole, Fronts::at_faces);
    const Blade blade = winding(random);
    const double height = i % 2 == 0 ? 0 : 0.3;
    const int n_steps = std::array{7, 17, 40}[i % 3];
    Blade still = blade;
    still.key_frames.resize(1);
    const auto place = [&](const Body& body, const double t) {
      Points x = swung(body, height, t);
      if (i >= n_led)
        for (Vec3& p : x)
          p -= pose(blade, t).position - pose(blade, 0).position;
      return x;
    };
    for (Cutting* const cutting : {&with, &without})
      cutting->cutter.stand(place(cutting->body, 0));
    for (int k = 0; k < n_steps || with.cutter.n_waiting() + without.cutter.n_waiting() > 0; ++k) {
      const double t0 = std::min(1.0, double(k) / n_steps), t1 = std::min(1.0, double(k + 1) / n_steps);
      for (Cutting* const cutting : {&with, &without})
        cutting->step(i < n_led ? blade : still, t0, t1, place(cutting->body, i < n_led ? t0 : t1));
      n_begun += with.body.cuts.fronts().size();
    }
    SCOPED_TRACE(i);
    n_lapsed += with.body.complex.lapsed.size();
    n_lapsed_copies += with.body.complex.n_copies() - grid::n_copies_in_use(with.body.complex);
    n_left += with.body.cuts.fronts().size();
    expect_alike(with, without);
    expect_as_built(with);
    if (!with.body.cuts.fronts().empty())
      continue;
    const auto names = support::renaming(with.body.complex, without.body.complex);
    ASSERT_TRUE(names);
    EXPECT_TRUE(support::is_same(with.surface, without.surface, *names));
    EXPECT_EQ(grid::n_copies_in_use(with.body.complex), without.body.complex.n_copies());
    ++n_same;
    n_led_same += i < n_led;
  }
  std::cout << n_same << " of " << n_bodies << " bodies the same, " << n_led_same << " of " << n_led << " led; " << n_begun << " fronts in all steps, " << n_lapsed
            << " corners lapsed, " << n_left << " fronts left\n";
  EXPECT_GE(n_same, n_bodies - 9u);
  EXPECT_GT(n_begun, 1200u);
  EXPECT_GT(n_lapsed, 10u);
  EXPECT_GT(n_lapsed_copies, 10u);
}

/// Which cells have fronts, and how far these have come, is hardly a matter of the length of steps.
TEST(Advance, DoesNotDependOnSteps) {
  support::Random random(9);
  std::size_t n_all = 0, n_common = 0, n_of_one = 0;
  for (int i = 0; i < 20; ++i) {
    const Body whole =
      support::with_copies(support::with_placed_skin(support::ball(4, 1, support::random_offset(random))));
    Cutting slow(whole, Fronts::of_elements), fast(whole, Fronts::of_elements);
    Blade blade = random_stroke(random, 4);
    for (KeyFrame& frame : blade.key_frames)
      frame.rotation = Vec3::Zero();
    const auto pass = [&](Cutting& cutting, const int n, const double end) {
      for (int k = 0; k < n || cutting.cutter.n_waiting() > 0; ++k)
        cutting.step(blade, std::min(end, end * k / n), std::min(end, end * (k + 1) / n));
    };
    pass(slow, 80, 0.6);
    pass(fast, 2, 0.6);
    n_all += fast.body.complex.tied.size();
    for (const auto& [a, b] : slow.body.complex.tied) {
      const grid::CellId c = slow.body.complex.copies[a].cell;
      const grid::Front *const one = slow.body.cuts.front(c), *const other = fast.body.cuts.front(c);
      n_of_one += other == nullptr;
      if (!other)
        continue;
      ++n_common;
      EXPECT_NEAR(one->passed, other->passed, 0.02);
      EXPECT_EQ(grid::cuts_of_copies(slow.body, c).blades, grid::cuts_of_copies(fast.body, c).blades);
    }
  }
  EXPECT_GT(n_common, 100u);
  EXPECT_LE(n_of_one, n_common / 15); // that had begun when cells beside them were whole
  EXPECT_LE(n_all, n_common + n_common / 15);
}

/// A blade that turns on its way along a cylinder: most cells in which it ends are parted, as by its sweep as a mesh.
TEST(Advance, LeavesFrontsWhereABladeTurns) {
  support::Random random(12);
  std::size_t n_all = 0, n_common = 0;
  for (int i = 0; i < 30; ++i) {
    const double radius = support::uniform(random, 5, 14), end = support::uniform(random, 0.3, 0.6) * 10;
    const Vec3 axis = (Vec3::UnitY() + 0.2 * support::random_vector(random)).normalized(),
               start = Vec3(-1, 5, 5) + support::random_vector(random);
    Blade blade{"blade", {-20 * axis, 20 * axis}, {}};
    const Vec3 towards = (Vec3::UnitX() - axis.x() * axis).normalized(), up = towards.cross(axis);
    for (int k = 0; k <= 60; ++k) {
      const double angle = (end + 1) / radius * k / 60;
      blade.key_frames.push_back(
        {k / 60.0, start + radius * (std::sin(angle) * towards + (1 - std::cos(angle)) * up), Vec3::Zero()});
    }
    Cutting by_blade(block(), Fronts::of_elements), by_mesh(block(), Fronts::of_elements);
    const int n_steps = std::array{3, 11, 60}[i % 3];
    for (int k = 0; k < n_steps || by_blade.cutter.n_waiting() > 0; ++k)
      by_blade.step(blade, std::min(1.0, double(k) / n_steps), std::min(1.0, double(k + 1) / n_steps));
    geometry::TriangleMesh swept;
    for (const auto& triangle : sweep(blade, 0, 1)) {
      const auto first = static_cast<std::uint32_t>(swept.vertices.size());
      swept.vertices.insert(swept.vertices.end(), triangle.begin(), triangle.end());
      swept.triangles.push_back({first, first + 1, first + 2});
    }
    by_mesh.cut(swept);
    for (const grid::Front& front : by_mesh.body.cuts.fronts())
      n_common += by_blade.body.cuts.front(front.cell) != nullptr;
    n_all += by_mesh.body.cuts.fronts().size();
    SCOPED_TRACE(i);
    expect_alike(by_blade, by_mesh);
  }
  std::cout << n_common << " of " << n_all << " fronts\n";
  EXPECT_GT(n_common, 0.6 * double(n_all));
}

} // namespace
} // namespace kerf::cut::advance_test
