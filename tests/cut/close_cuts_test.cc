/// Cuts nearer to each other than a cube, of which an edge that both meet has the first alone: what that moves is told;
/// and cuts of several blades that come into a cell at once.

#include "tests/cut/cutting.h"
#include "tests/cut/patient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

namespace kerf::cut::close_cuts_test {
namespace {

double between(const Cutter& cutter) { return total(cutter.counts().between); }

/// Two parallel planes at a distance of g [h]: of the edges along axis i that meet one of them, a part 1 - g / |n_i|
/// meets both, and has g / |n_i| of itself between. With the weights n_i^2, that is this part of the slice, n_i^2 times.
TEST(CloseCuts, TellHowMuchMaterialANeighbourHasOfAnother) {
  Random random(141);
  double told = 0, meant = 0;
  for (int i = 0; i < 60; ++i) {
    const Body body = support::embedded(geometry::box_mesh(Vec3::Zero(), Vec3::Ones()), h, random_offset(random));
    const Vec3 n = random_direction(random), p = Vec3::Constant(0.5) + 0.05 * support::random_vector(random);
    const double g = uniform(random, 0.1, 1.3);
    Patient patient(body);
    Cutter cutter = patient.cutter(2);
    patient.follow(cutter.at_once(patient.body, {"", Plane{p, n}, 1}, patient.x));
    EXPECT_EQ(between(cutter), 0) << "one cut";
    patient.follow(cutter.at_once(patient.body, {"", Plane{p + g * h * n, n}, 2}, patient.x));
    Patient alone(body);
    alone.cut_through(Plane{p, n});
    Patient other(body);
    other.cut_through(Plane{p + g * h * n, n});
    const auto volume_below = [&](Patient& cut, const Vec3& at) {
      double sum = 0;
      const auto surface = surface::build_surface(cut.body);
      const grid::Pieces pieces = grid::pieces(cut.body.complex);
      const auto volumes = surface::piece_volumes(surface, cut.body.complex);
      std::vector<bool> is_below(volumes.size(), false);
      for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (const auto v : surface.triangles[t])
          if (n.dot(surface.rest[v] - at) < -1e-3 * h)
            is_below[pieces.piece[surface.copies[t]]] = true;
      for (std::size_t k = 0; k < volumes.size(); ++k)
        sum += is_below[k] ? volumes[k] : 0;
      return sum / cube;
    };
    const double slice = volume_below(other, p + g * h * n) - volume_below(alone, p);
    double part = 0;
    for (const double along : n.cwiseAbs())
      part += std::max(0.0, 1 - g / along) * along * along;
    EXPECT_NEAR(between(cutter), part * slice, 0.25 * slice + 1) << i;
    told += between(cutter);
    meant += part * slice;
  }
  std::cout << "between cuts: " << told << " cubes, by area and distance " << meant << '\n';
  EXPECT_NEAR(told, meant, 0.1 * meant);
}

/// It has no material to cut there.
TEST(CloseCuts, ABladeThatComesThroughAnOpenCutLeavesNothingBetween) {
  Random random(142);
  Patient patient(box_body(random));
  const Vec3 middle = 0.5 * (box.lower + box.upper), n = Vec3(1, 0.2, 0.1).normalized();
  Cutter cutter = patient.cutter(3);
  patient.follow(cutter.at_once(patient.body, {"", Plane{middle, n}, 1}, patient.x));
  const grid::Pieces pieces = grid::pieces(patient.body.complex);
  ASSERT_EQ(pieces.n_pieces, 2u);
  std::vector<bool> is_right(patient.x.size(), false);
  for (const auto c : ids<grid::CopyId>(patient.body.complex.n_copies()))
    for (const auto corner : patient.body.complex.copies[c].corners)
      is_right[corner.value] = pieces.piece[c] == 1;
  for (std::size_t i = 0; i < patient.x.size(); ++i)
    patient.x[i] += (is_right[i] ? 0.8 : -0.8) * h * n;
  cutter.stand(patient.x);
  for (const double at : {0.7, -0.7})
    patient.follow(
      cutter.at_once(patient.body, {"", Plane{middle + at * h * n, n}, at > 0 ? grid::CutLabel(2) : grid::CutLabel(3)},
                     patient.x));
  EXPECT_LT(between(cutter), 0.5) << "of edges across the opening";
  EXPECT_EQ(grid::n_pieces(patient.body.complex), 2u);
}

struct Beside {
  std::size_t n_vertices = 0, n_beside = 0, n_without_area = 0, n_triangles = 0;
  double worst = 0; ///< [h]
};

/// Vertices of cuts that lie on neither plane, and triangles without area.
void look(const Patient& patient, const std::vector<support::Plane>& planes, Beside& result) {
  const auto surface = surface::build_surface(patient.body);
  std::vector<bool> is_of_cut(surface.rest.size(), false);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const double area = (surface.rest[b] - surface.rest[a]).cross(surface.rest[c] - surface.rest[a]).norm() / 2;
    ++result.n_triangles;
    result.n_without_area += area < 1e-12 * h * h;
    if (surface.labels[t] != grid::skin_label)
      for (const auto v : surface.triangles[t])
        is_of_cut[v] = true;
  }
  for (std::size_t v = 0; v < surface.rest.size(); ++v) {
    if (!is_of_cut[v])
      continue;
    double distance = 1e300;
    for (const support::Plane& plane : planes)
      distance = std::min(distance, std::abs(plane.height(surface.rest[v])) / h);
    ++result.n_vertices;
    result.n_beside += distance > 1e-6;
    result.worst = std::max(result.worst, distance);
  }
}

void print(const char* what, const Beside& b) {
  std::cout << what << ": " << b.n_vertices << " vertices of cuts, " << b.n_beside << " on no plane, by at most "
            << b.worst << " h; " << b.n_triangles << " triangles, " << b.n_without_area << " without area\n";
}

TEST(CloseCuts, OfBladesThatMoveTogetherLieOnOneOfTheirPlanes) {
  Random random(143);
  Beside together, one_by_one;
  for (int i = 0; i < 60; ++i) {
    const Vec3 middle = 0.5 * (box.lower + box.upper) + 0.05 * support::random_vector(random);
    std::vector<support::Plane> planes;
    std::vector<Blade> blades;
    for (grid::CutLabel label = 1; label <= 2 + i % 2; ++label) {
      const Vec3 n = random_direction(random);
      const Frame frame = across(n, uniform(random, 0, 6.3));
      planes.push_back({n, n.dot(middle)});
      blades.push_back(straight(middle, frame.u, frame.v, 2, 2, label));
    }
    Patient patient(box_body(random)), by_turns(patient.body);
    Cutter cutter = patient.cutter(3);
    const int n_steps = steps(i);
    for (int k = 0; k <= n_steps || cutter.n_waiting() > 0; ++k)
      patient.follow(cutter.step(patient.body, blades, double(k) / n_steps, double(k + 1) / n_steps, patient.x));
    look(patient, planes, together);
    for (grid::CutLabel label = 1; label <= planes.size(); ++label)
      by_turns.cut_through(Plane{middle, planes[label - 1].normal}, label);
    look(by_turns, planes, one_by_one);
  }
  print("together", together);
  print("one by one", one_by_one);
  for (const Beside& b : {together, one_by_one})
    EXPECT_EQ(b.n_without_area, 0u);
  EXPECT_EQ(one_by_one.n_beside, 0u);
  EXPECT_LT(static_cast<double>(together.n_beside), 0.003 * static_cast<double>(together.n_vertices))
    << "where the skin holds a vertex back";
}

} // namespace
} // namespace kerf::cut::close_cuts_test
