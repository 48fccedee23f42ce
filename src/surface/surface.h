#pragma once

/// The closed surface of a cut body (thesis §2.4, §2.5) and how it follows the corners: x_surface = W x_corners.
///
/// For each cut edge, each of its material ends s and each of the (up to four) cells around it, one quadrilateral,
/// split along the diagonal edge vertex - centre, which both sides of a cut share. A vertex takes the weights of its
/// place in its copy: linear on an edge, bilinear in a face, trilinear in a cell (§2.4.4, with corners as unknowns
/// instead of extrapolated frames).
///
/// Where a blade has cut below the skin (grid/cuts.h), cuts and skin are two sheets: the quadrilaterals of an edge
/// that is cut twice belong to the one and to the other, and so do the vertices in faces and cells that both pass
/// without meeting. Where they meet, at the rim of a cut, they have their vertices in common.
///
/// A later cut takes no triangle away: a quadrilateral belongs to a cut of an edge. A vertex belongs to a part of a
/// face or cell, and of those that it falls into, the first keeps the vertex. So an update writes the cells around
/// what is new, and appends; a vertex of skin or cut that is taken over by the other sheet may remain without
/// triangles. The order of vertices depends on the sequence of cuts, the surface does not.

#include "base/interpolation.h"
#include "grid/solid.h"

#include <unordered_map>

namespace kerf::surface {

struct Surface {
  Points rest;                        ///< rest positions of the vertices [m]
  std::vector<Triangle> triangles;    ///< counter-clockwise from outside; those of a cut edge follow each other
  std::vector<grid::CutLabel> labels; ///< per triangle: which cut made it; 0 is the skin
  std::vector<grid::CopyId> copies;   ///< per triangle: the copy whose material it bounds
  Interpolation weights;              ///< W; those of a vertex sum to 1

  /// Memory of all tables [B].
  std::size_t n_bytes() const;
  void archive(Archive& a) { a(rest, triangles, labels, copies, weights); }
};

/// Which vertex is where: what an update needs to know of the surface beside the surface.
struct SurfaceIndex {
  grid::SparseIndex<grid::FaceId> first_face_vertex;  ///< into face_vertices, where a face has some
  std::vector<std::uint32_t> face_vertices;           ///< four a face: by the component's smallest vertex
  grid::SparseIndex<grid::FaceId> first_sheet_vertex; ///< into face_vertices, where a blade has cut below the skin
  std::vector<std::uint32_t> edge_vertices;           ///< two a cut: of its lower and its upper side
  std::vector<std::uint32_t> first_triangle;          ///< of each cut
  Table<grid::CopyId, std::uint32_t> centres;
  std::unordered_map<std::uint32_t, std::uint32_t>
    skin_centres; ///< by copy, where they are others than those of the cuts

  /// By cell, face and line: the first triangle of the wall there, where a cut meets the skin.
  std::unordered_map<std::uint64_t, std::uint32_t> first_of_wall;

  std::size_t n_bytes() const;
  void archive(Archive& a) {
    a(first_face_vertex, face_vertices, first_sheet_vertex, edge_vertices, first_triangle, centres, skin_centres);
    a(first_of_wall);
  }
};

Surface build_surface(const grid::Solid& solid);

/// The same, for a surface that will be updated.
Surface build_surface(const grid::Solid& solid, SurfaceIndex& index);

/// Brings surface and index up to date with a cut whose vertices have been placed; of earlier ones they know. The cost
/// depends on the new edges alone.
void update_surface(const grid::Solid& solid, const grid::CutChange& change, Surface& surface, SurfaceIndex& index);

/// x_surface = W x_corners [m].
void follow(const Surface& surface, const Points& corners, Points& positions);

/// Signed volume that closed triangles enclose [m^3].
double enclosed_volume(const Points& positions, const std::vector<Triangle>& triangles);

/// Rest volume of each piece [m^3], from the triangles.
std::vector<double> piece_volumes(const Surface& surface, const grid::CellComplex& complex);

} // namespace kerf::surface
