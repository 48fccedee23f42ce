#pragma once

/// Meshes that are fitted to a body: quadrilaterals in a plane, extruded to hexahedra, and cracks whose vertices are
/// double.
///
/// All is built from a mesh of the plane: a grid of rectangles, which a map may bend, or a disc. Cells shrink towards
/// edges and fronts by lists of coordinates (graded()), as far as one likes; deal.II refines from there.

#include "base/vec.h"

#include <functional>

namespace kerf::reference {

/// What lies between the vertices of a cell.
enum class Sides {
  straight,
  round,  ///< arcs around the z axis, at all of its four or eight vertices
  blended ///< arcs where it meets a round cell, else straight, and smooth between
};

struct Mesh {
  int dimension = 2;                               ///< 2: quadrilaterals, z = 0 (plane strain); 3: hexahedra
  Points vertices;                                 ///< [m]
  std::vector<std::array<std::uint32_t, 8>> cells; ///< vertices in deal.II's order; a quadrilateral has the first four
  std::vector<Sides> sides;                        ///< per cell
};

/// Coordinates from `lower` to `upper` [m], both included, in n intervals that shrink by `ratio` each towards the lower
/// end: at lower + (upper - lower) ratio^(n - i). ratio in (0, 1).
std::vector<double> graded(double lower, double upper, int n, double ratio);
/// The same towards both ends, 2 n intervals.
std::vector<double> graded_to_both(double lower, double upper, int n, double ratio);
/// n equal intervals.
std::vector<double> equal(double lower, double upper, int n);

/// Rectangles between the coordinates [m], each list ascending.
Mesh rectangles(const std::vector<double>& x, const std::vector<double>& y);

/// A disc around the origin, of rings between the ascending radii [m] and a core in the first of them; eight cells
/// around.
Mesh disc(const std::vector<double>& radii);
/// Its quarter with x >= 0 and y >= 0.
Mesh quarter_disc(const std::vector<double>& radii);
/// The same quarter, within the square of edge `width` [m], its corner in the origin.
Mesh quarter_disc_in_square(const std::vector<double>& radii, double width);
/// The disc within the square of edge 2 `width`, its centre in the origin.
Mesh disc_in_square(const std::vector<double>& radii, double width);

/// Hexahedra over each cell of a plane mesh, between the ascending coordinates z [m].
Mesh extruded(const Mesh& plane, const std::vector<double>& z);

/// Moves each vertex; for meshes whose cells are all straight.
void map_vertices(Mesh& mesh, const std::function<Vec3(const Vec3&)>& to);

/// Parts the cells at all faces (of quadrilaterals: edges) that lie in the plane through `point` across `normal` and
/// whose vertices are all `within` a patch or on its border: vertices there are made double, but those at the crack's
/// front, around which cells still hold together. Returns how many faces were parted.
std::size_t split(Mesh& mesh, const Vec3& point, const Vec3& normal, const std::function<bool(const Vec3&)>& within);

} // namespace kerf::reference
