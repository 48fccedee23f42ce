#pragma once

/// Closed meshes of simple bodies, triangles counter-clockwise seen from outside.
///
/// Flat triangles on a curved body enclose less than it. So the vertices of balls and cylinders stand a little outside
/// of it, by as much as makes the volume that of the body to round-off; the skin is then up to edge^2 / (6 radius) off
/// it, to both sides.

#include "geometry/triangle_mesh.h"

namespace kerf::geometry {

TriangleMesh box_mesh(const Vec3& lower, const Vec3& upper);

/// An octahedron whose triangles are split in four n times, its vertices put on the sphere: 8 * 4^n triangles. Encloses
/// less than the sphere.
TriangleMesh sphere_mesh(double radius, const Vec3& centre, int n);

/// A ball, with triangles of edges below `edge` [m], of at least 512 and at most half a million.
TriangleMesh ball_mesh(const Vec3& centre, double radius, double edge);

/// A cylinder along z about the origin, with faces narrower than `edge` [m], at least 48 and at most 4096 of them. Its
/// volume is that of the circular one; moments of inertia about the axis are larger by 3 / n^2 or less for n faces.
TriangleMesh cylinder_mesh(double radius, double height, double edge);

/// The mesh turned about the origin, then shifted by `way` [m].
TriangleMesh placed(TriangleMesh mesh, const Mat3& rotation, const Vec3& way);

} // namespace kerf::geometry
