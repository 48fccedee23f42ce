#include "surface/surface.h"

#include "base/parallel.h"
#include "grid/cube.h"
#include "surface/table.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace kerf::surface {

namespace cube = grid::cube;
using grid::CellComplex;
using grid::CellId;
using grid::CopyId;
using grid::Cuts;
using grid::EdgeId;
using grid::FaceId;
using grid::Grid;

namespace {

constexpr std::uint32_t unset = Id<void>::no_value;

/// Multilinear weight of vertex v at xi in the unit cube, within the edge, face or cell whose vertices are `support`.
double weight(const Vec3& xi, const int v, const unsigned support) {
  constexpr std::array<unsigned, 3> upper = {0xaa, 0xcc, 0xf0}; // vertices with a 1 along x, y, z
  double w = 1;
  for (int axis = 0; axis < 3; ++axis)
    if ((support & upper[axis]) != 0 && (support & ~upper[axis]) != 0)
      w *= v >> axis & 1 ? xi[axis] : 1 - xi[axis];
  return w;
}

/// Collects vertices and triangles cell by cell; a vertex shared by cells is made by the first of them.
class Builder {
 public:
  Builder(const Grid& grid, const Cuts& cuts, const CellComplex& complex)
    : grid_(grid),
      cuts_(cuts),
      complex_(complex),
      first_face_vertex_(grid.n_faces(), unset),
      edge_vertices_(2 * cuts.all().size(), unset),
      centres_(complex.n_copies(), unset) {}

  void add_cell(const CellId cell) {
    const unsigned cut_lines = cuts_.configuration(grid_, cell);
    for (const Quad& quad : splitting_table().row(cut_lines)) {
      const CopyId copy = complex_.copy_at(cell, quad.end);
      if (!copy.valid())
        continue; // the empty side of the skin
      std::array<std::uint32_t, 4> v;
      for (int i = 0; i < 4; ++i)
        v[i] = vertex(cell, copy, quad.vertices[i]);
      const grid::CutLabel label = cuts_.find(grid_.edges(cell)[quad.line])->label;
      for (const Triangle& triangle : {Triangle{v[0], v[1], v[2]}, Triangle{v[0], v[2], v[3]}}) {
        surface_.triangles.push_back(triangle);
        surface_.labels.push_back(label);
        surface_.copies.push_back(copy);
      }
    }
  }

  Surface finish() {
    surface_.weights.resize(static_cast<int>(surface_.rest.size()), static_cast<int>(complex_.n_corners()));
    surface_.weights.setFromTriplets(entries_.begin(), entries_.end());
    return std::move(surface_);
  }

 private:
  std::uint32_t vertex(const CellId cell, const CopyId copy, const TableVertex& v) {
    switch (v.kind) {
      case VertexKind::edge:
        return edge_vertex(cell, copy, v);
      case VertexKind::face:
        return face_vertex(cell, copy, v);
      default:
        return centre(cell, copy);
    }
  }

  std::uint32_t edge_vertex(const CellId cell, const CopyId copy, const TableVertex& v) {
    const EdgeId edge = grid_.edges(cell)[v.index];
    const auto& [lower, upper] = cube::line_vertices[v.index];
    std::uint32_t& id = edge_vertices_[2 * (cuts_.find(edge) - cuts_.all().data()) + (v.side == upper)];
    if (id == unset)
      id = new_vertex(grid::edge_point(grid_, cuts_, edge), cell, copy, (1u << lower) | (1u << upper));
    return id;
  }

  std::uint32_t face_vertex(const CellId cell, const CopyId copy, const TableVertex& v) {
    const FaceId face = grid_.faces(cell)[v.index];
    std::uint32_t& first = first_face_vertex_[face];
    if (first == unset) {
      first = static_cast<std::uint32_t>(face_vertices_.size());
      face_vertices_.resize(face_vertices_.size() + 4, unset);
    }
    const auto& vertices = cube::face_vertices[v.index];
    const auto side = std::find(vertices.begin(), vertices.end(), v.side) - vertices.begin();
    std::uint32_t& id = face_vertices_[first + side];
    if (id == unset)
      id = new_vertex(grid::face_point(grid_, cuts_, face), cell, copy, cube::face_mask(v.index));
    return id;
  }

  std::uint32_t centre(const CellId cell, const CopyId copy) {
    std::uint32_t& id = centres_[copy.value];
    if (id == unset)
      id = new_vertex(grid::cell_point(grid_, cuts_, cell), cell, copy, 0xff);
    return id;
  }

  /// A vertex at rest position p whose weights go to the corners in `support` (bits) of the copy.
  std::uint32_t new_vertex(const Vec3& p, const CellId cell, const CopyId copy, const unsigned support) {
    const int id = static_cast<int>(surface_.rest.size());
    surface_.rest.push_back(p);
    const Vec3 xi = (p - grid_.origin(cell)) / grid_.h();
    for (int v = 0; v < cube::n_vertices; ++v)
      if (support >> v & 1)
        entries_.emplace_back(id, static_cast<int>(complex_.copies[copy].corners[v].value), weight(xi, v, support));
    return static_cast<std::uint32_t>(id);
  }

  const Grid& grid_;
  const Cuts& cuts_;
  const CellComplex& complex_;
  Table<FaceId, std::uint32_t> first_face_vertex_; // into face_vertices_, four a face
  std::vector<std::uint32_t> face_vertices_, edge_vertices_, centres_;
  std::vector<Eigen::Triplet<double>> entries_;
  Surface surface_;
};

} // namespace

Surface build_surface(const Grid& grid, const Cuts& cuts, const CellComplex& complex) {
  Builder builder(grid, cuts, complex);
  for (const CellId cell : ids<CellId>(grid.n_cells()))
    builder.add_cell(cell);
  return builder.finish();
}

void follow(const Surface& surface, const Points& corners, Points& positions) {
  const Weights& w = surface.weights;
  positions.resize(w.rows());
  const int* start = w.outerIndexPtr();
  parallel_for(positions.size(), [&](const std::size_t i) {
    Vec3 p = Vec3::Zero();
    for (int k = start[i]; k < start[i + 1]; ++k)
      p += w.valuePtr()[k] * corners[w.innerIndexPtr()[k]];
    positions[i] = p;
  });
}

double enclosed_volume(const Points& positions, const std::vector<Triangle>& triangles) {
  if (triangles.empty())
    return 0;
  const Vec3 reference = positions[triangles[0][0]]; // near the body: less cancellation
  double six_volumes = 0;
  for (const auto& [a, b, c] : triangles)
    six_volumes += (positions[a] - reference).dot((positions[b] - reference).cross(positions[c] - reference));
  return six_volumes / 6;
}

std::vector<double> piece_volumes(const Surface& surface, const CellComplex& complex) {
  std::vector<double> volumes(complex.n_pieces, 0.0);
  if (surface.triangles.empty())
    return volumes;
  const Vec3 reference = surface.rest[surface.triangles[0][0]];
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    const Vec3 &p = surface.rest[a], &q = surface.rest[b], &r = surface.rest[c];
    volumes[complex.piece[surface.copies[i]]] += (p - reference).dot((q - reference).cross(r - reference)) / 6;
  }
  return volumes;
}

} // namespace kerf::surface
