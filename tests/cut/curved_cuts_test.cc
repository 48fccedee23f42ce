/// Curved cuts through bodies of any skin: how far the vertices of a cut lie off the surface that cuts. The long test
/// takes all closed meshes of the folder that KERF_STROKE_MESHES names:
///
///   KERF_STROKE_MESHES=folder ./kerf test -L long -R CurvedCuts

#include "tests/cut/least_material.h"
#include "tests/cut/patient.h"
#include "tests/cut/unit_solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iostream>

namespace kerf::cut::curved_cuts_test {
namespace {

struct Tally {
  std::vector<double> off; ///< of vertices of cuts [h]
  LeastMaterial least;

  /// `distance`: of a point from the surface that cuts [m].
  void add(const Patient& patient, const std::function<double(const Vec3&)>& distance) {
    const surface::Surface surface = surface::build_surface(patient.body);
    std::vector<std::uint8_t> is_of_cut(surface.rest.size(), 0);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      for (const auto v : surface.triangles[t])
        is_of_cut[v] |= surface.labels[t] != grid::skin_label;
    for (std::size_t v = 0; v < surface.rest.size(); ++v)
      if (is_of_cut[v])
        off.push_back(distance(surface.rest[v]) / patient.body.grid.h());
    least.look_at(patient.body);
  }
  double part_beyond(const double d) const {
    return static_cast<double>(std::ranges::count_if(off, [&](const double of) { return of > d; })) /
           static_cast<double>(off.size());
  }
  void say(const char* const what) const {
    std::cout << what << ": " << off.size() << " vertices, beyond .05, .15, .4 h " << 100 * part_beyond(0.05) << ", "
              << 100 * part_beyond(0.15) << ", " << 100 * part_beyond(0.4) << " %, at most "
              << *std::ranges::max_element(off) << "; " << least << std::endl;
  }
};

/// In the unit cube, of 10 to 20 cubes.
std::optional<Patient> some_patient(const geometry::TriangleMesh& mesh, Random& random) {
  try {
    Patient patient(support::embedded(mesh, 1 / uniform(random, 10, 20), random_offset(random)));
    if (grid::n_pieces(patient.body.complex) == 1)
      return patient;
  } catch (const DataError&) { // it is thinner than a cube
  }
  return std::nullopt;
}

/// A point of the mesh or between two.
Vec3 somewhere(const geometry::TriangleMesh& mesh, Random& random) {
  return 0.6 * mesh.vertices[random() % mesh.vertices.size()] + 0.4 * mesh.vertices[random() % mesh.vertices.size()];
}

/// While vertices that did not see all around them left the sheet for anywhere, .3 % of them lay up to 1.1 h off.
class CurvedCuts : public testing::TestWithParam<int> {};

TEST_P(CurvedCuts, LieOnTheirSurfaces) {
  Tally spheres, blades;
  for (const auto& [name, mesh] : unit_solids(folder_of_meshes()))
    for (int i = 0; i < GetParam(); ++i) {
      Random random(static_cast<unsigned>(100 + i));
      if (auto patient = some_patient(mesh, random)) {
        const Sphere sphere{somewhere(mesh, random), uniform(random, 0.15, 0.4)};
        patient->cut_through(sphere);
        spheres.add(*patient, [&](const Vec3& p) { return std::abs((p - sphere.centre).norm() - sphere.radius); });
      }
      if (auto patient = some_patient(mesh, random)) { // an edge along an axis on which it turns: a cylinder
        const Vec3 through = somewhere(mesh, random), axis = random_direction(random), to_edge = axis.unitOrthogonal();
        const double radius = uniform(random, 0.25, 0.6);
        const Vec3 centre = through - radius * to_edge;
        const Blade blade{.name = "blade",
                          .edge = {-3 * axis + radius * to_edge, 3 * axis + radius * to_edge},
                          .key_frames = {{0, centre, -170 * axis}, {0.5, centre, Vec3::Zero()}, {1, centre, 170 * axis}}};
        patient->pass(blade, 100, Release::queued);
        blades.add(*patient, [&](const Vec3& p) {
          const Vec3 d = p - centre;
          return std::abs((d - d.dot(axis) * axis).norm() - radius);
        });
      }
    }
  spheres.say("spheres");
  blades.say("blades");
  EXPECT_LT(spheres.part_beyond(0.4), 5e-4); // of 1.5 to 8 cubes a radius, which bend by up to .3 cubes within a cell
  EXPECT_LT(spheres.part_beyond(0.15), 5e-3);
  EXPECT_LT(blades.part_beyond(0.15), 1e-3);
  for (const Tally* tally : {&spheres, &blades}) {
    EXPECT_GE(tally->least.of_copies, -round_off);
    EXPECT_GE(tally->least.at_corners, -round_off);
    EXPECT_GE(tally->least.of_squares, least_square);
  }
}
INSTANTIATE_TEST_SUITE_P(Short, CurvedCuts, testing::Values(3));
INSTANTIATE_TEST_SUITE_P(Long, CurvedCuts, testing::Values(5));

} // namespace
} // namespace kerf::cut::curved_cuts_test
