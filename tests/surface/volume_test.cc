/// Volumes: by octants as by triangles, kept by cuts, of second order for curved skins. Plane cuts: plane_cut_test.cc.

#include "surface/surface.h"

#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <iostream>
#include <numbers>
#include <numeric>

namespace kerf::surface::volume_test {
namespace {

using grid::CellId;
using grid::EdgeCut;
using support::Body;
using support::Random;
using support::random_offset;
using support::uniform;

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<double> volumes_by_triangles(const Body& body) {
  const Body with_copies = support::with_copies(body);
  return piece_volumes(build_surface(with_copies), with_copies.complex);
}

/// Every octant tetrahedron is positive, whole cells are tiled, and both ways to a piece's volume agree.
void expect_tiled(const Body& body) {
  for (const auto c : ids<CellId>(body.grid.n_cells())) {
    double cell = 0;
    for (int v = 0; v < 8; ++v)
      for (const auto& t : grid::octant(body, c, v)) {
        ASSERT_GT(support::volume(t), 0);
        cell += support::volume(t);
      }
    ASSERT_NEAR(cell, 1, 1e-13);
  }
  const auto by_octants = support::octant_volumes(support::with_copies(body));
  const auto by_triangles = volumes_by_triangles(body);
  ASSERT_EQ(by_octants.size(), by_triangles.size());
  const double whole = sum(by_octants);
  for (std::size_t p = 0; p < by_octants.size(); ++p) {
    ASSERT_GT(by_octants[p], 0);
    ASSERT_NEAR(by_triangles[p], by_octants[p], 1e-12 * by_octants[p] + 1e-14 * whole);
  }
}

TEST(Volume, ByOctantsIsVolumeByTriangles) {
  Random random(31);
  const Body sphere = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.23, {0.2, 0.4, 0.9});
  const Body liver = support::embedded(support::liver_mesh(), 0.02, {0.5, 0.3, 0.1});
  for (int i = 0; i < 60; ++i) {
    Body body = i == 0 ? liver : i % 2 ? sphere : support::with_placed_skin(support::block({4, 3, 3}, 0.1));
    for (grid::CutLabel label = 1; label <= 3; ++label) {
      support::cut(body, support::random_cuts(random, body, uniform(random, 0, 0.5), label));
      expect_tiled(body);
      ASSERT_FALSE(HasFailure()) << "body " << i;
    }
  }
}

/// Cuts that touch no cell with an empty node.
std::vector<EdgeCut> away_from_skin(const Body& body, std::vector<EdgeCut> cuts) {
  std::erase_if(cuts, [&](const EdgeCut& cut) { return support::n_skin_cells(body, std::span(&cut, 1)) > 0; });
  return cuts;
}

TEST(Volume, IsKeptByEveryCutInsideTheBody) {
  Random random(32);
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    Body body = support::with_placed_skin(support::ball(1, 0.23, random_offset(random)));
    const double before = support::surface_volume(body);
    for (grid::CutLabel label = 1; label <= 4; ++label) {
      const auto cuts = away_from_skin(body, support::random_cuts(random, body, 0.3, label));
      ASSERT_FALSE(cuts.empty());
      support::cut(body, cuts);
      worst = std::max(worst, std::abs(sum(volumes_by_triangles(body)) / before - 1));
    }
  }
  EXPECT_LT(worst, 1e-12);
}

/// Lumped mass of each corner [m^3, at unit density]: its shape function over the octants, by a rule of degree 3.
std::vector<double> corner_masses(const Body& body) {
  std::vector<double> mass(body.complex.n_corners(), 0);
  const double h = body.grid.h();
  const auto add = [&](const grid::Copy& copy, const Vec3& p, const double weight) {
    for (int v = 0; v < 8; ++v) {
      double shape = weight;
      for (int axis = 0; axis < 3; ++axis)
        shape *= v >> axis & 1 ? p[axis] : 1 - p[axis];
      mass[copy.corners[v].value] += shape;
    }
  };
  for (const auto& copy : body.complex.copies)
    grid::for_each_tetrahedron(body, copy, [&](const grid::Tetrahedron& t, int) {
      const double volume = h * h * h * support::volume(t);
      const Vec3 centre = 0.25 * (t[0] + t[1] + t[2] + t[3]);
      add(copy, centre, -0.8 * volume);
      for (const Vec3& p : t)
        add(copy, centre + (p - centre) / 3, 0.45 * volume);
    });
  return mass;
}

/// Cuts and updates; returns the largest difference between a corner's mass and that of its heirs.
double worst_inheritance(Body& body, const cut::SweepCuts& cuts) {
  const auto before = corner_masses(body);
  cut::Cutter cutter(9);
  cutter.begin(body, grid::rest_positions(body));
  auto change = cutter.cut(body, cuts);
  place(body, change, {});
  const auto after = corner_masses(body);
  std::vector<double> inherited(after.begin(), after.begin() + static_cast<std::ptrdiff_t>(before.size()));
  for (std::size_t i = 0; i < change.parents.size(); ++i)
    inherited[change.parents[i].value] += after[before.size() + i];
  double worst = 0;
  for (std::size_t c = 0; c < before.size(); ++c)
    worst = std::max(worst, std::abs(inherited[c] - before[c]));
  return worst;
}

/// Momentum and energy then pass a first cut unchanged, whatever is cut, and however the skin is bent; and later ones
/// but where several cross in a cell that has but one vertex for them.
TEST(Volume, CornersShareTheMassOfTheirParent) {
  Random random(33);
  const Body box = support::embedded(geometry::box_mesh({0, 0, 0}, {0.73, 0.61, 0.52}), 0.13, random_offset(random));
  const Body ball = support::embedded(geometry::sphere_mesh(0.4, Vec3::Zero(), 4), 0.13, random_offset(random));
  const Body liver = support::embedded(support::liver_mesh(), 0.016, Vec3::Constant(0.4));
  double worst = 0, worst_later = 0;
  for (int i = 0; i < 12; ++i)
    for (const Body& whole : {box, ball, liver}) {
      Body body = support::with_copies(whole);
      const double h = body.grid.h(), cube = h * h * h;
      worst = std::max(
        worst, worst_inheritance(body, support::with_skin(body, support::random_cuts(random, body, 0.1))) / cube);
      body = support::with_copies(whole);
      for (grid::CutLabel label = 1; label <= 3; ++label) {
        const Vec3 normal = support::random_direction(random);
        const Vec3 through = body.grid.position(grid::NodeId(random() % body.grid.n_nodes()));
        const auto cuts = support::cuts_of_plane(body, {normal, normal.dot(through) + 0.1 * h}, label);
        double& of = label == 1 ? worst : worst_later;
        of = std::max(of, worst_inheritance(body, cuts) / cube);
      }
      EXPECT_GE(grid::n_pieces(body.complex), 2u);
    }
  std::cout << "masses of corners change by at most " << worst << " of a cube, by later cuts " << worst_later << '\n';
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(worst_later, 0.02);
}

TEST(Volume, OfASkinDoesNotChangeWhenItIsCut) {
  Random random(40);
  const Body sphere = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 4), 0.17, {0.3, 0.1, 0.8});
  const Body ball = support::with_placed_skin(support::ball(1, 0.17, random_offset(random)));
  const Body liver = support::embedded(support::liver_mesh(), 0.014, {0.5, 0.5, 0.5});
  for (const Body& whole : {sphere, ball, liver}) {
    const double before = support::surface_volume(whole);
    for (int i = 0; i < 20; ++i) {
      Body body = whole;
      for (grid::CutLabel label = 1; label <= 3; ++label) {
        support::cut(body, support::random_cuts(random, body, 0.1, label));
        EXPECT_NEAR(support::surface_volume(body) / before, 1, 1e-12);
      }
    }
  }
}

TEST(Volume, OfABallIsOfSecondOrder) {
  Random random(38);
  const double exact = 4 * std::numbers::pi / 3;
  std::vector<double> errors;
  const std::vector<double> spacings = {1.0 / 5, 1.0 / 10, 1.0 / 20, 1.0 / 40};
  for (const double h : spacings) {
    double error = 0;
    constexpr int n_offsets = 5;
    for (int i = 0; i < n_offsets; ++i) {
      const Body body = support::with_placed_skin(support::ball(1, h, random_offset(random)));
      error += std::abs(support::surface_volume(body) / exact - 1) / n_offsets;
    }
    errors.push_back(error);
    std::cout << "ball, R / h = " << 1 / h << ": relative volume error " << error << '\n';
  }
  const double rate = std::log2(errors.front() / errors.back()) / 3;
  std::cout << "rate " << rate << '\n';
  EXPECT_GT(rate, 1.8);
  EXPECT_LT(errors.back(), 1e-3);
}

/// Mean and worst relative error of the liver's volume over lattice offsets.
template <class Embed>
std::pair<double, double> liver_error(const double exact, const Embed& embed) {
  Random random(39);
  double mean = 0, worst = 0;
  constexpr int n_offsets = 4;
  for (int i = 0; i < n_offsets; ++i) {
    const double error = std::abs(support::surface_volume(embed(random_offset(random))) / exact - 1);
    mean += error / n_offsets;
    worst = std::max(worst, error);
  }
  return {mean, worst};
}

TEST(Volume, OfTheLiverApproachesItsMesh) {
  const auto mesh = support::liver_mesh();
  const double exact = geometry::volume(mesh);
  const std::vector<double> spacings = {0.02, 0.014, 0.01, 0.007};
  std::vector<double> fitted, placed;
  for (const double h : spacings) {
    const auto [mean, worst] = liver_error(exact, [&](const Vec3& at) { return support::embedded(mesh, h, at); });
    const auto [mean_placed, worst_placed] =
      liver_error(exact, [&](const Vec3& at) { return support::with_placed_skin(cut::embed(mesh, h, at).solid); });
    fitted.push_back(mean);
    placed.push_back(mean_placed);
    std::cout << "liver, h = " << h << " m: relative volume error " << mean << " (worst " << worst
              << "), without the fit to the mesh " << mean_placed << " (worst " << worst_placed << ")\n";
    EXPECT_LT(std::max(worst, worst_placed), 0.02);
  }
  const double rate = std::log(fitted.front() / fitted.back()) / std::log(spacings.front() / spacings.back());
  std::cout << "rate " << rate << '\n';
  EXPECT_GT(rate, 1.8);
  EXPECT_LT(placed.back(), placed.front());
}

} // namespace
} // namespace kerf::surface::volume_test
