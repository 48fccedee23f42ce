/// The local numbering against deal.II's own.

#include "grid/cube.h"

#include <deal.II/base/geometry_info.h>

#include <gtest/gtest.h>

#include <bit>
#include <set>

namespace kerf::grid::cube::cube_test {
namespace {

using Info = dealii::GeometryInfo<3>;

TEST(Cube, NumbersAsDealIIDoes) {
  ASSERT_EQ(n_vertices, int(Info::vertices_per_cell));
  ASSERT_EQ(n_lines, int(Info::lines_per_cell));
  ASSERT_EQ(n_faces, int(Info::faces_per_cell));
  for (int line = 0; line < n_lines; ++line)
    for (int end = 0; end < 2; ++end)
      EXPECT_EQ(line_vertices[line][end], int(Info::line_to_cell_vertices(line, end))) << line;
  for (int face = 0; face < n_faces; ++face)
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(face_vertices[face][i], int(Info::face_to_cell_vertices(face, i))) << face;
      EXPECT_EQ(face_lines[face][i], int(Info::face_to_cell_lines(face, i))) << face;
    }
}

TEST(Cube, PutsVerticesWhereDealIIDoes) {
  for (int v = 0; v < n_vertices; ++v) {
    const auto p = Info::unit_cell_vertex(v);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(v >> axis & 1, int(p[axis]));
  }
  for (int face = 0; face < n_faces; ++face) {
    EXPECT_EQ(face_axis(face), int(Info::unit_normal_direction[face]));
    EXPECT_EQ(face & 1, (Info::unit_normal_orientation[face] + 1) / 2);
  }
}

TEST(Cube, FindsLinesAndFacesAtAVertex) {
  for (int v = 0; v < n_vertices; ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const int line = line_at(v, axis);
      ASSERT_GE(line, 0);
      const std::set<int> ends = {int(Info::line_to_cell_vertices(line, 0)), int(Info::line_to_cell_vertices(line, 1))};
      EXPECT_EQ(ends, (std::set<int>{v & ~(1 << axis), v | (1 << axis)}));
      EXPECT_EQ(line_axis(line), axis);

      const int face = face_at(v, axis);
      EXPECT_EQ(int(Info::unit_normal_direction[face]), axis);
      bool holds = false;
      for (int i = 0; i < 4; ++i)
        holds |= int(Info::face_to_cell_vertices(face, i)) == v;
      EXPECT_TRUE(holds) << "face " << face << " at vertex " << v;
      EXPECT_TRUE(face_mask(face) >> v & 1);
      EXPECT_EQ(std::popcount(face_mask(face)), 4);
    }
}

/// Smallest-label propagation, the slow way.
std::uint8_t flooded(const int from, const unsigned cut_lines, const unsigned allowed) {
  std::set<int> reached = {from};
  for (int round = 0; round < n_vertices; ++round)
    for (int line = 0; line < n_lines; ++line) {
      const int a = Info::line_to_cell_vertices(line, 0), b = Info::line_to_cell_vertices(line, 1);
      if ((cut_lines >> line & 1) || !(allowed >> a & 1) || !(allowed >> b & 1))
        continue;
      if (reached.contains(a) || reached.contains(b))
        reached.insert({a, b});
    }
  unsigned bits = 0;
  for (const int v : reached)
    bits |= 1u << v;
  return static_cast<std::uint8_t>(bits);
}

TEST(Cube, ReachesWhatAFloodReaches) {
  for (unsigned cut_lines = 0; cut_lines < 4096; ++cut_lines)
    for (int v = 0; v < n_vertices; ++v) {
      ASSERT_EQ(reachable(v, cut_lines), flooded(v, cut_lines, 0xff));
      for (int axis = 0; axis < 3; ++axis) {
        const unsigned face = face_mask(face_at(v, axis));
        ASSERT_EQ(reachable(v, cut_lines, face), flooded(v, cut_lines, face));
      }
    }
}

} // namespace
} // namespace kerf::grid::cube::cube_test
