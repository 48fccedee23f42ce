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

/// Two planes at 3 degrees, then nicks far from their wedge that part nothing by themselves: no splinter comes free.
TEST(Splinters, StayHeldWhenSomethingElseIsCut) {
  Random random(117);
  const double angle = 3 * std::numbers::pi / 180;
  int n_nicks = 0;
  for (int i = 0; i < 90; ++i) {
    Patient patient(box_body(random));
    Cutter cutter = patient.cutter(7);
    const Vec3 through = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
    const Vec3 first = random_direction(random);
    const Vec3 second = std::cos(angle) * first + std::sin(angle) * across(first, uniform(random, 0, 6.3)).u;
    patient.follow(cutter.at_once(patient.body, {"first", Plane{through, first}, 1}, patient.x));
    patient.follow(cutter.at_once(patient.body, {"second", Plane{through, second}, 2}, patient.x));
    const std::size_t n_pieces = patient.volumes().size();
    for (grid::CutLabel label = 3; label < 8; ++label) {
      const Vec3 half = 0.5 * (box.upper - box.lower) - h * Vec3::Ones();
      Vec3 at;
      do
        at = 0.5 * (box.lower + box.upper) + half.cwiseProduct(support::random_vector(random));
      while (std::min(std::abs((at - through).dot(first)), std::abs((at - through).dot(second))) < 2 * h);
      grid::CutChange change =
        cutter.at_once(patient.body, {"nick", Disc{at, random_direction(random), 0.6 * h}, label}, patient.x);
      n_nicks += !change.edges.empty();
      patient.follow(change);
      EXPECT_EQ(patient.volumes().size(), n_pieces) << i << ", " << int(label);
    }
    EXPECT_TRUE(patient.is_as_built()) << i;
  }
  EXPECT_GT(n_nicks, 60);
}

} // namespace
} // namespace kerf::cut::splinters_test
