/// Whole surfaces: closed, following their corners, the same on any number of threads.

#include "surface/surface.h"

#include "base/parallel.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace kerf::surface::surface_test {
namespace {

using grid::CellComplex;
using grid::CopyId;
using support::Body;
using support::Random;
using support::uniform;

struct Cut {
  Body body;
  grid::Pieces pieces;
  Surface surface;

  explicit Cut(Body b)
    : body(support::with_copies(std::move(b))), pieces(grid::pieces(body.complex)), surface(build_surface(body)) {}
};

/// Directed edges that are not met exactly once in each direction.
std::size_t n_open_edges(const std::vector<Triangle>& triangles) {
  std::vector<std::uint64_t> forward, backward;
  const auto join = [](const std::uint64_t a, const std::uint64_t b) { return a << 32 | b; };
  for (const auto& t : triangles)
    for (int i = 0; i < 3; ++i) {
      forward.push_back(join(t[i], t[(i + 1) % 3]));
      backward.push_back(join(t[(i + 1) % 3], t[i]));
    }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  std::size_t n = 0;
  for (std::size_t i = 0; i < forward.size(); ++i)
    n += forward[i] != backward[i] || (i > 0 && forward[i] == forward[i - 1]);
  return n;
}

/// An update may leave vertices without triangles.
enum class Vertices { all_used, some_used };

void expect_closed(const Cut& cut, const Vertices vertices) {
  const auto& triangles = cut.surface.triangles;
  EXPECT_EQ(n_open_edges(triangles), 0u);
  std::vector<std::vector<Triangle>> of_piece(cut.pieces.n_pieces);
  std::vector<char> used(cut.surface.rest.size(), 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    ASSERT_TRUE(a != b && b != c && c != a);
    for (const auto v : triangles[i])
      used[v] = 1;
    of_piece[cut.pieces.piece[cut.surface.copies[i]]].push_back(triangles[i]);
  }
  if (vertices == Vertices::all_used) {
    EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0) << "vertices without triangles";
  }
  for (const auto& piece : of_piece) {
    EXPECT_FALSE(piece.empty());
    EXPECT_EQ(n_open_edges(piece), 0u);
  }
}

bool is_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Both sides of each cut are the same triangles the other way round, bit for bit; the skin has one side.
void expect_two_sides(const Cut& cut) {
  using Corners = std::array<double, 9>;
  std::map<std::pair<Corners, grid::CutLabel>, int> balance;
  for (std::size_t i = 0; i < cut.surface.triangles.size(); ++i) {
    if (cut.surface.labels[i] == grid::skin_label)
      continue;
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k)
      p[k] = cut.surface.rest[cut.surface.triangles[i][k]];
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0])
      continue; // a wall of no extent
    std::rotate(p.begin(), std::min_element(p.begin(), p.end(), is_before), p.end());
    const bool swapped = is_before(p[2], p[1]);
    if (swapped)
      std::swap(p[1], p[2]);
    Corners key;
    for (int k = 0; k < 9; ++k)
      key[k] = p[k / 3][k % 3];
    balance[{key, cut.surface.labels[i]}] += swapped ? -1 : 1;
  }
  for (const auto& [key, n] : balance)
    ASSERT_EQ(n, 0) << "a triangle of a cut that the other side does not share";
}

/// Rows sum to one, reproduce the rest positions, and ask only corners of the copies that the vertex bounds.
void expect_weights(const Cut& cut) {
  const Interpolation& w = cut.surface.weights;
  ASSERT_EQ(w.n_points(), cut.surface.rest.size());
  ASSERT_EQ(w.start.back(), w.columns.size());
  ASSERT_EQ(w.start.back(), w.values.size());
  Points rest;
  follow(cut.surface, grid::rest_positions(cut.body), rest);
  const double h = cut.body.grid.h();
  for (std::size_t i = 0; i < w.n_points(); ++i) {
    double sum = 0, least = 1;
    for (auto k = w.start[i]; k < w.start[i + 1]; ++k) {
      sum += w.values[k];
      least = std::min(least, w.values[k]);
    }
    ASSERT_NEAR(sum, 1, 1e-14);
    ASSERT_GE(least, 0);
    ASSERT_LE((rest[i] - cut.surface.rest[i]).lpNorm<Eigen::Infinity>(),
              1e-14 * h + 4e-16 * cut.surface.rest[i].lpNorm<Eigen::Infinity>());
  }
  for (std::size_t i = 0; i < cut.surface.triangles.size(); ++i) {
    const auto& corners = cut.body.complex.copies[cut.surface.copies[i]].corners;
    for (const auto v : cut.surface.triangles[i])
      for (auto k = w.start[v]; k < w.start[v + 1]; ++k)
        ASSERT_NE(std::find(corners.begin(), corners.end(), grid::CornerId(w.columns[k])), corners.end());
  }
}

/// Which piece a corner belongs to: there is only one.
std::vector<std::uint32_t> piece_of_corner(const CellComplex& complex, const grid::Pieces& pieces) {
  std::vector<std::uint32_t> piece(complex.n_corners(), Id<void>::no_value);
  for (const auto c : ids<CopyId>(complex.n_copies()))
    for (const auto corner : complex.copies[c].corners) {
      EXPECT_TRUE(piece[corner.value] == Id<void>::no_value || piece[corner.value] == pieces.piece[c]);
      piece[corner.value] = pieces.piece[c];
    }
  return piece;
}

/// Each piece takes its own affine map: the surface follows it, and its volume is multiplied by the determinant.
void expect_affine(Random& random, const Cut& cut) {
  std::vector<Mat3> stretch;
  Points shift;
  for (std::uint32_t i = 0; i < cut.pieces.n_pieces; ++i) {
    stretch.push_back(Mat3::Identity());
    for (int axis = 0; axis < 3; ++axis)
      stretch.back().col(axis) += 0.3 * support::random_vector(random);
    shift.push_back(support::random_vector(random));
  }
  const auto piece = piece_of_corner(cut.body.complex, cut.pieces);
  Points corners = grid::rest_positions(cut.body), x;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = (stretch[piece[i]] * corners[i] + shift[piece[i]]).eval();
  follow(cut.surface, corners, x);

  Surface moved = cut.surface;
  moved.rest = x;
  const auto before = piece_volumes(cut.surface, cut.body.complex), after = piece_volumes(moved, cut.body.complex);
  for (std::size_t i = 0; i < cut.surface.triangles.size(); ++i) {
    const auto p = cut.pieces.piece[cut.surface.copies[i]];
    for (const auto v : cut.surface.triangles[i])
      ASSERT_LE((x[v] - stretch[p] * cut.surface.rest[v] - shift[p]).norm(),
                1e-14 * (cut.body.grid.h() + 10 * shift[p].norm() + 10 * x[v].norm()));
  }
  const double cell = std::pow(cut.body.grid.h(), 3);
  for (std::uint32_t p = 0; p < cut.pieces.n_pieces; ++p)
    ASSERT_NEAR(after[p], stretch[p].determinant() * before[p],
                2e-11 * (std::abs(after[p]) + cell + shift[p].norm() * cell / cut.body.grid.h()));
}

/// Under any motion of the corners each piece stays closed: its area vectors sum to zero.
void expect_closed_when_deformed(Random& random, const Cut& cut) {
  Points corners = grid::rest_positions(cut.body), x;
  for (Vec3& p : corners)
    p += 0.4 * cut.body.grid.h() * support::random_vector(random);
  follow(cut.surface, corners, x);
  Points area(cut.pieces.n_pieces, Vec3::Zero());
  std::vector<double> total(cut.pieces.n_pieces, 0);
  for (std::size_t i = 0; i < cut.surface.triangles.size(); ++i) {
    const auto& [a, b, c] = cut.surface.triangles[i];
    const auto p = cut.pieces.piece[cut.surface.copies[i]];
    const Vec3 normal = (x[b] - x[a]).cross(x[c] - x[a]);
    area[p] += normal;
    total[p] += normal.norm();
  }
  for (std::uint32_t p = 0; p < cut.pieces.n_pieces; ++p)
    ASSERT_LE(area[p].norm(), 1e-12 * total[p]);
}

void expect_good(Random& random, const Cut& cut, const Vertices vertices = Vertices::all_used) {
  expect_closed(cut, vertices);
  expect_two_sides(cut);
  expect_weights(cut);
  expect_affine(random, cut);
  expect_closed_when_deformed(random, cut);
}

TEST(Surface, IsClosedForRandomCutsOfBlocks) {
  Random random(21);
  std::size_t n_triangles = 0;
  for (int i = 0; i < 300; ++i) {
    const Index3 n = {2 + i % 4, 1 + i / 4 % 4, 1 + i / 16 % 4};
    auto nodes = i % 3 ? support::block_nodes(n) : support::some_nodes(random, n, 0.7);
    if (nodes.empty())
      nodes = {{2, 1, 1}};
    Body body = support::with_placed_skin(support::make_body({{0.1, -0.2, 0.3}, 0.5}, nodes, support::midway));
    for (grid::CutLabel label = 1; label <= 1 + i % 2; ++label)
      support::cut(body, support::random_cuts(random, body, uniform(random, 0.02, 0.9), label));
    const Cut cut(std::move(body));
    expect_good(random, cut);
    ASSERT_FALSE(HasFailure()) << "random set " << i;
    n_triangles += cut.surface.triangles.size();
  }
  EXPECT_GT(n_triangles, 100000u);
}

TEST(Surface, IsClosedForRandomCutsOfEmbeddedBodies) {
  Random random(22);
  const Body sphere = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 4), 0.17, {0.3, 0.1, 0.8});
  const Body liver = support::embedded(support::liver_mesh(), 0.016, {0.5, 0.5, 0.5});
  for (const Body& whole : {sphere, liver})
    for (const double probability : {0.0, 0.03, 0.3, 1.0}) {
      Body body = whole;
      support::cut(body, support::random_cuts(random, body, probability));
      const Cut cut(std::move(body));
      expect_good(random, cut);
      ASSERT_FALSE(HasFailure()) << "cut with probability " << probability;
    }
}

/// A surface kept up to date through several cuts.
struct Updated {
  Body body;
  SurfaceIndex index = {};
  Surface surface = build_surface(body, index);

  Updated(Body whole) : body(support::with_copies(std::move(whole))) {}

  void cut(const std::vector<grid::EdgeCut>& cuts) {
    support::cut(body, cuts);
    std::vector<grid::EdgeId> edges;
    for (const auto& cut : cuts)
      edges.push_back(cut.edge);
    update_surface(body, grid::update_complex(body, edges), surface, index);
  }
};

void expect_as_built(Random& random, const Updated& updated) {
  Cut built(updated.body);
  const auto names = support::renaming(updated.body.complex, built.body.complex);
  ASSERT_TRUE(names.has_value());
  ASSERT_TRUE(support::is_same(updated.surface, built.surface, *names));
  built.body.complex = updated.body.complex;
  built.pieces = grid::pieces(updated.body.complex);
  built.surface = updated.surface;
  expect_good(random, built, Vertices::some_used);
}

TEST(Surface, UpdatedIsTheOneThatIsBuilt) {
  Random random(24);
  const Body sphere = support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), 0.3, {0.3, 0.1, 0.8});
  const Body liver = support::embedded(support::liver_mesh(), 0.025, {0.5, 0.5, 0.5});
  for (int i = 0; i < 60; ++i) {
    auto nodes = i % 2 ? support::block_nodes({4, 3, 3}) : support::some_nodes(random, {4, 4, 4}, 0.7);
    nodes.push_back({2, 1, 1});
    Updated updated{i % 10 == 0 ? sphere
                    : i % 10 == 5
                      ? liver
                      : support::with_placed_skin(support::make_body({{0.1, -0.2, 0.3}, 0.5}, nodes, support::midway))};
    for (grid::CutLabel label = 1; label <= 5; ++label) {
      updated.cut(support::random_cuts(random, updated.body, uniform(random, 0, i % 3 ? 0.1 : 0.6), label));
      expect_as_built(random, updated);
      ASSERT_FALSE(HasFailure()) << "body " << i << ", cut " << label;
    }
  }
}

TEST(Surface, HasTwoTrianglesACellAroundEachMaterialEnd) {
  // An uncut block of n cubes has a quad in each of four cells around each skin edge; a cut adds two sides.
  Body body = support::with_placed_skin(support::block({3, 3, 3}));
  EXPECT_EQ(Cut(body).surface.triangles.size(), 2u * 4 * 54);
  support::cut(body, std::vector<grid::EdgeCut>{{*body.grid.find_edge({2, 2, 2}, 0), 0.5, Vec3::UnitX(), 7}});
  const Cut cut(std::move(body));
  EXPECT_EQ(cut.surface.triangles.size(), 2u * 4 * (54 + 2));
  EXPECT_EQ(std::count(cut.surface.labels.begin(), cut.surface.labels.end(), 7), 16);
  EXPECT_EQ(std::count(cut.surface.labels.begin(), cut.surface.labels.end(), grid::skin_label), 8 * 54);
  EXPECT_NEAR(enclosed_volume(cut.surface.rest, cut.surface.triangles), 27, 1e-12);
}

TEST(Surface, OfNothingEnclosesNothing) { EXPECT_EQ(enclosed_volume({}, {}), 0); }

void expect_same_bits(const Cut& a, const Cut& b, const Points& x, const Points& y) {
  ASSERT_EQ(a.body.cuts.all().size(), b.body.cuts.all().size());
  for (std::size_t i = 0; i < a.body.cuts.all().size(); ++i) {
    ASSERT_EQ(a.body.cuts.all()[i].edge, b.body.cuts.all()[i].edge);
    ASSERT_EQ(a.body.cuts.all()[i].t, b.body.cuts.all()[i].t);
    ASSERT_EQ(a.body.cuts.all()[i].normal, b.body.cuts.all()[i].normal);
  }
  ASSERT_EQ(a.body.complex.node.items(), b.body.complex.node.items());
  ASSERT_EQ(a.pieces.piece.items(), b.pieces.piece.items());
  ASSERT_EQ(a.surface.rest, b.surface.rest);
  ASSERT_EQ(a.surface.triangles, b.surface.triangles);
  ASSERT_EQ(a.surface.labels, b.surface.labels);
  ASSERT_EQ(a.surface.weights.columns, b.surface.weights.columns);
  ASSERT_EQ(a.surface.weights.values, b.surface.weights.values);
  ASSERT_EQ(x, y);
}

TEST(Surface, IsTheSameOnOneAndTwoThreads) {
  const int before = n_threads();
  std::vector<Cut> cuts;
  std::vector<Points> positions(2);
  for (const int n : {1, 2}) {
    set_n_threads(n);
    Random random(23);
    Body body = support::embedded(support::liver_mesh(), 0.012, {0.5, 0.5, 0.5});
    support::cut(body, support::random_cuts(random, body, 0.2));
    cuts.emplace_back(std::move(body));
    Points corners = grid::rest_positions(cuts.back().body);
    for (Vec3& p : corners)
      p += 0.001 * support::random_vector(random);
    follow(cuts.back().surface, corners, positions[n - 1]);
  }
  set_n_threads(before);
  expect_same_bits(cuts[0], cuts[1], positions[0], positions[1]);
}

} // namespace
} // namespace kerf::surface::surface_test
