// A blade that passes through a body which sags and swings as its physics moves it leaves no crumb that the stroke,
// pulled back to rest, did not cut free. The long test takes more bodies, and all closed meshes of the folder that
// KERF_STROKE_MESHES names:
//
//   KERF_STROKE_MESHES=folder ./kerf test -L long -R SwingingScenes

#include "scene/run.h"
#include "tests/cut/fine_pieces.h"
#include "tests/cut/unit_solids.h"
#include "tests/scene/worlds.h"
#include "tests/support/bodies.h"

#include <gtest/gtest.h>

#include <sstream>

namespace kerf::scene::swinging_scenes_test {
namespace {

using cut::PiecesAndFine;
using support::Random;
using support::uniform;

constexpr double size = 0.3, dt = 1.0 / 120; // [m], [s]

std::string text_of(const Vec3& p) {
  std::ostringstream text;
  text << p[0] << ", " << p[1] << ", " << p[2];
  return text.str();
}

/// A soft body hangs by what is highest of it, and a blade crosses it in a plane through its middle somewhere.
std::string scene_of(const std::filesystem::path& mesh_file, const Box& box, Random& random) {
  const Vec3 extent = box.upper - box.lower, middle = 0.5 * (box.lower + box.upper),
             normal = support::random_direction(random), along = normal.unitOrthogonal(),
             through = middle + 0.25 * extent.cwiseProduct(Vec3(uniform(random, -1, 1), uniform(random, -1, 1),
                                                                uniform(random, -1, 1)));
  const double turn = uniform(random, 0, 6.3), unit = size / extent.maxCoeff(), duration = uniform(random, 0.1, 0.6),
               h = size / uniform(random, 11, 16);
  const Vec3 edge = std::cos(turn) * along + std::sin(turn) * normal.cross(along), way = normal.cross(edge),
             start = unit * through - 0.45 * way;
  std::ostringstream text;
  text.precision(12);
  text << "subsection Time\n set Time step [s] = " << dt << "\n set End time [s] = " << duration + 0.1
       << "\nend\nsubsection Gravity\n set Acceleration [m/s^2] = 0, 0, -9.81\nend\nsubsection Body b\n set Mesh = "
       << mesh_file.string() << "\n set Mesh unit [m] = " << unit << "\n set Cube edge [m] = " << h
       << "\n set Backend = " << (random() % 3 == 0 ? "mass-spring" : "fem")
       << "\n subsection Material\n  set Density [kg/m^3] = 1000\n  set Young's modulus [Pa] = "
       << std::exp(uniform(random, std::log(2e4), std::log(2e5)))
       << "\n end\n subsection Support top\n  set Lower [m] = -9, -9, " << unit * (box.upper[2] - 0.15 * extent[2])
       << "\n  set Upper [m] = 9, 9, 9\n end\nend\nsubsection Blade k\n set Edge [m] = "
       << text_of(start - 0.5 * edge) << "; " << text_of(start + 0.5 * edge) << "\n set Times [s] = 0, " << duration
       << "\n set Positions [m] = 0, 0, 0; " << text_of(0.9 * way) << "\nend\n";
  return text.str();
}

/// Cells that may have several copies, or material that has come to another one.
std::vector<grid::CellId> cells_with_cuts(const grid::Solid& solid) {
  std::vector<grid::CellId> cells;
  for (const auto c : ids<grid::CellId>(solid.grid.n_cells()))
    if (grid::cuts_of(solid, c).blades != 0 || solid.cuts.front(c) != nullptr)
      cells.push_back(c);
  return cells;
}

/// Nothing where the grid's body is not in one piece, hangs on nothing, or a step is refused.
std::optional<PiecesAndFine> cut_while_it_swings(const std::filesystem::path& mesh_file, const unsigned seed,
                                                 const int n_fine) {
  Random random(seed);
  const geometry::TriangleMesh mesh = geometry::read_mesh(mesh_file, 1);
  std::optional<World> world;
  try {
    world = world_of(scene_of(mesh_file, geometry::box_around(mesh.vertices), random));
  } catch (const ParameterError&) {
    return std::nullopt;
  }
  Body& body = world->bodies[0];
  if (grid::n_pieces(body.solid.complex) != 1)
    return std::nullopt;
  support::FineMaterial fine(body.solid, n_fine);
  Timings seconds;
  try {
    for (int k = 0; k < world->n_steps || body.cutter->n_waiting() > 0; ++k) {
      body.report = body.physics->step(body.state, body.loads, dt);
      follow(body);
      const double t0 = k * dt, t1 = (k + 1) * dt;
      for (const cut::BladePath& path : cut::paths(world->blades[0], t0, t1))
        fine.cut(body.solid, {path}, body.cutter->stands_at(), corners(body));
      const int n_recuts = body.n_recuts;
      recut(body, world->blades, t0, t1, seconds);
      if (body.n_recuts != n_recuts)
        fine.follow(body.solid, cells_with_cuts(body.solid));
    }
  } catch (const NumericalError&) {
    return std::nullopt;
  }
  return cut::pieces_and_fine(body.solid, fine);
}

class SwingingScenes : public testing::TestWithParam<unsigned> {};

TEST_P(SwingingScenes, LeaveNoCrumbThatTheStrokeDidNotCutFree) {
  std::vector<std::filesystem::path> files;
  for (const auto& file : cut::meshes(cut::folder_of_meshes()))
    if (cut::unit_mesh(file))
      files.push_back(file);
  cut::TallyOfPieces tally;
  for (unsigned seed = 0; seed < GetParam(); ++seed) {
    const auto& file = files[seed % files.size()];
    const auto pieces =
      cut::judged_finely(5, [&](const int n_fine) { return cut_while_it_swings(file, seed, n_fine); });
    if (pieces)
      tally.add(*pieces, file.stem().string(), seed);
  }
  tally.expect_sound();
}
INSTANTIATE_TEST_SUITE_P(Short, SwingingScenes, testing::Values(8));
INSTANTIATE_TEST_SUITE_P(Long, SwingingScenes, testing::Values(200));

} // namespace
} // namespace kerf::scene::swinging_scenes_test
