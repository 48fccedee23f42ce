/// Splinters are held (crossing_cuts_test.cc), and nothing else is.

#include "tests/cut/boolean.h"
#include "tests/cut/patient.h"

#include <gtest/gtest.h>

namespace kerf::cut::splinters_test {
namespace {

/// What two planes leave of a box's corner, with less than a cube, is a piece by itself: nothing else lies between the
/// same cuts.
TEST(Splinters, AreNotWhatIsSmallByItself) {
  Random random(116);
  int n_bodies = 0;
  while (n_bodies < 60) {
    const Vec3 through = box.lower + h * (0.75 * Vec3::Ones() + 0.7 * support::random_vector(random));
    std::vector<support::Plane> planes;
    for (const Vec3& normal : {random_direction(random), random_direction(random)})
      planes.push_back({normal, normal.dot(through)});
    const auto exact = volumes_between(geometry::box_mesh(box.lower, box.upper), planes);
    if (std::abs(planes[0].normal.dot(planes[1].normal)) > 0.9 || !exact || exact->size() != 4 ||
        exact->front() < 0.05 * cube || exact->front() > 0.9 * cube)
      continue;
    Patient patient(box_body(random));
    for (const int k : {0, 1})
      patient.cut_through(Plane{through, planes[k].normal}, static_cast<grid::CutLabel>(k + 1));
    EXPECT_EQ(patient.volumes().size(), 4u) << n_bodies << ", " << exact->front() / cube << " h^3";
    ++n_bodies;
  }
}

} // namespace
} // namespace kerf::cut::splinters_test
