#pragma once

/// A cut by a surface that is known at once, instead of swept step by step (thesis §2.4.3 limits sweeps to two edges of
/// a cell a step; what is known at once needs no such limit): a plane, a sphere, a closed cylinder, a disc, a
/// rectangle, a mesh.
///
/// Method: a signed function of position alone is sampled at the ends of each current edge: f < 0 is below a plane or
/// inside a body, and 0 counts as positive. Plane, sphere and cylinder cut an edge when its ends have different signs:
/// what they cut is the border of a set of nodes, so it has no hole, whatever the rounding. A disc cuts an edge that
/// its plane cuts at less than the radius from its centre, a rectangle one that its plane cuts between its sides. Where
/// along the edge follows in closed form. A mesh, open or closed, cuts like a sweep (recut.h): edges that an odd number
/// of its triangles cross, by exact predicates. So where a mesh runs through itself, or lies on itself twice, the edges
/// that it crosses evenly stay whole.
///
/// Limit: an edge inside the body is cut once, so where a sphere or cylinder passes an edge between its two ends, it is
/// left whole and counted.

#include "cut/recut.h"
#include "geometry/triangle_mesh.h"

#include <string>
#include <variant>

namespace kerf::cut {

/// All shapes are in the world frame, current configuration.
struct Plane {
  Vec3 point = Vec3::Zero();   ///< [m]
  Vec3 normal = Vec3::UnitZ(); ///< unit
};

/// Of a point above the plane [m]: 0, and so above it, where it lies nearer to that than some hundred times what its
/// coordinates are rounded by. A skin that lies right in a plane, as midway through a box, is not to be parted by
/// round-off, here and there.
double height_above(const Plane& plane, const Vec3& p);

struct Sphere {
  Vec3 centre = Vec3::Zero(); ///< [m]
  double radius = 0;          ///< [m]
};

/// Closed: the side and both end faces cut.
struct Cylinder {
  Vec3 centre = Vec3::Zero(); ///< halfway between the end faces [m]
  Vec3 axis = Vec3::UnitZ();  ///< unit
  double radius = 0;          ///< [m]
  double height = 0;          ///< from end face to end face [m]
};

struct Disc {
  Vec3 centre = Vec3::Zero();  ///< [m]
  Vec3 normal = Vec3::UnitZ(); ///< unit
  double radius = 0;           ///< [m]
};

/// Two sides at right angles.
struct Rectangle {
  Vec3 centre = Vec3::Zero();                                   ///< [m]
  Vec3 first_side = Vec3::UnitX(), second_side = Vec3::UnitY(); ///< direction and length [m]
};

using Shape = std::variant<Plane, Sphere, Cylinder, Disc, Rectangle, geometry::TriangleMesh>;

struct CutSurface {
  std::string name;
  Shape shape;
  grid::CutLabel label = 1;
};

/// Throws ParameterError, with the key at fault as path: a radius or height that is not > 0, a direction that is not a
/// unit vector, sides of no length or not at right angles, numbers that are not finite, a mesh without triangles.
void check(const CutSurface& surface);

/// The edges that the surface cuts when the corners are at `x` [m, world frame, one a corner]; check() must accept the
/// surface. `boxes`, fitted to x, spare it edges that are far away; null for none. Throws NumericalError when a corner
/// is not at a finite position.
SweepCuts cut_edges(const CutSurface& surface, const grid::Solid& solid, const Points& x,
                    const EdgeBoxes* boxes = nullptr);

} // namespace kerf::cut
