/// Strokes through bodies leave what exact Boolean operations leave: the same pieces, at any speed. The long test takes
/// 1100 strokes, and all closed meshes of the folder that KERF_STROKE_MESHES names:
///
///   KERF_STROKE_MESHES=folder ./kerf test -L long -R Strokes

#include "cut/scissors.h"
#include "tests/cut/boolean.h"
#include "tests/cut/least_material.h"
#include "tests/cut/patient.h"
#include "tests/cut/unit_solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <map>

namespace kerf::cut::strokes_test {
namespace {

geometry::TriangleMesh skin_of(const Patient& patient) {
  const surface::Surface surface = surface::build_surface(patient.body);
  return {surface.rest, surface.triangles};
}

struct Counted {
  int n_strokes = 0, n_pieces = 0, n_fewer = 0, n_more = 0;
  int n_unknown = 0; ///< the grid's skin intersects itself
  LeastMaterial least;
};

auto n_above(const std::vector<double>& volumes, const double least) {
  return volumes.end() - std::upper_bound(volumes.begin(), volumes.end(), least);
}

/// Pieces above a volume that the first has and the second has not; what is within a factor of two of that does not
/// count.
bool has_more(const std::vector<double>& first, const std::vector<double>& second, const double least) {
  return n_above(first, 2 * least) > n_above(second, 0.5 * least);
}

/// Blades that pass a body, and what the Boolean leaves of it then.
struct Stroking {
  std::vector<Blade> blades;
  std::function<std::optional<std::vector<double>>(const geometry::TriangleMesh& skin)> leaves;
};

using Planes = std::vector<support::Plane>;

/// Each in a plane, as far as the body reaches and beyond.
Stroking straight_blades(const Planes& planes, const Vec3& middle, Random& random) {
  Stroking stroking{{}, [=](const auto& skin) { return volumes_between(skin, planes); }};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Frame frame = across(planes[i].normal, uniform(random, 0, 6.3));
    const Vec3 through = middle - planes[i].height(middle) * planes[i].normal;
    stroking.blades.push_back(straight(through, frame.u, frame.v, 1.5, 1.5, static_cast<grid::CutLabel>(i + 1)));
  }
  return stroking;
}

/// They close on the body from 170 degrees, so that each blade cuts a part of the plane.
Stroking closing_scissors(const support::Plane& plane, const Vec3& middle, Random& random) {
  const Frame frame = across(plane.normal, uniform(random, 0, 6.3));
  const Vec3 pivot = middle - plane.height(middle) * plane.normal - 1.5 * frame.u;
  const Points edge = {pivot, pivot + 3 * frame.u};
  const auto both = blades(Scissors{.name = "scissors",
                                    .pivot = pivot,
                                    .axis = plane.normal,
                                    .edges = {edge, edge},
                                    .openings = {{0, 170}, {1, 0}},
                                    .key_frames = {{0, Vec3::Zero(), Vec3::Zero()}}},
                           1);
  return {{both[0], both[1]}, [=](const auto& skin) { return volumes_between(skin, {plane}); }};
}

/// What lies below a sheet that rises over a line along u by `bends` (places, heights) and goes on along v.
geometry::TriangleMesh below(const std::vector<std::array<double, 2>>& bends, const Vec3& origin, const Vec3& normal,
                             const Frame& frame) {
  constexpr double reach = 2;
  const auto n = static_cast<std::uint32_t>(bends.size());
  geometry::TriangleMesh mesh;
  const auto quad = [&](const std::uint32_t a, const std::uint32_t b, const std::uint32_t c, const std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (const double side : {-reach, reach}) // of each end first the sheet's points, then those far below
    for (const bool is_far : {false, true})
      for (const auto& [u, height] : bends)
        mesh.vertices.push_back(origin + u * frame.u + side * frame.v + (is_far ? -reach : height) * normal);
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    quad(i, i + 1, 2 * n + i + 1, 2 * n + i);
    quad(n + i + 1, n + i, 3 * n + i, 3 * n + i + 1);
    quad(i + 1, i, n + i, n + i + 1);
    quad(2 * n + i, 2 * n + i + 1, 3 * n + i + 1, 3 * n + i);
  }
  quad(0, 2 * n, 3 * n, n);
  quad(n - 1, 2 * n - 1, 4 * n - 1, 3 * n - 1);
  return mesh;
}

/// A cutting edge with two bends of up to 40 degrees or so, pushed along v.
Stroking bent_blade(const support::Plane& plane, const Vec3& middle, Random& random) {
  const Frame frame = across(plane.normal, uniform(random, 0, 6.3));
  const Vec3 origin = middle - plane.height(middle) * plane.normal, w = frame.u.cross(frame.v);
  const std::vector<std::array<double, 2>> bends = {{-1.5, 0},
                                                    {uniform(random, -0.3, -0.1), uniform(random, -0.2, 0.2)},
                                                    {uniform(random, 0.1, 0.3), uniform(random, -0.2, 0.2)},
                                                    {1.5, 0}};
  Blade blade = straight(origin, frame.u, frame.v, 1.5, 1.5);
  blade.edge.clear();
  for (const auto& [u, height] : bends)
    blade.edge.push_back(origin + u * frame.u + height * w - 1.5 * frame.v);
  check(blade);
  const geometry::TriangleMesh solid = below(bends, origin, w, frame);
  return {{blade}, [=](const auto& skin) { return volumes_beside(skin, solid); }};
}

void pass_all(Patient& patient, const std::vector<Blade>& blades, const double speed) {
  const int n_steps = std::max(1, static_cast<int>(3 / (speed * patient.body.grid.h())));
  Cutter cutter = patient.cutter(static_cast<grid::CutLabel>(blades.size()));
  for (int k = 0; k <= n_steps || cutter.n_waiting() > 0; ++k)
    patient.follow(cutter.step(patient.body, blades, double(k) / n_steps, double(k + 1) / n_steps, patient.x));
}

enum class Tool { blades, scissors, bent_blade };

/// A body and what passes through it, by how much of a cube a step.
struct Case {
  Patient patient;
  std::size_t n_planes;
  Stroking stroking;
  double speed;
};

Case make_case(const geometry::TriangleMesh& mesh, const Tool tool, const unsigned seed) {
  Random random(seed);
  const double h = 1 / uniform(random, 8, 14);
  Patient patient(support::embedded(mesh, h, support::random_offset(random)));
  Planes planes;
  for (int i = 0; i <= (tool == Tool::blades ? static_cast<int>(seed % 3) : 0); ++i) {
    const Vec3 normal = random_direction(random);
    planes.push_back({normal, normal.dot(mesh.vertices[random() % mesh.vertices.size()] * 0.7 +
                                         0.3 * mesh.vertices[random() % mesh.vertices.size()])});
  }
  const Vec3 middle = Vec3::Constant(0.5);
  const double speed = std::array{0.05, 0.7, 10.0}[seed / 3 % 3];
  return {std::move(patient), planes.size(),
          tool == Tool::blades     ? straight_blades(planes, middle, random)
          : tool == Tool::scissors ? closing_scissors(planes[0], middle, random)
                                   : bent_blade(planes[0], middle, random),
          speed};
}

/// Bodies of 8 to 14 cubes, blades that advance by .05 to 10 cubes a step, one to three at once. One leaves all pieces
/// from 1e-3 cubes on, and so do scissors; a bent one those from a tenth of a cube on, as its bend may pass between two
/// smaller ones within a cell. Several, in planes that cross, may leave a splinter more or less where a cell is in all
/// of them, since a segment keeps its first cut, and more than one where a wedge is thinner than a cube: they leave all
/// pieces from half a cube on, and seldom another one.
void stroke(const geometry::TriangleMesh& mesh, const std::string& name, const Tool tool, const unsigned seed,
            Counted& counted) {
  Case of_seed = make_case(mesh, tool, seed);
  auto& [patient, n_planes, stroking, speed] = of_seed;
  const double h = patient.body.grid.h();
  if (grid::n_pieces(patient.body.complex) != 1)
    return;
  const geometry::TriangleMesh skin = skin_of(patient);
  pass_all(patient, stroking.blades, speed);
  counted.least.look_at(patient.body);
  const double cube = h * h * h, least = (n_planes > 1 ? 0.5 : tool == Tool::bent_blade ? 0.1 : 1e-3) * cube;
  const auto ours = patient.volumes();
  const auto theirs = stroking.leaves(skin);
  if (!theirs) {
    ++counted.n_unknown;
    return;
  }
  ++counted.n_strokes;
  counted.n_pieces += static_cast<int>(n_above(*theirs, least));
  const bool fewer = has_more(*theirs, ours, least), more = has_more(ours, *theirs, least);
  counted.n_fewer += fewer;
  counted.n_more += more;
  if (!fewer && !more)
    return;
  std::cout << name << ", seed " << seed << ", " << stroking.blades.size() << " blades, " << speed
            << " cubes a step: " << n_above(ours, least) << " pieces for " << n_above(*theirs, least)
            << "; the smallest [cubes]";
  for (const auto* volumes : {&ours, &*theirs})
    for (std::size_t i = 0; i < std::min<std::size_t>(4, volumes->size()); ++i)
      std::cout << (i == 0 ? " | " : " ") << (*volumes)[i] / cube;
  std::cout << std::endl;
}

/// A tip of the wedge between two of three blades, without material, is parted from the wedge by one of them and from
/// the next piece by the other: it hangs on the wedge, on whose side of all cuts it lies, and not on both.
TEST(ThreeBlades, LeaveNoBridgeAtATip) {
  const auto liver = unit_mesh(support::checkout() + "/params/meshes/liver_25k.off");
  ASSERT_TRUE(liver);
  auto [patient, n_planes, stroking, speed] = make_case(*liver, Tool::blades, 173);
  pass_all(patient, stroking.blades, 0.35);
  EXPECT_EQ(patient.volumes().size(), 6u);
}

/// A point of the skin was left whole as a tip (cut/shreds.h) when one blade had passed it, and hung on one piece; with
/// the others it lies on the side of another, to which it also belongs in the next cell.
TEST(ThreeBlades, LeaveNoBridgeByATipThatWasLeftWhole) {
  const auto pear = unit_mesh(support::checkout() + "/params/meshes/pear.off");
  ASSERT_TRUE(pear);
  auto [patient, n_planes, stroking, speed] = make_case(*pear, Tool::blades, 20);
  pass_all(patient, stroking.blades, speed);
  EXPECT_EQ(patient.volumes().size(), 6u);
}

/// Two walls that meet at a hollow edge.
geometry::TriangleMesh angle_mesh() {
  const std::array<std::array<double, 2>, 6> profile{{{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}}};
  geometry::TriangleMesh mesh;
  for (const double y : {0.0, 1.0})
    for (const auto& [x, z] : profile)
      mesh.vertices.emplace_back(x, y, z);
  for (const std::array<std::uint32_t, 3>& t : {std::array{3u, 4u, 5u}, {3u, 5u, 0u}, {3u, 0u, 1u}, {3u, 1u, 2u}}) {
    mesh.triangles.push_back({t[0], t[1], t[2]});
    mesh.triangles.push_back({t[0] + 6, t[2] + 6, t[1] + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t next = (i + 1) % 6;
    mesh.triangles.push_back({i, i + 6, next});
    mesh.triangles.push_back({next, i + 6, next + 6});
  }
  return mesh;
}

/// Where the wedge between two blades leaves a tip on each side of a hollow edge, these are not one.
TEST(ThreeBlades, LeaveNoBridgeOverAHollow) {
  Counted counted;
  for (const unsigned seed : {32, 34, 43}) // 32 leaves such tips
    stroke(angle_mesh(), "angle", Tool::blades, seed, counted);
  EXPECT_EQ(counted.n_strokes, 3);
  EXPECT_EQ(counted.n_fewer, 0);
}

/// Two blades come through a cube in one step; one passes just below an edge, whose tips stay on the body. Where the
/// other one has crossed the same segments, it parts them.
TEST(SeveralBlades, PartWhatTipsOfAnotherStayOn) {
  const auto cube = unit_mesh(support::checkout() + "/params/meshes/cube.off");
  ASSERT_TRUE(cube);
  auto [patient, n_planes, stroking, speed] = make_case(*cube, Tool::blades, 1033);
  pass_all(patient, stroking.blades, 10);
  EXPECT_EQ(patient.volumes().size(), 2u);
  EXPECT_GT(patient.body.cuts.n_left_whole(), 0u);
}

/// Pieces of as many nodes as a cube has.
int n_large(const grid::CellComplex& complex) {
  const std::vector<std::uint32_t> piece = grid::corner_pieces(complex);
  std::map<std::uint32_t, int> n_nodes;
  for (const grid::CornerId real : complex.real_corner)
    if (real.valid())
      ++n_nodes[piece[real.value]];
  return static_cast<int>(std::ranges::count_if(n_nodes, [](const auto& one) { return one.second >= 8; }));
}

/// How often two or three blades on their way through a box at once leave fewer large pieces than there were a step
/// before. Their planes are tilted against each other: 0, not at all; 1, up to a right angle.
int n_joined_again(const double tilt, const unsigned n_seeds) {
  int n_joined = 0, n_parted = 0;
  for (unsigned seed = 0; seed < n_seeds; ++seed) {
    Random random(seed);
    Patient patient(box_body(random));
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    Planes planes;
    for (unsigned i = 0; i < 2 + seed % 2; ++i) {
      const Vec3 normal = (Vec3::UnitX() + tilt * random_direction(random)).normalized();
      planes.push_back({normal, normal.dot(middle) + uniform(random, -0.1, 0.1)});
    }
    std::vector<Blade> blades = straight_blades(planes, middle, random).blades;
    for (Blade& blade : blades)
      blade.key_frames[0].time = uniform(random, 0, 0.3);
    Cutter cutter = patient.cutter(static_cast<grid::CutLabel>(blades.size()));
    constexpr int n_steps = 60;
    int before = 1;
    for (int k = 0; k <= n_steps || cutter.n_waiting() > 0; ++k) {
      patient.follow(cutter.step(patient.body, blades, double(k) / n_steps, double(k + 1) / n_steps, patient.x));
      const int now = n_large(patient.body.complex);
      n_joined += now < before ? 1 : 0;
      n_parted += now > before ? 1 : 0;
      before = now;
    }
  }
  EXPECT_GT(n_parted, static_cast<int>(n_seeds));
  return n_joined;
}

/// What one blade has parted stays so when others come that are not through yet. Where they cross, a wedge between them
/// that is thinner than a cube may part a step too early, and hang together for another one: 3 times in 300 of these.
TEST(SeveralBlades, JoinNothingThatOneHasParted) {
  EXPECT_EQ(n_joined_again(0, 60), 0);
  EXPECT_LE(n_joined_again(1, 120), 3);
}

Counted strokes(const std::filesystem::path& folder, const Tool tool, const unsigned n) {
  Counted counted;
  const auto solids = unit_solids(folder);
  for (unsigned seed = 0; seed < n; ++seed) {
    const auto& [name, mesh] = solids[seed % solids.size()];
    stroke(mesh, name, tool, seed, counted);
  }
  std::cout << counted.n_strokes << " strokes through " << solids.size() << " meshes, " << counted.n_pieces
            << " pieces; fewer than the Boolean after " << counted.n_fewer << ", more after " << counted.n_more
            << "; no Boolean for " << counted.n_unknown << '\n';
  return counted;
}

struct Series {
  Tool tool;
  unsigned n;
};

class Strokes : public testing::TestWithParam<Series> {};

TEST_P(Strokes, LeaveThePiecesOfTheBoolean) {
  const auto& [tool, n] = GetParam();
  const Counted counted = strokes(folder_of_meshes(), tool, n);
  EXPECT_GT(counted.n_strokes, 0.3 * n);
  EXPECT_GT(counted.n_pieces, (tool == Tool::blades ? 2 : 1.5) * counted.n_strokes);
  EXPECT_EQ(counted.n_fewer, 0);
  EXPECT_LE(counted.n_more, counted.n_strokes / 100);
  std::cout << counted.least << '\n';
  EXPECT_GT(counted.least.of_copies, -round_off);
  EXPECT_GT(counted.least.at_corners, -round_off);
  EXPECT_GE(counted.least.of_squares, least_square);
}

/// Slow, by steps of the size of a cube, and fast: the same pieces. Where several blades cross, each segment is cut by
/// the one that comes first, so that pieces may have some more or less of each other, by up to some cubes in all.
TEST_P(Strokes, LeaveTheSamePiecesAtAnySpeed) {
  const auto& [tool, n] = GetParam();
  const auto solids = unit_solids(folder_of_meshes());
  int n_bodies = 0, n_other = 0;
  double most = 0; // [cubes]
  for (unsigned seed = 1000; seed < 1000 + n / 2; ++seed) {
    const auto& [name, mesh] = solids[seed % solids.size()];
    const Case of_seed = make_case(mesh, tool, seed);
    const double h = of_seed.patient.body.grid.h(), cube = h * h * h;
    const double least = (of_seed.n_planes > 1 ? 0.5 : tool == Tool::bent_blade ? 0.1 : 1e-3) * cube;
    std::vector<std::vector<double>> volumes; // by speed
    for (const double speed : {0.07, 0.9, 10.0}) {
      Patient patient = of_seed.patient;
      pass_all(patient, of_seed.stroking.blades, speed);
      volumes.push_back(patient.volumes());
    }
    ++n_bodies;
    for (const auto& at_speed : volumes) {
      const bool is_other = at_speed.size() != volumes[0].size() &&
                            (has_more(at_speed, volumes[0], least) || has_more(volumes[0], at_speed, least));
      n_other += is_other;
      if (is_other)
        std::cout << name << ", seed " << seed << ": " << n_above(at_speed, least) << " pieces for "
                  << n_above(volumes[0], least) << '\n';
      for (std::size_t i = 0; i < at_speed.size() && at_speed.size() == volumes[0].size(); ++i)
        most = std::max(most, std::abs(at_speed[i] - volumes[0][i]) / cube);
    }
  }
  std::cout << n_bodies << " strokes at three speeds, " << n_other << " with other pieces; volumes differ by at most "
            << most << " cubes\n";
  EXPECT_EQ(n_other, 0);
}

std::string name_of(const testing::TestParamInfo<Series>& series) {
  constexpr std::array names = {"blades", "scissors", "bent_blade"};
  return names[static_cast<std::size_t>(series.param.tool)];
}

INSTANTIATE_TEST_SUITE_P(Short, Strokes,
                         testing::Values(Series{Tool::blades, 8}, Series{Tool::scissors, 12},
                                         Series{Tool::bent_blade, 4}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Long, Strokes,
                         testing::Values(Series{Tool::blades, 700}, Series{Tool::scissors, 200},
                                         Series{Tool::bent_blade, 200}),
                         name_of);

} // namespace
} // namespace kerf::cut::strokes_test
