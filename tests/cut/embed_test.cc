#include "cut/embed.h"

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/solid.h"
#include "grid/complex.h"
#include "tests/geometry/meshes.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <random>

namespace kerf::cut::embed_test {
namespace {

using geometry::box_mesh;
using geometry::sphere_mesh;
using geometry::together;
using grid::EdgeId;

const Vec3 midway = Vec3::Constant(0.5);

std::size_t n_material(const grid::Grid& grid) {
  std::size_t n = 0;
  for (const auto node : ids<grid::NodeId>(grid.n_nodes()))
    n += grid.is_material(node) ? 1 : 0;
  return n;
}

/// What holds for every embedding.
void expect_consistent(const Embedding& e) {
  std::size_t n_cut = 0;
  for (const EdgeId edge : ids<EdgeId>(e.solid.grid.n_edges())) {
    const auto& [lower, upper] = e.solid.grid.ends(edge);
    ASSERT_EQ(e.solid.cuts.is_cut(edge), e.solid.grid.is_material(lower) != e.solid.grid.is_material(upper));
    n_cut += e.solid.cuts.is_cut(edge) ? 1 : 0;
  }
  ASSERT_EQ(e.solid.cuts.all().size(), n_cut);
  for (const auto& cut : e.solid.cuts.all()) {
    ASSERT_EQ(cut.label, grid::skin_label);
    ASSERT_NEAR(cut.normal.norm(), 1, 1e-12);
    ASSERT_GE(cut.t, grid::min_edge_parameter);
    ASSERT_LE(cut.t, 1 - grid::min_edge_parameter);
  }
  for (const auto c : ids<grid::CellId>(e.solid.grid.n_cells()))
    for (int d = 0; d < 3; ++d)
      ASSERT_GE(e.solid.grid.index(e.solid.grid.nodes(c)[0])[d], 0);
}

void expect_equal(const Embedding& a, const Embedding& b) {
  ASSERT_EQ(a.solid.grid.n_nodes(), b.solid.grid.n_nodes());
  ASSERT_EQ(a.solid.cuts.all().size(), b.solid.cuts.all().size());
  for (std::size_t i = 0; i < a.solid.cuts.all().size(); ++i) {
    ASSERT_EQ(a.solid.cuts.all()[i].edge, b.solid.cuts.all()[i].edge);
    ASSERT_EQ(a.solid.cuts.all()[i].t, b.solid.cuts.all()[i].t);
    ASSERT_EQ(a.solid.cuts.all()[i].normal, b.solid.cuts.all()[i].normal);
  }
}

void expect_nodes(const Embedding& e, const std::function<bool(const Vec3&)>& is_inside, const Box& box) {
  const grid::Lattice& lattice = e.solid.grid.lattice();
  Index3 n;
  for (int d = 0; d < 3; ++d)
    n[d] = static_cast<int>((box.upper[d] - lattice.origin[d]) / lattice.h) + 3;
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k) {
        const auto node = e.solid.grid.find_node({i, j, k});
        const bool is_material = node && e.solid.grid.is_material(*node);
        ASSERT_EQ(is_material, is_inside(lattice.position({i, j, k}))) << i << ' ' << j << ' ' << k;
      }
}

class Offsets : public testing::TestWithParam<int> {
 protected:
  /// Sub-cell offsets, degenerate ones among them.
  Vec3 offset() const {
    constexpr std::array<double, 5> parts = {0, 0.25, 0.5, 0.9999, -1};
    const int i = GetParam();
    return {parts[i % 5], parts[(i + i / 5) % 5], parts[(2 * i + 1) % 5]};
  }
};

TEST_P(Offsets, BoxOnLatticePlanes) {
  // Corners and h are binary fractions, so at offset 0 every face lies exactly in a plane of nodes.
  const Vec3 lower(-0.5, 0.25, 1), upper(0.5, 1, 1.5);
  const double h = 0.125;
  const Embedding e = embed(box_mesh(lower, upper), h, offset());
  expect_consistent(e);
  EXPECT_EQ(n_material(e.solid.grid), 8u * 6 * 4) << "one node a cube, wherever the lattice is";
  EXPECT_EQ(e.solid.cuts.all().size(), 2u * (8 * 6 + 6 * 4 + 4 * 8));
  EXPECT_EQ(e.n_thin_walls + e.n_thin_gaps, 0u);
  EXPECT_EQ(e.n_lost_components, 0u);
  expect_nodes(e,
               [&](const Vec3& p) { // the box moved by d
                 return (p.array() > lower.array()).all() && (p.array() <= upper.array()).all();
               },
               {lower, upper});
  for (const auto& cut : e.solid.cuts.all())
    EXPECT_EQ(cut.normal.cwiseAbs(), Vec3(Vec3::Unit(e.solid.grid.axis(cut.edge))));
}

TEST_P(Offsets, CutsLieOnTheBox) {
  const Vec3 lower(0.1, 0.2, 0.3), upper(1.13, 1.27, 0.91);
  const Embedding e = embed(box_mesh(lower, upper), 0.1, offset());
  expect_consistent(e);
  for (const auto& cut : e.solid.cuts.all()) {
    const int axis = e.solid.grid.axis(cut.edge);
    const double x = grid::edge_point(e.solid, cut.edge)[axis];
    EXPECT_LT(std::min(std::abs(x - lower[axis]), std::abs(x - upper[axis])), 0.1 * grid::min_edge_parameter + 1e-12);
  }
}

TEST_P(Offsets, OctahedronAgreesWithItsFormula) {
  // |x| + |y| + |z| < 1, all edges and faces through lattice points at offset 0; a node on it is inside where the
  // displacement takes the surface beyond it.
  const Vec3 centre(3, 3, 3);
  const Embedding e = embed(sphere_mesh(1, centre, 0), 0.125, offset());
  expect_consistent(e);
  expect_nodes(
    e,
    [&](const Vec3& p) {
      const Vec3 q = p - centre;
      const double distance = q.lpNorm<1>() - 1;
      if (distance != 0)
        return distance < 0;
      // Moving the point by -d changes |q| by -sign(q_x) eps - ..., or by +eps where q_x is 0.
      return q[0] > 0;
    },
    geometry::bounding_box(sphere_mesh(1, centre, 0)));
}

TEST_P(Offsets, SphereKeepsItsVolume) {
  const double h = 0.05;
  const Embedding e = embed(sphere_mesh(1, {0.1, 0.2, 0.3}, 5), h, offset());
  expect_consistent(e);
  const double volume = geometry::volume(sphere_mesh(1, {0.1, 0.2, 0.3}, 5));
  EXPECT_NEAR(n_material(e.solid.grid) * h * h * h / volume, 1, 5e-3);
  for (const auto& cut : e.solid.cuts.all()) {
    const Vec3 radius = grid::edge_point(e.solid, cut.edge) - Vec3(0.1, 0.2, 0.3);
    EXPECT_NEAR(radius.norm(), 1, 1e-3);
    EXPECT_GT(cut.normal.dot(radius.normalized()), 0.998);
  }
}

INSTANTIATE_TEST_SUITE_P(SubCell, Offsets, testing::Range(0, 25));

TEST(Embed, RandomTetrahedraOnLatticePoints) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> number(0, 6);
  int n_embedded = 0;
  for (int i = 0; i < 300; ++i) {
    geometry::TriangleMesh mesh;
    for (int v = 0; v < 4; ++v)
      mesh.vertices.emplace_back(number(random), number(random), number(random));
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    try {
      expect_consistent(embed(mesh, 1, Vec3::Zero()));
      ++n_embedded;
    } catch (const DataError&) { // no node inside: flat or thin
    }
  }
  EXPECT_GT(n_embedded, 150);
}

/// Along a space diagonal: far more rows of the lattice are beside it than meet it.
TEST(Embed, ThinRodAskew) {
  const double length = 60, width = 2.3;
  geometry::TriangleMesh mesh = box_mesh(Vec3::Zero(), {width, width, length});
  for (Vec3& v : mesh.vertices)
    v += v[2] * Vec3(1, 1, 0);
  const Embedding e = embed(mesh, 1, {0.31, 0.42, 0.77});
  expect_consistent(e);
  expect_nodes(
    e,
    [&](const Vec3& p) {
      const double x = p[0] - p[2], y = p[1] - p[2];
      return std::min({x, y, p[2]}) > 0 && std::max(x, y) < width && p[2] < length;
    },
    geometry::bounding_box(mesh));
}

TEST(Embed, CountsWhatTheGridCannotResolve) {
  // A plate thinner than an edge between two planes of nodes, beside a cube.
  const auto cube = box_mesh({0, 0, 0}, {4, 4, 4});
  const auto plate = box_mesh({6.1, 0, 0}, {6.4, 4, 4});
  const Embedding e = embed(together(cube, plate), 1, midway);
  expect_consistent(e);
  EXPECT_EQ(n_material(e.solid.grid), 64u);
  EXPECT_EQ(e.n_thin_walls, 16u);
  EXPECT_EQ(e.n_thin_gaps, 0u);
  EXPECT_EQ(e.n_lost_components, 1u);

  // A thin void just under the skin: three crossings of each edge of the cube's top but its border.
  const auto slit = inside_out(box_mesh({1, 1, 3.6}, {3, 3, 3.8}));
  const Embedding f = embed(together(cube, slit), 1, midway);
  expect_consistent(f);
  EXPECT_EQ(f.n_thin_walls + f.n_thin_gaps, 0u);
  EXPECT_EQ(f.n_triple_crossings, 4u);
  for (const auto& cut : f.solid.cuts.all()) { // the void's bottom is nearest to the material
    const Vec3 p = grid::edge_point(f.solid, cut.edge);
    if (f.solid.grid.axis(cut.edge) == 2 && p[2] > 2 && p[0] > 1 && p[0] < 3 && p[1] > 1 && p[1] < 3) {
      EXPECT_NEAR(p[2], 3.6, 1e-12);
    }
  }
}

TEST(Embed, TellsThinWallsFromThinGaps) {
  // Two halves of a block, apart by less than an edge between two planes of nodes: as if there were no gap.
  const Embedding gap = embed(together(box_mesh({0, 0, 0}, {4, 4, 3.7}), box_mesh({0, 0, 3.9}, {4, 4, 8})), 1, midway);
  expect_consistent(gap);
  EXPECT_EQ(gap.n_thin_gaps, 16u) << "the edges along z between the halves";
  EXPECT_EQ(gap.n_thin_walls, 0u);
  EXPECT_EQ(n_material(gap.solid.grid), 128u);

  // The same gap as a void inside, and a hollow box whose wall is thinner than an edge on one side.
  const auto block = box_mesh({0, 0, 0}, {6, 6, 6});
  const Embedding closed = embed(together(block, inside_out(box_mesh({1, 1, 2.7}, {5, 5, 2.9}))), 1, midway);
  EXPECT_EQ(closed.n_thin_gaps, 16u);
  EXPECT_EQ(closed.n_thin_walls, 0u);
  const Embedding hollow = embed(together(block, inside_out(box_mesh({1, 1, 1}, {5, 5, 5.8}))), 1, Vec3(0.5, 0.5, 0.1));
  EXPECT_EQ(hollow.n_thin_gaps, 0u);
  EXPECT_EQ(hollow.n_thin_walls, 16u) << "no node is between 5.8 and 6: they are at 4.1, 5.1, 6.1";
  // Both at once, one after the other along the same lines.
  const auto plate = box_mesh({0, 0, 9.6}, {6, 6, 9.8});
  const auto slit = inside_out(box_mesh({1, 1, 2.7}, {5, 5, 2.9}));
  const Embedding both = embed(together(together(block, slit), plate), 1, midway);
  EXPECT_EQ(both.n_thin_gaps, 16u);
  EXPECT_EQ(both.n_thin_walls, 36u);
  EXPECT_EQ(both.n_lost_components, 2u) << "the slit and the plate";
}

TEST(Embed, VoidsAreEmpty) {
  const auto mesh = together(box_mesh({0, 0, 0}, {6, 6, 6}), inside_out(box_mesh({2, 2, 2}, {4, 4, 4})));
  const Embedding e = embed(mesh, 1, midway);
  expect_consistent(e);
  EXPECT_EQ(n_material(e.solid.grid), 216u - 8);
  EXPECT_EQ(e.n_lost_components, 0u);
}

TEST(Embed, RefusesWhatIsTooSmallAndWhatIsNotClosed) {
  EXPECT_THROW(embed(box_mesh({0.1, 0.1, 0.1}, {0.4, 0.4, 0.4}), 1, midway), DataError);
  EXPECT_THROW(embed(box_mesh({0, 0, 0}, {1, 1, 1}), 0, midway), ParameterError);
  EXPECT_THROW(embed(box_mesh({0, 0, 0}, {1, 1, 1}), 1e-7, midway), ParameterError);
  EXPECT_THROW(embed(box_mesh({0, 0, 0}, {1, 1, 1}), 0.1, Vec3(2, 0, 0)), ParameterError);
  auto open = box_mesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  EXPECT_THROW(embed(open, 0.1, midway), std::logic_error);
  open = box_mesh({0, 0, 0}, {1, 1, 1});
  open.triangles.erase(open.triangles.begin());
  EXPECT_THROW(embed(open, 0.1, midway), std::logic_error);
}

TEST(Embed, LiverIsTheSameWithOneAndTwoThreads) {
  const auto mesh = geometry::read_mesh(support::checkout() + "/params/meshes/liver_25k.off", 0.001);
  const double h = (geometry::bounding_box(mesh).upper - geometry::bounding_box(mesh).lower).maxCoeff() / 25;
  set_n_threads(1);
  const Embedding one = embed(mesh, h, midway);
  set_n_threads(2);
  const Embedding two = embed(mesh, h, midway);
  expect_consistent(one);
  expect_equal(one, two);
  EXPECT_NEAR(n_material(one.solid.grid) * h * h * h / geometry::volume(mesh), 1, 0.02);
}

TEST(Embed, BenchmarkPrintsNAndSeconds) {
  const auto mesh = sphere_mesh(1, Vec3::Zero(), 6);
  for (const double h : {0.2, 0.1, 0.05, 0.025}) {
    const auto start = std::chrono::steady_clock::now();
    const Embedding e = embed(mesh, h, midway);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::cout << mesh.triangles.size() << " triangles, " << e.solid.grid.n_cells() << " cells, "
              << e.solid.cuts.all().size() << " cuts: " << seconds << " s\n";
    EXPECT_EQ(e.n_thin_walls + e.n_thin_gaps, 0u);
  }
}

/// A plate turned by 45 degrees, thinner and thicker than a face's diagonal; and two plates that pass through the same
/// cells, which the grid parts rightly.
TEST(Embed, CountsCellsThatPartAWallOfTheMesh) {
  const auto turned = [](const double from, const double to) {
    geometry::TriangleMesh plate = box_mesh(Vec3(-5, -2, from), Vec3(5, 2, to));
    for (Vec3& v : plate.vertices)
      v = Vec3(std::sqrt(0.5) * (v[0] + v[2]), v[1], std::sqrt(0.5) * (v[2] - v[0]));
    return plate;
  };
  const auto count = [](const geometry::TriangleMesh& mesh, const Vec3& offset) {
    grid::Solid solid = embed(mesh, 1, offset).solid;
    solid.complex = grid::build_complex(solid);
    return n_severed_cells(mesh, solid);
  };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0, 1);
  std::size_t n_severed = 0;
  for (int i = 0; i < 20; ++i) {
    const Vec3 offset(part(random), part(random), part(random));
    n_severed += count(turned(-0.6, 0.6), offset) > 0;
    EXPECT_EQ(count(turned(-0.75, 0.75), offset), 0u);
    EXPECT_EQ(count(together(turned(-2, -0.05), turned(0.05, 2)), offset), 0u);
  }
  EXPECT_GT(n_severed, 3u);
  EXPECT_LT(n_severed, 20u);
}

} // namespace
} // namespace kerf::cut::embed_test
