/// Cuts that cross each other, where a segment keeps the first of them.

#include "cut/may_meet.h"
#include "cut/sides.h"
#include "tests/cut/bridges.h"
#include "tests/cut/cutting.h"
#include "tests/cut/patient.h"

#include <gtest/gtest.h>

#include <bit>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <ranges>

namespace kerf::cut::crossing_cuts_test {
namespace {

/// Segments of the skin whose ends lie on different sides of a plane that has cut, and yet are whole; and the reverse.
struct WrongSegments {
  int n = 0, whole = 0, parted = 0;
};

void count_segments(const Patient& patient, const std::vector<support::Plane>& planes, WrongSegments& wrong) {
  const grid::Grid& grid = patient.body.grid;
  for (const auto c : ids<grid::CellId>(grid.n_cells())) {
    const grid::CellCuts cell = grid::cuts_of(patient.body, c);
    for (grid::Segments left = cell.skeleton().segments & ~grid::skeleton::lines; left != 0; left &= left - 1) {
      const int segment = std::countr_zero(left);
      const auto& ends = cell.skeleton().segment[segment].ends;
      const Vec3 p = grid::item_point(patient.body, c, ends[0]), q = grid::item_point(patient.body, c, ends[1]);
      const bool is_parted = std::any_of(planes.begin(), planes.end(), [&](const support::Plane& plane) {
        return (plane.height(p) < 0) != (plane.height(q) < 0);
      });
      ++wrong.n;
      wrong.whole += is_parted && !(cell.blades >> segment & 1);
      wrong.parted += !is_parted && (cell.blades >> segment & 1);
    }
  }
}

/// Two planes that cross in the box make four pieces, whichever comes first, as blades and at once. What the planes
/// part is parted, but for tips that the cut says it has left (cut/shreds.h).
TEST(AtSkin, TheOrderOfTwoCutsThatCrossDoesNotMatter) {
  Random random(108);
  double worst = 0, largest_splinter = 0;
  int n = 0, n_splinters = 0;
  WrongSegments wrong;
  for (int i = 0; i < 160; ++i) {
    const Body body = box_body(random);
    const Vec3 through = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
    const std::array normals = {random_direction(random), random_direction(random)};
    if (std::abs(normals[0].dot(normals[1])) > 0.8)
      continue;
    const std::vector<support::Plane> planes = {{normals[0], normals[0].dot(through)},
                                                {normals[1], normals[1].dot(through)}};
    std::vector<Patient> patients;
    for (const int first : {0, 1}) {
      Patient by_blades{body}, at_once{body};
      for (const int k : {first, 1 - first}) {
        const auto label = static_cast<grid::CutLabel>(k + 1);
        const Frame frame = across(normals[k], uniform(random, 0, 6.3));
        by_blades.pass(straight(through, frame.u, frame.v, 2, 2, label), steps(i),
                       i % 2 == 0 ? Release::queued : Release::at_once);
        at_once.cut_through(Plane{through, normals[k]}, label);
      }
      patients.push_back(by_blades);
      patients.push_back(at_once);
    }
    const auto of_first = patients[0].volumes();
    for (const Patient& patient : patients) {
      const int n_whole = wrong.whole;
      count_segments(patient, planes, wrong);
      const int n_left_whole = static_cast<int>(patient.body.cuts.n_left_whole());
      EXPECT_LE(wrong.whole - n_whole, 2 * n_left_whole) << i; // two cells share a half of an arc
      auto volumes = patient.volumes();
      ASSERT_GE(volumes.size(), 4u) << "a bridge, " << i;
      EXPECT_NEAR(total(volumes), box_volume, 1e-12 * box_volume);
      EXPECT_TRUE(patient.is_as_built()) << i;
      for (std::size_t k = 0; k + 4 < volumes.size(); ++k, ++n_splinters)
        largest_splinter = std::max(largest_splinter, volumes[k] / cube);
      for (int k = 1; k <= 4; ++k)
        worst = std::max(worst, std::abs(volumes.end()[-k] - of_first.end()[-k]) / cube);
      ++n;
    }
  }
  std::cout << n << " bodies: the four pieces differ by at most " << worst << " h^3; " << n_splinters
            << " splinters of at most " << largest_splinter << " h^3; " << wrong.n << " segments of the skin\n";
  EXPECT_LT(worst, 3);
  EXPECT_LT(largest_splinter, 1);
  EXPECT_LE(n_splinters, n / 100);
  EXPECT_LE(wrong.whole, 4); // tips that stay
  EXPECT_EQ(wrong.parted, 0);
  EXPECT_GT(wrong.n, 10000);
}

/// For each material node the lowest one of its piece.
std::vector<std::uint32_t> partition(const Patient& patient) {
  const grid::Grid& grid = patient.body.grid;
  const auto pieces = grid::pieces(patient.body.complex);
  std::map<std::uint32_t, std::uint32_t> first;
  std::vector<std::uint32_t> result(grid.n_nodes(), grid::NodeId::no_value);
  for (const auto c : ids<grid::CopyId>(patient.body.complex.n_copies())) {
    const grid::Copy& copy = patient.body.complex.copies[c];
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      if (copy.nodes >> v & 1)
        result[grid.nodes(copy.cell)[v].value] = pieces.piece[c];
  }
  for (std::uint32_t n = 0; n < result.size(); ++n)
    if (result[n] != grid::NodeId::no_value)
      result[n] = first.try_emplace(result[n], n).first->second;
  return result;
}

/// Three planes through a body, in all six orders, by blades and at once: the same nodes hang together.
TEST(AtSkin, TheOrderOfThreeCutsLeavesTheSameNodesTogether) {
  Random random(110);
  int n_bodies = 0, n_other = 0;
  double bridge = 0;
  std::size_t most_pieces = 0;
  for (int i = 0; i < 60; ++i) {
    const Body body = i % 2 ? box_body(random)
                            : support::embedded(geometry::sphere_mesh(0.4, Vec3::Zero(), 4), h, random_offset(random));
    const Vec3 middle = i % 2 ? Vec3(0.5 * (box.lower + box.upper)) : Vec3::Zero();
    std::array<Vec3, 3> normals, through;
    for (int k = 0; k < 3; ++k) {
      normals[k] = random_direction(random);
      through[k] = middle + 0.1 * support::random_vector(random);
    }
    std::vector<support::Plane> planes;
    for (int k = 0; k < 3; ++k)
      planes.push_back({normals[k], normals[k].dot(through[k])});
    std::array<int, 3> order = {0, 1, 2};
    std::optional<std::vector<std::uint32_t>> expected;
    do
      for (const bool at_once : {true, false}) {
        Patient patient{body};
        for (const int k : order) {
          const auto label = static_cast<grid::CutLabel>(k + 1);
          const Frame frame = across(normals[k], 0.1 * i);
          if (at_once)
            patient.cut_through(Plane{through[k], normals[k]}, label);
          else
            patient.pass(straight(through[k], frame.u, frame.v, 2, 2, label), 1 + i % 7,
                         i % 3 ? Release::queued : Release::at_once);
        }
        const auto found = partition(patient);
        bridge = std::max(bridge, largest_bridge(patient, planes));
        most_pieces = std::max<std::size_t>(most_pieces, patient.volumes().size());
        ++n_bodies;
        if (!expected)
          expected = found;
        n_other += found != *expected;
      }
    while (std::next_permutation(order.begin(), order.end()));
  }
  std::cout << n_bodies << " bodies, up to " << most_pieces << " pieces; " << n_other << " with other nodes together\n";
  EXPECT_EQ(n_other, 0);
  EXPECT_LT(bridge, 1);
}

/// Pairs of copies in one cell, or in two with a common face, that lie on the same sides of all planes that have cut,
/// and yet in two pieces: material of one piece for a Boolean, as what lies between planes is convex.
int n_parted_though_one(const Patient& patient, const std::vector<support::Plane>& planes) {
  const Body& body = patient.body;
  const auto pieces = grid::pieces(body.complex);
  const auto sides = [&](const grid::CopyId copy) {
    const grid::Copy& of = body.complex.copies[copy];
    const Vec3 p = grid::item_point(body, of.cell, std::countr_zero(of.items()));
    unsigned bits = 0;
    for (std::size_t i = 0; i < planes.size(); ++i)
      bits |= unsigned(planes[i].height(p) >= 0) << i;
    return bits;
  };
  int n = 0;
  for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
    for (int face = -1; face < grid::cube::n_faces; face += 2) {
      const grid::CellId next = face < 0 ? c : body.grid.neighbour(c, face);
      for (const grid::CopyId a : body.complex.copies_of(c))
        for (grid::CopyId b = next.valid() ? body.complex.first_copy[next] : grid::CopyId(); b.valid();
             b = body.complex.copies[b].next)
          n += pieces.piece[a] != pieces.piece[b] && sides(a) == sides(b);
    }
  return n;
}

/// Two planes that cross at a small angle, by blades and at once: four pieces. Where the wedge between them is thinner
/// than a cube, nodes lie in it here and there: those of one cell hang together, and of cells with a common face, all
/// of them; others, where the wedge passes through a cell in which it has neither a node nor a point of the skin, are
/// held by what is beside, but for some that no interval leads to.
class SmallAngle : public testing::TestWithParam<int> {};

TEST_P(SmallAngle, LeavesFourPiecesAndFewSplinters) {
  Random random(111);
  for (const auto& [degrees, least] : {std::pair{5.0, 0.97}, {15.0, 1.0}, {30.0, 1.0}, {60.0, 1.0}}) {
    const double angle = degrees * std::numbers::pi / 180;
    int n_bodies = 0, n_of_four = 0;
    std::size_t n_splinters = 0;
    double largest_splinter = 0, largest_held = 0;
    for (int i = 0; i < GetParam(); ++i) {
      const Body body = i % 2
                          ? box_body(random)
                          : support::embedded(geometry::sphere_mesh(0.4, Vec3::Zero(), 3), h, random_offset(random));
      const Vec3 middle = i % 2 ? Vec3(0.5 * (box.lower + box.upper)) : Vec3::Zero();
      const Vec3 through = middle + 0.05 * support::random_vector(random), first = random_direction(random);
      const std::array normals = {
        first, Vec3(std::cos(angle) * first + std::sin(angle) * across(first, uniform(random, 0, 6.3)).u)};
      for (const bool at_once : {true, false}) {
        Patient patient{body};
        for (const int k : {0, 1}) {
          const auto label = static_cast<grid::CutLabel>(k + 1);
          const Frame frame = across(normals[k], uniform(random, 0, 6.3));
          if (at_once)
            patient.cut_through(Plane{through, normals[k]}, label);
          else
            patient.pass(straight(through, frame.u, frame.v, 2, 2, label), steps(i), Release::queued);
        }
        const auto volumes = patient.volumes();
        ASSERT_GE(volumes.size(), 4u);
        EXPECT_NEAR(total(volumes), total(Patient{body}.volumes()), 1e-12);
        EXPECT_TRUE(patient.is_as_built()) << i;
        const std::vector<support::Plane> planes = {{normals[0], normals[0].dot(through)},
                                                    {normals[1], normals[1].dot(through)}};
        largest_held = std::max(largest_held, largest_bridge(patient, planes));
        EXPECT_EQ(n_parted_though_one(patient, planes), 0);
        ++n_bodies;
        n_of_four += volumes.size() == 4;
        n_splinters += volumes.size() - 4;
        if (volumes.size() > 4)
          largest_splinter = std::max(largest_splinter, volumes.end()[-5] / cube);
      }
    }
    std::cout << degrees << " degrees: four pieces in " << n_of_four << " of " << n_bodies << " bodies, in the others "
              << n_splinters << " splinters of at most " << largest_splinter << " h^3; held ones have at most "
              << largest_held << " h^3\n";
    EXPECT_LT(largest_splinter, 1);
    EXPECT_LT(largest_held, 1);
    EXPECT_GE(n_of_four, least * n_bodies);
  }
}

/// Tips of the skin that stay on the body (cut/shreds.h) may lie in the wedge between two cuts. What is met later, also
/// two cells further on, tells that they belong to it: then they hold it to nothing else.
TEST(AtSkin, TipsInAWedgeDoNotHoldItToWhatIsBeside) {
  Random random(140);
  std::size_t n_left_whole = 0;
  for (int i = 0; i < 60; ++i) {
    const Body body = i % 2 ? box_body(random)
                            : support::embedded(geometry::sphere_mesh(0.4, Vec3::Zero(), 3), h, random_offset(random));
    const Vec3 middle = i % 2 ? Vec3(0.5 * (box.lower + box.upper)) : Vec3::Zero();
    const Vec3 through = middle + 0.05 * support::random_vector(random), first = random_direction(random),
               second = first + 0.09 * across(first, uniform(random, 0, 6.3)).u;
    const std::vector<support::Plane> planes = {{first, first.dot(through)}, {second, second.dot(through)}};
    Patient patient{body};
    for (const Vec3& normal : {first, second}) {
      const Frame frame = across(normal.normalized(), uniform(random, 0, 6.3));
      const grid::CutLabel label = normal == first ? 1 : 2;
      patient.pass(straight(through, frame.u, frame.v, 2, 2, label), 60, Release::queued);
    }
    EXPECT_GE(patient.volumes().size(), 4u) << i;
    EXPECT_LT(largest_bridge(patient, planes), 1) << i;
    n_left_whole += patient.body.cuts.n_left_whole();
  }
  EXPECT_GT(n_left_whole, 0u);
}

/// Copies on two sides of a face that have no node or point of the skin in common there, and yet its four corners.
std::size_t n_glued_by_intervals(const Body& body) {
  std::size_t n = 0;
  const auto& complex = body.complex;
  for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
    for (int face = 1; face < grid::cube::n_faces; face += 2) {
      const grid::CellId next = body.grid.neighbour(c, face);
      for (const grid::CopyId a : complex.copies_of(c))
        for (grid::CopyId b = next.valid() ? complex.first_copy[next] : grid::CopyId(); b.valid();
             b = complex.copies[b].next) {
          grid::Part mine = complex.copies[a].part(), its = complex.copies[b].part();
          mine.intervals = its.intervals = 0;
          n += !grid::are_glued(mine, its, face / 2) &&
               std::ranges::all_of(grid::cube::face_vertices[face], [&](const int v) {
                 return complex.copies[a].corners[v] == complex.copies[b].corners[v ^ 1 << face / 2];
               });
        }
    }
  return n;
}

/// Whether cuts end at faces or inside cells: complex and surface, which follow a blade that crosses an earlier cut,
/// are in every 16th step those that are built from what is cut.
TEST(AtSkin, WhatASmallAngleJoinsIsAsBuilt) {
  Random random(112);
  std::size_t n_joined = 0, n_across_faces = 0;
  for (int i = 0; i < 4; ++i) {
    const double angle = (i % 3 + 1) * 10 * std::numbers::pi / 180;
    const Body body =
      support::with_copies(i % 2 ? box_body(random) : support::ball(0.4, h, support::random_offset(random)));
    Cutting cutting(body, i < 2 ? Fronts::at_faces : Fronts::of_elements);
    const Vec3 through =
      0.5 * (body.grid.position(grid::NodeId(0u)) + body.grid.position(grid::NodeId(body.grid.n_nodes() - 1)));
    const Vec3 n = random_direction(random), along = n.unitOrthogonal();
    cutting.follow(cutting.cutter.at_once(cutting.body, {"first", Plane{through, n}, 1}, rest_positions(cutting.body)));
    const Vec3 turned = std::cos(angle) * n.cross(along) + std::sin(angle) * n;
    const Blade blade = straight(through, along, turned, 2, 2, 2);
    constexpr int n_steps = 60;
    for (int k = 0; k < n_steps + 4; ++k) {
      cutting.step(blade, double(k) / n_steps, double(k + 1) / n_steps);
      if (k % 16 == 15)
        expect_as_built(cutting);
    }
    for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
      n_joined += cutting.body.cuts.joined(c) != nullptr;
    n_across_faces += n_glued_by_intervals(cutting.body);
  }
  EXPECT_GT(n_joined, 10u);
  EXPECT_GT(n_across_faces, 10u);
}

/// A body between two walls whose pieces fall, each as a whole, once they hang on none of them.
struct Falling {
  /// `fall`: in the time in which the blade goes on by a cube, of the square of that time [cubes].
  Falling(const Patient& of, const double fall) : patient(of), speed(of.x.size(), Vec3::Zero()), fall(fall) {
    const auto [low, high] = std::ranges::minmax(of.x | std::views::transform([](const Vec3& p) { return p[0]; }));
    walls = {low + 1.5 * h, high - 1.5 * h};
  }

  /// By so much of a cube in each step, and then some steps of rest. `drawn`: how far the body is drawn along in each
  /// step until then [m].
  void pass(const Blade& blade, const int n_steps, const double step, int n_rest = 0,
            const Vec3& drawn = Vec3::Zero()) {
    Cutter cutter = patient.cutter(blade.label);
    for (int k = 0; k <= n_steps || cutter.n_waiting() > 0 || n_rest-- > 0; ++k) {
      auto change =
        cutter.step(patient.body, std::span(&blade, 1), double(k) / n_steps, double(k + 1) / n_steps, patient.x);
      patient.follow(change);
      grid::inherit(change, speed);
      move(step);
      if (k < n_steps)
        for (Vec3& p : patient.x)
          p += drawn;
    }
  }

  void move(const double step) {
    const auto& complex = patient.body.complex;
    const grid::Pieces pieces = grid::pieces(complex);
    std::vector<std::uint8_t> hangs(pieces.n_pieces, 0);
    std::vector<std::uint32_t> piece(complex.n_corners());
    for (const auto c : ids<grid::CopyId>(complex.n_copies()))
      for (const auto corner : complex.copies[c].corners) {
        const double at = patient.body.grid.position(complex.node[corner])[0];
        piece[corner.value] = pieces.piece[c];
        hangs[pieces.piece[c]] |= at < walls[0] || at > walls[1];
      }
    for (std::size_t i = 0; i < piece.size(); ++i) {
      speed[i] = hangs[piece[i]] ? Vec3(Vec3::Zero()) : Vec3(speed[i] - fall * step * step * h * Vec3::UnitZ());
      patient.x[i] += speed[i];
    }
  }

  Patient patient;
  Points speed; ///< a step [m]
  double fall;
  std::array<double, 2> walls{};
};

/// A box that one of two planes has cut, which cross in it at a small angle, in a level line; the other is for a blade.
struct HalfCrossed {
  HalfCrossed(Random& random, const int i) : patient(box_body(random)) {
    const double angle = (i % 3 == 0 ? 30 : 15) * std::numbers::pi / 180;
    through = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
    const Vec3 first = Vec3(1, uniform(random, -0.2, 0.2), uniform(random, -0.1, 0.1)).normalized();
    line = first.cross(Vec3::UnitZ()).normalized();
    const Vec3 second = std::cos(angle) * first + std::sin(angle) * first.cross(line);
    ahead = (i % 2 ? 1 : -1) * second.cross(line);
    planes = {{first, first.dot(through)}, {second, second.dot(through)}};
    patient.cut_through(Plane{through, first}, 1);
  }

  Blade blade(const double stop) const { return straight(through, line, ahead, 0.7, stop, 2); }
  /// How far the box reaches along the blade's way, from where the planes cross [m].
  double reach() const { return Interval(box, ahead).high - ahead.dot(through); }

  Patient patient;
  Vec3 through, line, ahead;
  std::vector<support::Plane> planes;
};

int n_steps_of(const Blade& blade, const double step) {
  return static_cast<int>(std::ceil(blade.key_frames[1].position.norm() / (step * h)));
}

/// What a slow blade frees before it has passed a cell may have fallen by some cubes when that tells what it belongs
/// to.
TEST_P(SmallAngle, LeavesFourPiecesThoughTheyFallMeanwhile) {
  Random random(113);
  int n_bodies = 0, n_of_four = 0, n_as_built = 0;
  for (int i = 0; i < GetParam(); ++i) {
    const HalfCrossed half(random, i);
    const Blade blade = half.blade(0.7);
    for (const double fall : {0.5, 2.0}) {
      Falling falling(half.patient, fall);
      falling.pass(blade, n_steps_of(blade, 0.2), 0.2);
      n_of_four += falling.patient.volumes().size() == 4;
      n_as_built += falling.patient.is_as_built();
      ++n_bodies;
    }
  }
  std::cout << "four pieces in " << n_of_four << " of " << n_bodies << " bodies that fall\n";
  EXPECT_GE(n_of_four, 0.95 * n_bodies); // else splinters: a blade that has rested holds no cell again
  EXPECT_EQ(n_as_built, n_bodies);
}

INSTANTIATE_TEST_SUITE_P(Short, SmallAngle, testing::Values(8));
INSTANTIATE_TEST_SUITE_P(Long, SmallAngle, testing::Values(80));

/// A blade that rests has come as far as it does: no cell waits for it, whether it is still in the body or just beside
/// it.
TEST(RestingBlades, LeaveNoCellWaiting) {
  Random random(114);
  for (int i = 0; i < 4; ++i)
    for (const bool is_beside : {false, true}) {
      const HalfCrossed half(random, i);
      Falling still(half.patient, 0);
      still.pass(half.blade(is_beside ? half.reach() + 0.3 * h : 0.2 * h), 40, 0, 2);
      const Patient& patient = still.patient;
      for (const auto c : ids<grid::CellId>(patient.body.grid.n_cells())) {
        const auto* const joined = patient.body.cuts.joined(c);
        EXPECT_EQ(joined ? *joined : std::vector<grid::Joined>(), on_same_sides(patient.body, c));
      }
      EXPECT_EQ(patient.volumes().size(), is_beside ? 4u : 3u);
      EXPECT_TRUE(patient.is_as_built());
    }
}

class RestingBlade : public testing::TestWithParam<int> {};

/// A blade stops less than a cube beside the body, whose pieces then fall past it; or it rests all the time, and the
/// body is drawn over it.
TEST_P(RestingBlade, LeavesFourPieces) {
  constexpr double step = 0.2;
  Random random(115);
  int n_bodies = 0, n_of_four = 0, n_bridged = 0;
  for (int i = 0; i < GetParam(); ++i) {
    const HalfCrossed half(random, i);
    const Blade moving = half.blade(half.reach() + uniform(random, 0, h));
    Blade resting = moving;
    resting.key_frames[1].position = Vec3::Zero();
    const int n_steps = n_steps_of(moving, step);
    for (const double fall : {0.5, 2.0})
      for (const Blade& blade : {moving, resting}) {
        const Vec3 way = moving.key_frames[1].position - blade.key_frames[1].position;
        Falling falling(half.patient, fall);
        falling.pass(blade, n_steps, step, 20, -way / n_steps);
        n_of_four += falling.patient.volumes().size() == 4;
        n_bridged += largest_bridge(falling.patient, half.planes) >= 1;
        ++n_bodies;
      }
  }
  std::cout << "four pieces in " << n_of_four << " of " << n_bodies << " bodies, " << n_bridged
            << " joined across a plane\n";
  EXPECT_EQ(n_bridged, 0);
  EXPECT_GE(n_of_four, 0.95 * n_bodies); // else splinters: a blade that has rested holds no cell again
}

INSTANTIATE_TEST_SUITE_P(Short, RestingBlade, testing::Values(8));
INSTANTIATE_TEST_SUITE_P(Long, RestingBlade, testing::Values(1000));

} // namespace
} // namespace kerf::cut::crossing_cuts_test
