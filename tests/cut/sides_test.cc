/// The volumes on both sides of a plane that cuts a body converge with order 2 to those of the exact Boolean of the
/// mesh that was read, whatever the grid makes of its skin. The long test takes all closed meshes of the folder that
/// KERF_STROKE_MESHES names:
///
///   KERF_STROKE_MESHES=folder ./kerf test -L long -R Sides

#include "tests/cut/boolean.h"
#include "tests/cut/unit_solids.h"
#include "tests/support/cut_by_plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

namespace kerf::cut::sides_test {
namespace {

/// Root mean square over lattice offsets of the error on one side, and of that on the other; parts of the volume of
/// all.
double error(const geometry::TriangleMesh& mesh, const support::Plane& plane, const double below, const double all,
             const double h, support::Random& random) {
  constexpr int n_offsets = 6;
  double sum = 0;
  for (int i = 0; i < n_offsets; ++i) {
    support::Body body = support::embedded(mesh, h, support::random_offset(random));
    support::cut_through(body, support::cuts_of_plane(body, plane));
    const double ours = support::volume_below(body, plane), above = support::surface_volume(body) - ours;
    sum += std::pow(ours - below, 2) + std::pow(above - (all - below), 2);
  }
  return std::sqrt(sum / (2 * n_offsets)) / all;
}

/// Of the line through log(error) over log(h), by least squares.
double slope(const std::vector<double>& h, const std::vector<double>& errors) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double a = std::log(h[i]), b = std::log(errors[i]);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

class Sides : public testing::TestWithParam<std::vector<double>> {};

TEST_P(Sides, ConvergeToTheBooleanOfTheMesh) {
  const std::vector<double> lengths = GetParam();
  std::vector<double> mean(lengths.size(), 0);
  int n = 0;
  for (const auto& [name, mesh] : unit_solids(folder_of_meshes())) {
    support::Random random(5);
    const Vec3 normal = support::random_direction(random);
    const support::Plane plane{normal, normal.dot(Vec3(mesh.vertices[7] + mesh.vertices[mesh.vertices.size() / 2]) / 2)};
    const auto below = volume_below(mesh, plane);
    if (!below)
      continue;
    const double all = geometry::volume(mesh);
    std::vector<double> errors;
    for (const double h : lengths)
      errors.push_back(error(mesh, plane, *below, all, h, random));
    std::cout << name << ": part below " << *below / all << ", errors";
    for (const double e : errors)
      std::cout << ' ' << e;
    std::cout << ", order " << slope(lengths, errors) << std::endl;
    if (errors.front() < 1e-10) // flat sides: exact
      continue;
    for (std::size_t i = 0; i < lengths.size(); ++i)
      mean[i] += std::log(errors[i]);
    ++n;
  }
  ASSERT_GT(n, 2);
  for (double& m : mean)
    m = std::exp(m / n);
  std::cout << "all: order " << slope(lengths, mean) << '\n';
  EXPECT_GT(slope(lengths, mean), 1.9);
}
INSTANTIATE_TEST_SUITE_P(Short, Sides, testing::Values(std::vector<double>{0.05, 0.025}));
INSTANTIATE_TEST_SUITE_P(Long, Sides, testing::Values(std::vector<double>{0.06, 0.03, 0.015, 0.0075}));

} // namespace
} // namespace kerf::cut::sides_test
