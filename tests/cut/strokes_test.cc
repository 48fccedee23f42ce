/// Strokes through bodies leave what exact Boolean operations leave: the same pieces, at any speed. The long test takes
/// 500 strokes, and all closed meshes of the folder that KERF_STROKE_MESHES names:
///
///   KERF_STROKE_MESHES=folder ./kerf test -L long -R Strokes

#include "tests/cut/boolean.h"
#include "tests/cut/patient.h"
#include "tests/cut/unit_solids.h"

#include <gtest/gtest.h>

#include <iostream>

namespace kerf::cut {
namespace {

geometry::TriangleMesh skin_of(const Patient& patient) {
  const surface::Surface surface = surface::build_surface(patient.body);
  return {surface.rest, surface.triangles};
}

struct Counted {
  int n_strokes = 0, n_pieces = 0, n_fewer = 0, n_more = 0;
  int n_unknown = 0; ///< the grid's skin intersects itself
};

auto n_above(const std::vector<double>& volumes, const double least) {
  return volumes.end() - std::upper_bound(volumes.begin(), volumes.end(), least);
}

/// Pieces above a volume that the first has and the second has not; what is within a factor of two of that does not
/// count.
bool has_more(const std::vector<double>& first, const std::vector<double>& second, const double least) {
  return n_above(first, 2 * least) > n_above(second, 0.5 * least);
}

/// Blades pass all at once, each in a plane, as far as the body reaches and beyond.
void pass_all(Patient& patient, const std::vector<support::Plane>& planes, const Vec3& middle, const double speed,
              Random& random) {
  std::vector<Blade> blades;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Frame frame = across(planes[i].normal, uniform(random, 0, 6.3));
    const Vec3 through = middle - planes[i].height(middle) * planes[i].normal;
    blades.push_back(straight(through, frame.u, frame.v, 1.5, 1.5, static_cast<grid::CutLabel>(i + 1)));
  }
  const int n_steps = std::max(1, static_cast<int>(3 / (speed * patient.body.grid.h())));
  Cutter cutter(static_cast<grid::CutLabel>(blades.size()));
  cutter.begin(patient.body, patient.x);
  for (int k = 0; k <= n_steps || cutter.n_waiting() > 0; ++k)
    patient.follow(cutter.step(patient.body, blades, double(k) / n_steps, double(k + 1) / n_steps, patient.x));
}

/// Bodies of 8 to 14 cubes, blades that advance by .05 to 10 cubes a step, one to three at once. One leaves all pieces
/// from 1e-3 cubes on. Several, in planes that cross, may leave a splinter more or less where a cell is in all of them,
/// since a segment keeps its first cut, and more than one where a wedge is thinner than a cube: they leave all pieces
/// from half a cube on, and seldom another one.
void stroke(const geometry::TriangleMesh& mesh, const std::string& name, const unsigned seed, Counted& counted) {
  Random random(seed);
  const double h = 1 / uniform(random, 8, 14);
  Patient patient(support::embedded(mesh, h, support::random_offset(random)));
  if (grid::n_pieces(patient.body.complex) != 1)
    return;
  const geometry::TriangleMesh skin = skin_of(patient);
  std::vector<support::Plane> planes;
  for (int i = 0; i <= static_cast<int>(seed % 3); ++i) {
    const Vec3 normal = random_direction(random);
    planes.push_back({normal, normal.dot(mesh.vertices[random() % mesh.vertices.size()] * 0.7 +
                                         0.3 * mesh.vertices[random() % mesh.vertices.size()])});
  }
  const double speed = std::array{0.05, 0.7, 10.0}[seed / 3 % 3];
  pass_all(patient, planes, Vec3::Constant(0.5), speed, random);
  const double cube = h * h * h, least = (planes.size() == 1 ? 1e-3 : 0.5) * cube;
  const auto ours = patient.volumes();
  const auto theirs = volumes_between(skin, planes);
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
  std::cout << name << ", seed " << seed << ", " << planes.size() << " blades, " << speed
            << " cubes a step: " << n_above(ours, least) << " pieces for " << n_above(*theirs, least)
            << "; the smallest [cubes]";
  for (const auto* volumes : {&ours, &*theirs})
    for (std::size_t i = 0; i < std::min<std::size_t>(4, volumes->size()); ++i)
      std::cout << (i == 0 ? " | " : " ") << (*volumes)[i] / cube;
  std::cout << std::endl;
}

Counted strokes(const std::filesystem::path& folder, const unsigned n) {
  Counted counted;
  const auto solids = unit_solids(folder);
  for (unsigned seed = 0; seed < n; ++seed) {
    const auto& [name, mesh] = solids[seed % solids.size()];
    stroke(mesh, name, seed, counted);
  }
  std::cout << counted.n_strokes << " strokes through " << solids.size() << " meshes, " << counted.n_pieces
            << " pieces; fewer than the Boolean after " << counted.n_fewer << ", more after " << counted.n_more
            << "; no Boolean for " << counted.n_unknown << '\n';
  return counted;
}

class Strokes : public testing::TestWithParam<unsigned> {};

TEST_P(Strokes, LeaveThePiecesOfTheBoolean) {
  const Counted counted = strokes(folder_of_meshes(), GetParam());
  EXPECT_GT(counted.n_strokes, 0.6 * GetParam());
  EXPECT_GT(counted.n_pieces, 2 * counted.n_strokes);
  EXPECT_EQ(counted.n_fewer, 0);
  EXPECT_LE(counted.n_more, counted.n_strokes / 100);
}
INSTANTIATE_TEST_SUITE_P(Short, Strokes, testing::Values(8));
INSTANTIATE_TEST_SUITE_P(Long, Strokes, testing::Values(700));

} // namespace
} // namespace kerf::cut
