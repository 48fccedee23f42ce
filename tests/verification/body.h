#pragma once

/// Bodies whose faces lie wherever a problem wants them, on lattice nodes too, and what a problem asks of them.
///
/// A body is the part of space below some planes. Nodes on a plane are outside: with nodes on its faces a box is
/// exactly
/// cells that are full (to grid::min_edge_parameter), without slivers beyond its faces. What no node lies in is
/// missing.

#include "cut/cutter.h"
#include "dynamics/state.h"
#include "fem/hexahedra.h"
#include "surface/surface.h"
#include "tests/support/bodies.h"

#include <functional>

namespace kerf::verification {

struct Body : grid::Solid {
  Points rest() const { return grid::rest_positions(*this); }
};

/// Material where all heights are negative. At least one node must be.
Body convex_body(const grid::Lattice& lattice, const std::vector<support::Plane>& planes, const Box& around);

/// A box in cubes of edge h [m]; `offset`: the distance from its lower faces to the first nodes inside, in parts of h,
/// each in [0, 1); 0 puts nodes on the lower faces.
Body box(const Box& box, double h, const Vec3& offset);

/// A ball around the origin with exact crossings and normals.
Body ball(double radius, double h, const Vec3& offset);

/// Cuts the body where it crosses the plane and `is_cut` accepts the crossing.
void cut(Body& body, const support::Plane& plane, const std::function<bool(const Vec3& crossing)>& is_cut);

/// Cuts the body with a surface, as scenes do for elements.
void cut_at_once(Body& body, const cut::Shape& shape, cut::Fronts fronts = cut::Fronts::of_elements);

/// Cuts the body with a blade, from 0 s to 1 s in so many steps, as scenes do for elements.
void cut_with_blade(Body& body, const cut::Blade& blade, int n_steps);

/// A surface triangle as it is integrated over.
struct SurfacePoint {
  Vec3 position; ///< rest [m]
  Vec3 normal;   ///< outward, of the triangle
  grid::CutLabel label;
};

/// Nodal forces of a traction per rest area [N] over the whole surface, by a rule of degree 8.
Points traction_forces(const Body& body, const std::function<Vec3(const SurfacePoint&)>& traction);
/// The same over the plane x = `x` alone, for a constant traction [Pa].
Points end_forces(const Body& body, double x, const Vec3& traction);

/// The copy that holds the point, and where in its cell.
struct Place {
  grid::CopyId copy;
  Vec3 local; ///< [1]
};
/// That of the nearest material node of the cell. Throws std::logic_error where there is no cell.
Place find(const Body& body, const Vec3& X);

/// Value at a point of what has these values at the corners.
Vec3 value_at(const Body& body, const Points& values, const Vec3& X);
Vec3 value_at(const Body& body, const Points& values, const Place& place);

/// The corners where `is_in` accepts the rest position.
std::vector<std::uint32_t> corners_where(const Points& rest, const std::function<bool(const Vec3&)>& is_in);

/// The part of the cube that the least filled copy has [1].
double smallest_fraction(const fem::Hexahedra& model);

} // namespace kerf::verification
