/// A blade that saws its way through a body that sags and swings leaves no crumb that the stroke, pulled back to rest,
/// did not cut free, and parts the body as that does. The long test takes more bodies, and all closed meshes of the
/// folder that KERF_STROKE_MESHES names:
///
///   KERF_STROKE_MESHES=folder ./kerf test -L long -R Swing

#include "tests/cut/fine_pieces.h"
#include "tests/cut/patient.h"
#include "tests/cut/unit_solids.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kerf::cut::swing_test {
namespace {

constexpr int n_strokes = 6, n_steps = 40 * n_strokes;

/// Turns to and fro, and bends: time from 0 to 1.
struct Swing {
  Vec3 middle, axis, along, sag;
  double angle, frequency, phase;

  Vec3 operator()(const Vec3& p, const double time) const {
    const double wave = std::sin(2 * std::numbers::pi * frequency * time + phase), arm = along.dot(p - middle);
    return middle + Eigen::AngleAxisd(angle * wave, axis) * (p - middle) + arm * arm * (time + 0.5 * wave) * sag;
  }
};

Swing random_swing(Random& random, const double h) {
  Swing swing{Vec3::Constant(0.5), random_direction(random), random_direction(random), {}, {}, {}, {}};
  swing.angle = uniform(random, 0, 2 * h);
  swing.sag = uniform(random, 0, 2 * h) * random_direction(random);
  swing.frequency = uniform(random, 1, 12);
  swing.phase = uniform(random, 0, 6);
  return swing;
}

/// Saws forth and back in a plane through the middle, deeper each time, with an edge that stands up from its tip.
Blade saw(const Vec3& middle, const Frame& frame) {
  Blade blade{.name = "saw", .edge = {Vec3::Zero(), -2.5 * frame.v - 0.4 * frame.u}, .key_frames = {}};
  for (int k = 0; k <= n_strokes; ++k) {
    const double side = k % 2 == 0 ? -1.2 : 1.2, depth = -0.9 + 1.9 * k / n_strokes;
    blade.key_frames.push_back({double(k) / n_strokes, middle + side * frame.u + depth * frame.v, Vec3::Zero()});
  }
  check(blade);
  return blade;
}

std::optional<PiecesAndFine> sawn(const geometry::TriangleMesh& mesh, const unsigned seed, const int n_fine) {
  Random random(seed);
  const double h = 1 / uniform(random, 7, 10);
  std::optional<Patient> whole;
  try {
    whole.emplace(support::embedded(mesh, h, random_offset(random)));
  } catch (const DataError&) { // it is thinner than a cube
    return std::nullopt;
  }
  Patient& patient = *whole;
  if (grid::n_pieces(patient.body.complex) != 1)
    return std::nullopt;
  support::FineMaterial fine(patient.body, n_fine);
  const Swing swing = random_swing(random, h);
  const Vec3 through = Vec3::Constant(0.5) + 0.15 * random_direction(random);
  const Blade blade = saw(through, across(random_direction(random), 0));
  const auto stand = [&](const double time) {
    for (const auto c : ids<grid::CornerId>(patient.body.complex.n_corners()))
      patient.x[c.value] = swing(patient.body.grid.position(patient.body.complex.node[c]), time);
  };
  stand(0);
  Cutter cutter = patient.cutter(1);
  for (int k = 0; k <= n_steps || cutter.n_waiting() > 0; ++k) {
    const double t0 = double(k) / n_steps, t1 = double(k + 1) / n_steps;
    stand(t1);
    fine.cut(patient.body, paths(blade, t0, t1), cutter.stands_at(), patient.x);
    grid::CutChange change = cutter.step(patient.body, std::span(&blade, 1), t0, t1, patient.x);
    patient.follow(change);
    fine.follow(patient.body, change.cells);
  }
  return pieces_and_fine(patient.body, fine);
}

class Swings : public testing::TestWithParam<unsigned> {};

TEST_P(Swings, LeaveNoCrumbThatTheStrokeDidNotCutFree) {
  const auto solids = unit_solids(folder_of_meshes());
  TallyOfPieces tally;
  for (unsigned seed = 0; seed < GetParam(); ++seed) {
    const auto& [name, mesh] = solids[seed % solids.size()];
    const auto pieces = judged_finely(6, [&](const int n_fine) { return sawn(mesh, seed, n_fine); });
    if (pieces)
      tally.add(*pieces, name, seed);
  }
  tally.expect_sound();
}
INSTANTIATE_TEST_SUITE_P(Short, Swings, testing::Values(6));
INSTANTIATE_TEST_SUITE_P(Long, Swings, testing::Values(100));

} // namespace
} // namespace kerf::cut::swing_test
