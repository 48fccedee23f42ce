#include "cut/cut_surface.h"

#include "base/error.h"
#include "cut/blade.h"
#include "cut/cutter.h"
#include "tests/support/clipped_box.h"
#include "tests/support/placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <numeric>

namespace kerf::cut::cut_surface_test {
namespace {

using grid::EdgeCut;
using grid::EdgeId;
using support::Body;
using support::Random;
using support::random_direction;
using support::random_offset;
using support::uniform;

constexpr double pi = std::numbers::pi;

/// A body that stands as it was embedded.
struct Resting {
  Body body;
  Points x;
  Cutter cutter{1};

  Resting(Body whole) : body(std::move(whole)) {
    body.complex = grid::build_complex(body);
    x = grid::rest_positions(body);
    cutter.begin(body, x);
  }

  SweepCuts meet(const Shape& shape) const { return cut_edges({"", shape, 1}, body, x); }
  SweepCuts cut(const Shape& shape) {
    SweepCuts found = meet(shape);
    surface::place(body, cutter.at_once(body, {"", shape, 1}, x), {});
    x = grid::rest_positions(body);
    return found;
  }
  surface::Surface surface() const { return surface::build_surface(body); }
  std::vector<double> volumes() const {
    auto volumes = surface::piece_volumes(surface(), body.complex);
    std::sort(volumes.begin(), volumes.end());
    return volumes;
  }
};

Resting cube(const double side, const double h, const Vec3& offset) {
  const Vec3 half = Vec3::Constant(0.5 * side);
  return {support::embedded(geometry::box_mesh(-half, half), h, offset)};
}

/// A block with its nodes at 1, 2, ... n along each axis.
Resting block(const int n) { return {support::with_placed_skin(support::block({n, n, n}))}; }

geometry::TriangleMesh square(const Vec3& middle, const Vec3& u, const Vec3& v) {
  return {{middle - u - v, middle + u - v, middle + u + v, middle - u + v}, {{0, 1, 2}, {0, 2, 3}}};
}

void expect_same(const std::vector<EdgeCut>& a, const std::vector<EdgeCut>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].edge, b[i].edge);
    EXPECT_NEAR(a[i].t, b[i].t, 1e-11);
    EXPECT_NEAR(std::abs(a[i].normal.dot(b[i].normal)), 1, 1e-11);
  }
}

/// A side of a box in a layer of nodes, or off it by round-off: points of the skin that are interpolated there may lie
/// beyond it, and beyond all corners of their cells, by as much. With boxes around edges they are cut as without.
TEST(CutSurface, BoxesMissNothingByRoundoff) {
  Random random(17);
  std::size_t n_cuts = 0;
  for (int i = 0; i < 12; ++i) {
    Resting ball(support::with_placed_skin(support::ball(1, 0.41, random_offset(random))));
    EdgeBoxes boxes(ball.body);
    boxes.fit(ball.x);
    for (int axis = 0; axis < 3; ++axis)
      for (int ulps = -4; ulps <= 4; ++ulps) {
        double side = ball.body.grid.position(*ball.body.grid.find_node(Index3{5, 5, 5}))[axis];
        for (int k = 0; k != ulps; k += ulps > 0 ? 1 : -1)
          side = std::nextafter(side, ulps * 1e300);
        Vec3 upper = Vec3::Constant(2);
        upper[axis] = side;
        const CutSurface surface{"", geometry::box_mesh(Vec3::Constant(-2), upper), 1};
        const SweepCuts found = cut_edges(surface, ball.body, ball.x, &boxes),
                        all = cut_edges(surface, ball.body, ball.x);
        ASSERT_EQ(found.cuts.size(), all.cuts.size());
        ASSERT_EQ(found.of_skin.size(), all.of_skin.size()) << i << ' ' << axis << ' ' << ulps;
        n_cuts += all.of_skin.size();
      }
  }
  EXPECT_GT(n_cuts, 1000u);
}

/// The nodes stand so close to the skin that no plane passes between, so that every plane is resolved.
TEST(CutSurface, PlanesGiveExactPieces) {
  constexpr int n = 9;
  constexpr double h = 0.1, gap = 1e-6, side = h * (n + 2 * gap);
  const Resting uncut = cube(side, h, Vec3::Constant(gap));
  const Box box{Vec3::Constant(-0.5 * side), Vec3::Constant(0.5 * side)};
  Random random(41);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 normal = i < 30 ? Vec3(Vec3::Unit(i % 3)) : random_direction(random);
    const Vec3 point = uniform(random, -0.25, 0.25) * normal;
    Resting body = uncut;
    const SweepCuts found = body.cut(Plane{point, normal});
    EXPECT_EQ(found.n_double_crossings, 0u);
    const auto volumes = body.volumes();
    ASSERT_EQ(volumes.size(), 2u);
    const double below = support::volume_below(box, {normal, normal.dot(point)}), whole = std::pow(side, 3);
    worst = std::max(worst, std::abs(volumes[0] - std::min(below, whole - below)) / whole);
    EXPECT_NEAR(volumes[0] + volumes[1], whole, 1e-12 * whole);
  }
  std::cout << "200 planes: worst piece volume error " << worst << " of the cube\n";
  EXPECT_LT(worst, 1e-10) << "vertices keep min_edge_parameter away from the sides of their cells";
}

/// An end on the surface counts as positive, so the cut is right below the nodes it meets, and whole.
TEST(CutSurface, PlanesThroughNodesCutBelowThem) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1., -1.}) {
      Resting body = block(5);
      const auto cuts = body.cut(Plane{Vec3::Constant(3), sign * Vec3::Unit(axis)}).cuts;
      ASSERT_EQ(cuts.size(), 25u);
      for (const EdgeCut& cut : cuts) {
        EXPECT_EQ(body.body.grid.index(body.body.grid.ends(cut.edge)[0])[axis], sign > 0 ? 2 : 3);
        EXPECT_EQ(cut.t, sign > 0 ? 1 : 0);
      }
      EXPECT_EQ(grid::n_pieces(body.body.complex), 2u);
    }
}

/// Edges are cut exactly where a closed shape parts their ends, wherever its surface lies against nodes and edges.
TEST(CutSurface, ClosedShapesCutTheBorderOfASetOfNodes) {
  const Resting body = block(8);
  Random random(42);
  std::size_t n_cut = 0, n_of_skin = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 centre =
      i < 20 ? Vec3(Vec3::Constant(0.5 * (i % 6 + 5))) : Vec3(Vec3::Constant(4.5) + 2 * random_offset(random));
    const double r = i < 20 ? 0.5 * (i % 7 + 1) : uniform(random, 0.8, 4), height = i < 20 ? 2 : uniform(random, 1, 6);
    const Vec3 axis = i < 20 ? Vec3(Vec3::Unit(i % 3)) : random_direction(random);
    const auto in_sphere = [&](const Vec3& p) { return (p - centre).norm() < r; };
    const auto in_cylinder = [&](const Vec3& p) {
      const double up = (p - centre).dot(axis);
      return std::abs(up) < height / 2 && (p - centre - up * axis).norm() < r;
    };
    const auto check_border = [&](const Shape& shape, const auto& is_inside) {
      const auto cuts = body.meet(shape).cuts;
      auto next = cuts.begin();
      for (const auto e : ids<EdgeId>(body.body.grid.n_edges())) {
        const auto& [lower, upper] = body.body.grid.ends(e);
        const bool is_cut = next != cuts.end() && next->edge == e;
        if (!body.body.grid.is_material(lower) && !body.body.grid.is_material(upper)) {
          EXPECT_FALSE(is_cut);
          continue;
        }
        const auto is_end_inside = [&](const grid::NodeId n,
                                       const double beyond) { // the skin's, where the node is empty
          const Vec3 p = body.body.grid.position(n);
          const Vec3 skin = grid::edge_skin_point(body.body, e);
          return is_inside(body.body.grid.is_material(n) ? p : Vec3(skin + beyond * (p - skin)));
        };
        const auto is_parted = [&](const double beyond) {
          return is_end_inside(lower, beyond) != is_end_inside(upper, beyond);
        };
        const bool is_on_skin = is_parted(1e-8) != is_parted(-1e-8); // then either will do
        EXPECT_TRUE(is_on_skin || is_cut == is_parted(0));
        n_of_skin += is_cut && !support::is_inner(body.body, e);
        next += is_cut;
      }
      n_cut += cuts.size();
    };
    check_border(Sphere{centre, r}, in_sphere);
    check_border(Cylinder{centre, axis, r, height}, in_cylinder);
  }
  EXPECT_GT(n_cut, 2000u);
  EXPECT_GT(n_of_skin, 200u);
}

/// Places and normals of a cut against the surface itself.
TEST(CutSurface, CutsLieOnTheSurfaceWithItsNormal) {
  const Resting body = block(8);
  Random random(43);
  for (int i = 0; i < 20; ++i) {
    const Vec3 centre = Vec3::Constant(4) + random_offset(random), axis = random_direction(random);
    const double r = uniform(random, 1, 3), height = uniform(random, 1, 4);
    for (const EdgeCut& cut : body.meet(Sphere{centre, r}).cuts) {
      Vec3 p = body.body.grid.position(body.body.grid.ends(cut.edge)[0]);
      p[body.body.grid.axis(cut.edge)] += cut.t;
      EXPECT_NEAR((p - centre).norm(), r, 1e-13);
      EXPECT_NEAR(std::abs(cut.normal.dot((p - centre) / r)), 1, 1e-12);
    }
    for (const EdgeCut& cut : body.meet(Cylinder{centre, axis, r, height}).cuts) {
      Vec3 p = body.body.grid.position(body.body.grid.ends(cut.edge)[0]);
      p[body.body.grid.axis(cut.edge)] += cut.t;
      const double up = (p - centre).dot(axis);
      const Vec3 out = p - centre - up * axis;
      const double from_side = std::abs(out.norm() - r), from_end = std::abs(std::abs(up) - height / 2);
      EXPECT_LT(std::min(from_side, from_end), 1e-13);
      EXPECT_NEAR(std::abs(cut.normal.dot(from_side < from_end ? Vec3(out / r) : axis)), 1, 1e-12);
    }
  }
}

struct Rate {
  std::vector<double> errors; ///< relative, mean over lattice offsets, h halved from one to the next
  double order() const { return 0.5 * std::log2(errors.front() / errors.back()); }
};

/// The volume of what a closed shape inside a cube cuts out.
Rate volume_rate(const Shape& shape, const double exact) {
  Rate rate;
  for (const double h : {0.1, 0.05, 0.025}) {
    Random random(44);
    double sum = 0;
    constexpr int n = 4;
    for (int i = 0; i < n; ++i) {
      Resting body = cube(1, h, random_offset(random));
      body.cut(shape);
      const auto volumes = body.volumes();
      EXPECT_EQ(volumes.size(), 2u);
      EXPECT_NEAR(volumes[0] + volumes[1], 1, 1e-12);
      sum += std::abs(volumes[0] / exact - 1) / n;
    }
    rate.errors.push_back(sum);
    std::cout << "  h " << h << " m: relative volume error " << sum << '\n';
  }
  std::cout << "  order " << rate.order() << '\n';
  return rate;
}

TEST(CutSurface, SphereVolumeConvergesToSecondOrder) {
  constexpr double r = 0.31;
  const Rate rate = volume_rate(Sphere{{0.03, -0.02, 0.01}, r}, 4 * pi / 3 * r * r * r);
  EXPECT_NEAR(rate.order(), 2, 0.2);
  EXPECT_LT(rate.errors.back(), 3e-3);
}

TEST(CutSurface, CylinderVolumeConvergesToSecondOrder) {
  constexpr double r = 0.23, height = 0.5;
  const Rate rate =
    volume_rate(Cylinder{{0.03, -0.02, 0.01}, Vec3(0.3, 0.5, 0.8).normalized(), r, height}, pi * r * r * height);
  EXPECT_GT(rate.order(), 1.7);
  EXPECT_LT(rate.errors.back(), 1e-2);
}

/// A crack: no piece comes free, and it ends at the rim. Its faces are flat, but for vertices at the rim of a tilted
/// disc that are held in their face or cell: they would stand where the disc's plane has left it.
TEST(CutSurface, DiscsMakeCracks) {
  constexpr double h = 1. / 32, r = 0.3;
  Random random(45);
  for (int i = 0; i < 6; ++i) {
    Resting body = cube(1, h, random_offset(random));
    const Vec3 centre = 0.05 * random_offset(random), normal = i < 3 ? Vec3(Vec3::Unit(i)) : random_direction(random);
    const auto found = body.cut(Disc{centre, normal, r});
    EXPECT_EQ(grid::n_pieces(body.body.complex), 1u);
    const double expected =
      pi * r * r / (h * h) * normal.lpNorm<1>(); // edges along x: the disc's shadow on the yz plane
    EXPECT_NEAR(static_cast<double>(found.cuts.size()) / expected, 1, 0.05);
    const auto surface = body.surface();
    double worst = 0, reach = 0;
    std::size_t n = 0, n_off = 0;
    for (std::size_t k = 0; k < surface.triangles.size(); ++k)
      if (surface.labels[k] == 1)
        for (const auto v : surface.triangles[k]) {
          const double distance = std::abs(normal.dot(surface.rest[v] - centre));
          worst = std::max(worst, distance);
          reach = std::max(reach, (surface.rest[v] - centre).norm());
          n_off += distance > 1e-9 * h;
          ++n;
        }
    std::cout << "  " << found.cuts.size() << " edges, by area " << expected << "; off the disc "
              << 100. * static_cast<double>(n_off) / static_cast<double>(n) << " % of corners, by at most " << worst / h
              << " h; reach " << (reach - r) / h << " h beyond the rim\n";
    EXPECT_LT(worst, i < 3 ? 1e-9 * h : 0.25 * h);
    EXPECT_LT(static_cast<double>(n_off), 0.05 * static_cast<double>(n));
    EXPECT_LT(std::abs(reach - r), h);
    EXPECT_NEAR(surface::enclosed_volume(surface.rest, surface.triangles), 1, 1e-12);
  }
}

/// A rectangle cuts the edges that the disc around it cuts and that lie between its sides, as the two triangles that
/// fill it do, and ends at its rim.
TEST(CutSurface, RectanglesMakeCracks) {
  constexpr double h = 1. / 32, a = 0.5, b = 0.3;
  Random random(47);
  for (int i = 0; i < 12; ++i) {
    Resting body = cube(1, h, random_offset(random));
    const Vec3 centre = 0.05 * random_offset(random), normal = i < 3 ? Vec3(Vec3::Unit(i)) : random_direction(random);
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    const Rectangle patch{centre, a * u, -b * v};
    expect_same(body.meet(patch).cuts, body.meet(square(centre, 0.5 * a * u, 0.5 * b * v)).cuts);
    const auto found = body.cut(patch);
    EXPECT_NEAR(static_cast<double>(found.cuts.size()) / (a * b / (h * h) * normal.lpNorm<1>()), 1, 0.1);
    EXPECT_EQ(grid::n_pieces(body.body.complex), 1u);
    const auto surface = body.surface();
    double reach = 0;
    for (std::size_t k = 0; k < surface.triangles.size(); ++k)
      if (surface.labels[k] == 1)
        for (const auto vertex : surface.triangles[k]) {
          const Vec3 d = surface.rest[vertex] - centre;
          reach = std::max({reach, std::abs(d.dot(u)) - 0.5 * a, std::abs(d.dot(v)) - 0.5 * b});
        }
    EXPECT_LT(reach, h);
    EXPECT_GT(reach, -h);
  }
}

TEST(CutSurface, ABigSquareAndABladeCutLikeThePlane) {
  const Resting body = cube(1, 0.07, Vec3(0.3, 0.5, 0.7));
  Random random(46);
  for (int i = 0; i < 10; ++i) {
    const Vec3 normal = random_direction(random), point = 0.2 * support::random_vector(random);
    const Vec3 u = 3 * normal.unitOrthogonal(), v = normal.cross(u);
    const auto plane = body.meet(Plane{point, normal}).cuts;
    ASSERT_GT(plane.size(), 50u);
    expect_same(body.meet(square(point, u, v)).cuts, plane);
    Blade blade{.name = "", .edge = {point - u - v, point + u - v}, .key_frames = {{0, Vec3::Zero(), Vec3::Zero()}}};
    blade.key_frames.push_back({1, 2 * v, Vec3::Zero()});
    check(blade);
    expect_same(cut_edges(sweep(blade, 0, 1), body.body, body.x, 1).cuts, plane);
  }
}

/// The same rest cut, whatever the configuration: an affine map takes planes to planes.
TEST(CutSurface, CutsTheCurrentConfiguration) {
  Resting body = cube(1, 0.1, Vec3(0.3, 0.5, 0.7));
  Random random(47);
  const Points rest = body.x;
  for (int i = 0; i < 10; ++i) {
    Mat3 F = Mat3::Identity();
    for (int axis = 0; axis < 3; ++axis)
      F.col(axis) += 0.3 * support::random_vector(random);
    ASSERT_GT(F.determinant(), 0);
    const Vec3 shift = support::random_vector(random), normal = random_direction(random),
               point = 0.1 * support::random_vector(random);
    body.x = rest;
    const auto at_rest = body.meet(Plane{point, normal}).cuts;
    ASSERT_GT(at_rest.size(), 50u);
    for (Vec3& x : body.x)
      x = F * x + shift;
    const Vec3 carried = (F.transpose().inverse() * normal).normalized();
    expect_same(body.meet(Plane{F * point + shift, carried}).cuts, at_rest);
  }
}

/// Two boxes that overlap as one mesh: what lies in both counts as outside, and an edge that meets both surfaces stays
/// whole.
TEST(CutSurface, MeshesThatRunThroughThemselvesCutByParity) {
  const Resting body = block(8);
  const Box a{Vec3::Constant(1.4), Vec3::Constant(5.6)}, b{Vec3::Constant(3.3), Vec3(5.7, 7.5, 7.2)};
  const auto mesh = geometry::together(geometry::box_mesh(a.lower, a.upper), geometry::box_mesh(b.lower, b.upper));
  const SweepCuts found = body.meet(mesh);
  std::size_t n_odd = 0, n_both = 0;
  auto next = found.cuts.begin();
  for (const auto e : ids<EdgeId>(body.body.grid.n_edges())) {
    if (!support::is_inner(body.body, e))
      continue;
    const Vec3 p = body.body.grid.position(body.body.grid.ends(e)[0]),
               q = body.body.grid.position(body.body.grid.ends(e)[1]);
    const bool by_a = a.contains(p) != a.contains(q), by_b = b.contains(p) != b.contains(q);
    const bool is_cut = next != found.cuts.end() && next->edge == e;
    EXPECT_EQ(is_cut, by_a != by_b);
    next += is_cut;
    n_odd += by_a != by_b;
    n_both += by_a && by_b;
  }
  EXPECT_GT(n_odd, 50u);
  EXPECT_GT(n_both, 0u);
  EXPECT_GE(found.n_double_crossings, n_both) << "segments of the skin beside";
  const auto twice = square(Vec3::Constant(4.3), 9 * Vec3::UnitX(), 9 * Vec3::UnitY());
  EXPECT_EQ(body.meet(twice).cuts.size(), 64u);
  EXPECT_TRUE(body.meet(geometry::together(twice, twice)).cuts.empty());
  EXPECT_GT(body.meet(geometry::together(twice, twice)).n_double_crossings, 64u);
}

TEST(CutSurface, ClosedMeshesCutLikeTheirShapes) {
  Resting body = cube(1, 0.07, Vec3(0.3, 0.5, 0.7));
  const auto mesh = geometry::sphere_mesh(0.3, Vec3(0.02, 0.01, 0.03), 5); // 8192 triangles
  body.cut(mesh);
  const auto volumes = body.volumes();
  ASSERT_EQ(volumes.size(), 2u);
  EXPECT_NEAR(volumes[0] / geometry::volume(mesh), 1, 0.02);
  EXPECT_NEAR(volumes[0] + volumes[1], 1, 1e-12);
}

/// Balls around a corner, a point of an edge, of a face, and inside of a unit cube: what they cut out, by its sides and
/// as a fine mesh.
TEST(CutSurface, SpheresThroughTheSkinAreOfSecondOrder) {
  constexpr double r = 0.37;
  const std::vector<std::pair<Vec3, double>> balls = {
    {{0.5, 0.5, 0.5}, 8}, {{0.03, 0.5, -0.5}, 4}, {{0.07, -0.02, 0.5}, 2}, {{0.01, 0.03, -0.02}, 1}};
  for (const auto& [centre, parts] : balls) {
    const auto mesh = geometry::sphere_mesh(r, centre, 6); // 32,768 triangles
    const double exact = 4 * pi / 3 * r * r * r / parts, of_mesh = geometry::volume(mesh) / parts;
    std::array<Rate, 3> rates; // sphere; mesh; between them
    for (const double h : {0.1, 0.05, 0.025}) {
      Random random(48);
      std::array<double, 3> sums{};
      constexpr int n = 4;
      for (int i = 0; i < n; ++i) {
        Resting by_sphere = cube(1, h, random_offset(random)), by_mesh = by_sphere;
        by_sphere.cut(Sphere{centre, r});
        by_mesh.cut(mesh);
        const auto a = by_sphere.volumes(), b = by_mesh.volumes();
        EXPECT_EQ(a.size(), 2u) << parts << ' ' << h;
        EXPECT_EQ(b.size(), 2u) << parts << ' ' << h;
        EXPECT_NEAR(std::accumulate(a.begin(), a.end(), 0.0), 1, 1e-12);
        EXPECT_NEAR(std::accumulate(b.begin(), b.end(), 0.0), 1, 1e-12);
        sums[0] += std::abs(a[0] / exact - 1) / n;
        sums[1] += std::abs(b[0] / of_mesh - 1) / n;
        sums[2] += std::abs(a[0] / exact - b[0] / of_mesh) / n;
      }
      for (int k = 0; k < 3; ++k)
        rates[k].errors.push_back(sums[k]);
    }
    std::cout << "1/" << parts << " ball, sphere, mesh, between them:";
    for (const Rate& rate : rates)
      std::cout << "  " << rate.errors.front() << " to " << rate.errors.back() << ", order " << rate.order() << ';';
    std::cout << '\n';
    EXPECT_GT(rates[0].order(), 1.75);
    EXPECT_GT(rates[1].order(), 1.75);
    EXPECT_LT(rates[0].errors.back(), 1e-3);
    EXPECT_LT(rates[2].errors.back(), 0.1 * rates[0].errors.back());
  }
}

TEST(CutSurface, WhatPassesBetweenTwoNodesIsCounted) {
  const Resting body = block(4);
  EXPECT_TRUE(body.meet(Sphere{{2.5, 2, 2}, 0.3}).cuts.empty());
  EXPECT_EQ(body.meet(Sphere{{2.5, 2, 2}, 0.3}).n_double_crossings, 1u);
  EXPECT_EQ(body.meet(Cylinder{{2.5, 2, 2}, Vec3::UnitX(), 0.3, 0.6}).n_double_crossings, 1u);
  EXPECT_EQ(body.meet(Cylinder{{2.5, 2.5, 2}, Vec3::UnitZ(), 0.6, 0.1}).cuts.size(), 0u);
  EXPECT_EQ(body.meet(Sphere{{2.5, 2.5, 2.5}, 0.3}).n_double_crossings, 0u);
  EXPECT_EQ(body.meet(Sphere{{2.5, 2, 2}, 50}).n_double_crossings, 0u) << "all inside";
}

TEST(CutSurface, LeavesCutEdgesAlone) {
  Resting body = cube(1, 0.1, Vec3::Constant(0.5));
  const Plane plane{Vec3(0, 0, 0.02), Vec3::UnitZ()};
  EXPECT_FALSE(body.cut(plane).cuts.empty());
  EXPECT_TRUE(body.meet(plane).cuts.empty());
  EXPECT_EQ(grid::n_pieces(body.body.complex), 2u);
  body.cut(Plane{Vec3(0.01, 0, 0), Vec3::UnitX()});
  EXPECT_EQ(grid::n_pieces(body.body.complex), 4u);
}

void expect_complaint(const Shape& shape, const std::string& key) {
  try {
    check({"bad", shape, 1});
    ADD_FAILURE() << "accepted a bad " << key;
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.complaint().path, key);
    EXPECT_FALSE(error.complaint().rule.empty());
  }
}

TEST(CutSurface, RefusesWhatIsNoSurface) {
  const Vec3 o = Vec3::Zero(), z = Vec3::UnitZ();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(check({"good", Plane{o, z}, 1}));
  EXPECT_NO_THROW(check({"good", Cylinder{o, z, 1, 1}, 1}));
  expect_complaint(Plane{o, o}, "Normal [1]");
  expect_complaint(Plane{Vec3::Constant(nan), z}, "Point [m]");
  expect_complaint(Sphere{o, 0}, "Radius [m]");
  expect_complaint(Sphere{o, -1}, "Radius [m]");
  expect_complaint(Cylinder{o, o, 1, 1}, "Axis [1]");
  expect_complaint(Cylinder{o, z, 1, 0}, "Height [m]");
  expect_complaint(Cylinder{o, z, nan, 1}, "Radius [m]");
  expect_complaint(Disc{o, Vec3::Constant(nan), 1}, "Normal [1]");
  expect_complaint(Disc{o, z, std::numeric_limits<double>::infinity()}, "Radius [m]");
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY();
  EXPECT_NO_THROW(check({"good", Rectangle{o, x, 2 * y}, 1}));
  expect_complaint(Rectangle{Vec3::Constant(nan), x, y}, "Point [m]");
  expect_complaint(Rectangle{o, o, y}, "First side [m]");
  expect_complaint(Rectangle{o, x, Vec3::Constant(nan)}, "Second side [m]");
  expect_complaint(Rectangle{o, x, x + y}, "Second side [m]");
  expect_complaint(geometry::TriangleMesh{}, "Mesh");
}

TEST(CutSurface, RefusesCornersThatAreNotFinite) {
  Resting body = block(3);
  body.x[5][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(body.meet(Plane{Vec3::Constant(2.3), Vec3::UnitZ()}), NumericalError);
}

} // namespace
} // namespace kerf::cut::cut_surface_test
