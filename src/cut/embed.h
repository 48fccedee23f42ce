#pragma once

/// The closed input mesh as the first cut (thesis §2.7): which lattice nodes are material, and where the skin cuts
/// edges.
///
/// Method: along every lattice line in x, y and z that meets a triangle, the crossing is found with exact predicates
/// under the rule of geometry/predicates.h, and put into the interval [i, i+1] whose ends lie on different sides of the
/// triangle. Nodes of an x line are material between odd and even crossings. Crossings are sorted, so the result
/// depends neither on the order of the triangles nor on threads; memory grows with the surface, plus the material nodes
/// themselves. Since the displaced surface is closed, y and z lines must tell the same classes; that is checked.
///
/// The normal of a skin cut is the mesh's, averaged over two fifths of a cube edge but not across its sharp edges.
///
/// Limit: what is thinner than an edge and passes between nodes is lost: walls vanish, gaps are filled. Both are
/// counted, by edges, and not repaired. Walls at 45 degrees to the grid may come apart when they are thinner than
/// sqrt(2) cubes, as nodes side by side in them have no edge between: n_severed_cells().

#include "geometry/triangle_mesh.h"
#include "grid/solid.h"

namespace kerf::cut {

struct Embedding {
  grid::Solid solid;            ///< cut by the skin: every edge between a material and an empty node; no copies yet
  std::size_t n_thin_walls = 0; ///< edges with both ends empty that the mesh crosses 2, 4, ... times: left uncut
  std::size_t n_thin_gaps = 0;  ///< edges with both ends material that it crosses so: left uncut
  std::size_t n_triple_crossings = 0; ///< edges crossed 3, 5, ... times: cut nearest to their material end only
  std::size_t n_components = 0;       ///< connected shells of the mesh
  std::size_t n_lost_components = 0;  ///< connected shells of the mesh that cut no edge
};

/// Embeds a solid mesh (geometry/solid.h) in cubes of edge h [m]. The lattice starts two cubes below the mesh's
/// bounding box, moved by `offset` in parts of h, each in [-1, 1] [1]; an offset of 0 puts a face at the lower end of
/// the bounding box right on nodes, 0.5 midway. Throws DataError when no node is inside the mesh, ParameterError when h
/// or the offset is out of range, std::logic_error when the mesh is not closed.
Embedding embed(const geometry::TriangleMesh& mesh, double h, const Vec3& offset);

/// How many cells of an uncut body part nodes between which the mesh is whole: the straight way from a node of one copy
/// to one of another does not meet it.
std::size_t n_severed_cells(const geometry::TriangleMesh& mesh, const grid::Solid& solid);

} // namespace kerf::cut
