#include "dynamics/surface_load.h"

#include "base/error.h"

#include <Eigen/Geometry>

namespace kerf::dynamics {

namespace {

/// Twice the area times the normal of a triangle.
Vec3 double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// Calls f(vertex, weight) for what is linear between the vertices: half of the k-th one's value, a quarter of the
/// others'.
template <class Function>
void for_each_weight(const Triangle& triangle, const std::size_t k, const Function& f) {
  for (std::size_t j = 0; j < 3; ++j)
    f(triangle[j], j == k ? 0.5 : 0.25);
}

Interpolation means_of_linear(const SurfacePatch& patch) {
  Interpolation means;
  std::vector<std::uint32_t> corners;
  std::vector<double> weights;
  for (const Triangle& triangle : patch.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      corners.clear();
      weights.clear();
      for_each_weight(triangle, k, [&](const std::uint32_t vertex, const double weight) {
        for (auto i = patch.points.start[vertex]; i < patch.points.start[vertex + 1]; ++i) {
          corners.push_back(patch.points.corners[i]);
          weights.push_back(weight * patch.points.values[i]);
        }
      });
      means.add_point(corners, weights);
    }
  return means;
}

/// Where a mean rests: at rest triangles are flat.
Vec3 mean_rest(const SurfacePatch& patch, const std::size_t mean) {
  Vec3 sum = Vec3::Zero();
  for_each_weight(patch.triangles[mean / 3], mean % 3,
                  [&](const std::uint32_t vertex, const double weight) { sum += weight * patch.rest[vertex]; });
  return sum;
}

} // namespace

void check(const SurfacePatch& patch) {
  if (patch.points.n_points() != patch.rest.size())
    throw ParameterError("a surface load needs a rest position for each vertex");
  for (const Triangle& triangle : patch.triangles)
    for (const auto vertex : triangle)
      if (vertex >= patch.rest.size())
        throw ParameterError("a surface load has a triangle of a vertex that it does not know");
  if (const std::size_t n = patch.means.n_points(); n != 0 && n != 3 * patch.triangles.size())
    throw ParameterError("a surface load needs three means a triangle");
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
  if (patch_.means.n_points() == 0)
    patch_.means = means_of_linear(patch_);
}

Loan<Vec3> Traction::forces(const double time) const {
  Loan<Vec3> forces(3 * patch_.triangles.size(), Vec3::Zero());
  for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
    const auto& [a, b, c] = patch_.triangles[t];
    const double area = 0.5 * double_area(patch_.rest[a], patch_.rest[b], patch_.rest[c]).norm();
    for (std::size_t k = 0; k < 3; ++k)
      forces[3 * t + k] = area / 3 * traction_(patch_.rest[patch_.triangles[t][k]], time);
  }
  return forces;
}

double Traction::energy(const double time, const Points& x) const {
  const Loan<Vec3> of_means = forces(time);
  double sum = 0;
  for (std::size_t i = 0; i < of_means.size(); ++i)
    if (!of_means[i].isZero(0))
      sum -= of_means[i].dot(patch_.means.at(i, x) - mean_rest(patch_, i));
  return sum;
}

void Traction::add_force(const Moment& moment, Points& forces) const {
  const Loan<Vec3> of_means = this->forces(moment.time);
  for (std::size_t i = 0; i < of_means.size(); ++i)
    if (!of_means[i].isZero(0))
      patch_.means.add_force(i, of_means[i], forces);
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
