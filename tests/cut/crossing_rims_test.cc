/// Planes that cross in a box, both along the grid: their rims cross where planes and skin do (surface/crossing.h).

#include "tests/cut/patient.h"
#include "tests/support/cut_by_plane.h"

#include <gtest/gtest.h>

#include <array>
#include <iostream>

namespace kerf::cut::crossing_rims_test {
namespace {

/// How far a vertex of a plane's cut is from it, at most [h].
double off_plane(const surface::Surface& surface, const Plane& plane, const grid::CutLabel label) {
  double off = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.labels[t] == label)
      for (const auto v : surface.triangles[t])
        off = std::max(off, std::abs(plane.normal.dot(surface.rest[v] - plane.point)) / h);
  return off;
}

double least_area(const surface::Surface& surface) {
  double least = h * h;
  for (const auto& [a, b, c] : surface.triangles)
    least = std::min(
      least, 0.5 * (surface.rest[b] - surface.rest[a]).cross(surface.rest[c] - surface.rest[a]).norm());
  return least / (h * h);
}

/// What two planes along axes leave of the box, ascending [m^3].
std::vector<double> quarters(const std::array<Plane, 2>& planes) {
  std::vector<double> volumes = {box_volume};
  for (const Plane& plane : planes) {
    Eigen::Index axis = 0;
    plane.normal.cwiseAbs().maxCoeff(&axis);
    const double part = (plane.point[axis] - box.lower[axis]) / (box.upper - box.lower)[axis];
    std::vector<double> parts;
    for (const double volume : volumes) {
      parts.push_back(part * volume);
      parts.push_back((1 - part) * volume);
    }
    volumes = parts;
  }
  std::ranges::sort(volumes);
  return volumes;
}

TEST(CrossingRims, OfPlanesAlongTheGridLieInThem) {
  constexpr int n = 60;
  Random random(411);
  double off = 0, area = 1, volume = 0;
  std::size_t n_moved = 0;
  for (int i = 0; i < n; ++i) {
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    const int first = i % 3, second = (first + 1 + i / 3 % 2) % 3;
    const std::array<Plane, 2> planes = {Plane{middle + 0.12 * support::random_vector(random), Vec3::Unit(first)},
                                         Plane{middle + 0.12 * support::random_vector(random), Vec3::Unit(second)}};
    Patient patient(box_body(random));
    const bool is_by_blades = i % 4 == 0;
    for (int k = 0; k < 2; ++k) {
      const auto label = static_cast<grid::CutLabel>(k + 1);
      const Frame frame = across(planes[k].normal, uniform(random, 0, 6.3));
      if (is_by_blades)
        patient.pass(straight(planes[k].point, frame.u, frame.v, 2, 2, label), steps(i / 4), Release::queued);
      else
        patient.cut_through(planes[k], label);
    }
    const surface::Surface surface = surface::build_surface(patient.body);
    for (int k = 0; k < 2; ++k)
      off = std::max(off, off_plane(surface, planes[k], static_cast<grid::CutLabel>(k + 1)));
    area = std::min(area, least_area(surface));
    const std::vector<double> volumes = patient.volumes(), exact = quarters(planes);
    ASSERT_EQ(volumes.size(), exact.size()) << i;
    volume = std::max(volume, largest_difference(volumes, exact) / cube);
    EXPECT_TRUE(patient.is_as_built()) << i;
    n_moved += static_cast<std::size_t>(std::ranges::count_if(
      patient.body.cuts.skin_cuts(), [](const grid::SkinCut& cut) { return !cut.aside.isZero(0); }));
  }
  std::cout << n << " boxes: vertices at most " << off << " h off their plane, pieces " << volume
            << " h^3 off, the least triangle " << area << " h^2; " << n_moved << " vertices of spokes moved\n";
  EXPECT_GT(n_moved, 20u);
  EXPECT_LT(off, 1e-6);
  EXPECT_LT(volume, 1e-5);
  EXPECT_GT(area, 0);
}

} // namespace
} // namespace kerf::cut::crossing_rims_test
