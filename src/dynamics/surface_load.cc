#include "dynamics/surface_load.h"

#include "base/error.h"

#include <Eigen/Geometry>

namespace kerf::dynamics {

namespace {

/// Twice the area times the normal of a triangle.
Vec3 double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

} // namespace

void check(const SurfacePatch& patch) {
  if (patch.points.n_points() != patch.rest.size())
    throw ParameterError("a surface load needs a rest position for each vertex");
  for (const Triangle& triangle : patch.triangles)
    for (const auto vertex : triangle)
      if (vertex >= patch.rest.size())
        throw ParameterError("a surface load has a triangle of a vertex that it does not know");
}

void require_triangles(const SurfacePatch& patch) {
  if (patch.triangles.empty())
    throw ParameterError(Complaint{.rule = "acts on nothing: no triangle of these faces is in the box",
                                   .remedy = "Check Faces, Lower [m] and Upper [m]: rest positions, in metres"});
}

double rest_area(const SurfacePatch& patch) {
  double sum = 0;
  for (const auto& [a, b, c] : patch.triangles)
    sum += 0.5 * double_area(patch.rest[a], patch.rest[b], patch.rest[c]).norm();
  return sum;
}

Traction::Traction(SurfacePatch patch, Field traction) : patch_(std::move(patch)), traction_(std::move(traction)) {
  check(patch_);
}

Loan<Vec3> Traction::vertex_forces(const double time) const {
  Loan<Vec3> forces(patch_.rest.size(), Vec3::Zero());
  for (const auto& triangle : patch_.triangles) {
    Vec3 t[3], sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      sum += t[k] = traction_(patch_.rest[triangle[k]], time);
    const auto& [a, b, c] = triangle;
    const double area = 0.5 * double_area(patch_.rest[a], patch_.rest[b], patch_.rest[c]).norm();
    for (int k = 0; k < 3; ++k)
      forces[triangle[k]] += area / 12 * (sum + t[k]);
  }
  return forces;
}

double Traction::energy(const double time, const Points& x) const {
  const Loan<Vec3> forces = vertex_forces(time);
  double sum = 0;
  for (std::size_t i = 0; i < forces.size(); ++i)
    if (!forces[i].isZero(0))
      sum -= forces[i].dot(patch_.points.at(i, x) - patch_.rest[i]);
  return sum;
}

void Traction::add_force(const Moment& moment, Points& forces) const {
  const Loan<Vec3> of_vertices = vertex_forces(moment.time);
  for (std::size_t i = 0; i < of_vertices.size(); ++i)
    if (!of_vertices[i].isZero(0))
      patch_.points.add_force(i, of_vertices[i], forces);
}

Pressure::Pressure(SurfacePatch patch, ScalarField pressure)
  : patch_(std::move(patch)), pressure_(std::move(pressure)) {
  check(patch_);
}

double Pressure::mean_pressure(const Triangle& triangle, const double time) const {
  double sum = 0;
  for (const auto vertex : triangle)
    sum += pressure_(patch_.rest[vertex], time);
  return sum / 3;
}

void Pressure::add_force(const Moment& moment, Points& forces) const {
  for (const Triangle& triangle : patch_.triangles) {
    Vec3 x[3];
    for (int k = 0; k < 3; ++k)
      x[k] = patch_.points.at(triangle[k], moment.x);
    const Vec3 force = -mean_pressure(triangle, moment.time) / 6 * double_area(x[0], x[1], x[2]);
    for (const auto vertex : triangle)
      patch_.points.add_force(vertex, force, forces);
  }
}

void Pressure::add_tangent(const Tangent kind, const Moment& moment, double, LoadTangent& tangent) const {
  if (kind == Tangent::positive)
    return;
  for (const Triangle& triangle : patch_.triangles) {
    Vec3 x[3];
    for (int k = 0; k < 3; ++k)
      x[k] = patch_.points.at(triangle[k], moment.x);
    const double factor = mean_pressure(triangle, moment.time) / 6;
    for (int k = 0; k < 3; ++k) {
      const Mat3 block = -factor * cross_matrix(x[(k + 1) % 3] - x[(k + 2) % 3]);
      for (const auto vertex : triangle)
        tangent.add(patch_.points, vertex, triangle[k], block);
    }
  }
}

} // namespace kerf::dynamics
