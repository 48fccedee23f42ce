#pragma once

/// The closed surface of a cut body (thesis §2.4, §2.5) and how it follows the corners: x_surface = W x_corners.
///
/// For each cut edge, each of its material ends s and each of the (up to four) cells around it, one quadrilateral,
/// split along the diagonal edge vertex - centre, which both sides of a cut share. A vertex takes the weights of its
/// place in its copy: linear on an edge, bilinear in a face, trilinear in a cell (§2.4.4, with corners as unknowns
/// instead of extrapolated frames).
///
/// Where blades have cut at the skin, a cell is a polyhedron with more segments (grid/skeleton.h), to which the same
/// rule applies: for each cut segment, each of its ends and each of the polyhedron's two sides there, a triangle. The
/// rim is where they end: on the skin's triangles, which it divides. So the skin keeps its shape, and its parts are
/// those of the cut.
///
/// A later cut takes no triangle away: a triangle belongs to a cut, and the first piece of a divided triangle of the
/// skin has the place of the whole. A vertex belongs to a part of a side or cell, and of those that it falls into, the
/// first keeps the vertex. So an update writes the cells around what is new, and appends. The order of vertices depends
/// on the sequence of cuts, the surface does not.

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
  grid::SparseIndex<grid::FaceId> first_inner_vertex; ///< ten a face: of blades' cuts beside arcs of the skin
  std::vector<std::uint32_t> edge_vertices;           ///< two a cut: of its lower and its upper side
  std::vector<std::uint32_t> first_triangle;          ///< of each cut
  std::vector<std::uint32_t> segment_vertices;        ///< two a cut of the skin: of its ends
  std::vector<std::uint32_t> first_triangle_of_segment;
  Table<grid::CopyId, std::uint32_t> centres;        ///< of cuts
  grid::SparseIndex<grid::CellId> first_skin_centre; ///< into skin_centres, four a cell: by Skeleton::loop
  std::vector<std::uint32_t> skin_centres;
  /// In triangles of the skin that are cut: by cell, triangle and the first of its items; and the pieces after the
  /// first.
  std::unordered_map<std::uint64_t, std::uint32_t> in_skin, pieces_of_skin;
  std::unordered_map<std::uint64_t, std::uint32_t>
    centres_of_joined,  ///< by cell and lowest item of a part (Cuts::joined)
    centres_of_borders; ///< of all borders of a cell but the first: by cell, lowest item of a part, lowest segment

  std::size_t n_bytes() const;
  void archive(Archive& a) {
    a(first_face_vertex, face_vertices, first_inner_vertex, edge_vertices, first_triangle, centres);
    a(segment_vertices, first_triangle_of_segment, first_skin_centre, skin_centres, in_skin, pieces_of_skin,
      centres_of_joined, centres_of_borders);
  }
};

Surface build_surface(const grid::Solid& solid);

/// The same, for a surface that will be updated.
Surface build_surface(const grid::Solid& solid, SurfaceIndex& index);

/// Brings surface and index up to date with a cut whose vertices have been placed; of earlier ones they know. The cost
/// depends on the new edges and fronts alone.
void update_surface(const grid::Solid& solid, const grid::CutChange& change, Surface& surface, SurfaceIndex& index);

/// x_surface = W x_corners [m].
void follow(const Surface& surface, const Points& corners, Points& positions);

/// Signed volume that closed triangles enclose [m^3].
double enclosed_volume(const Points& positions, const std::vector<Triangle>& triangles);

/// Of how many bodies it consists: its closed parts, but those around hollows.
std::size_t n_bodies(const Surface& surface);

/// Rest volume of each piece [m^3], from the triangles.
std::vector<double> piece_volumes(const Surface& surface, const grid::CellComplex& complex);

} // namespace kerf::surface
