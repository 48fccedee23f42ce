#include "dynamics/skin_support.h"

#include "base/error.h"

#include <Eigen/Geometry>

#include <numeric>

namespace kerf::dynamics {

namespace {

/// Of each vertex, a third of the rest area of its triangles [m^2].
std::vector<double> vertex_areas(const SurfacePatch& patch) {
  std::vector<double> areas(patch.rest.size(), 0.0);
  for (const Triangle& triangle : patch.triangles) {
    const auto& [a, b, c] = triangle;
    const double area = 0.5 * (patch.rest[b] - patch.rest[a]).cross(patch.rest[c] - patch.rest[a]).norm();
    for (const auto vertex : triangle)
      areas[vertex] += area / 3;
  }
  return areas;
}

} // namespace

SkinSupport::SkinSupport(const SurfacePatch& patch, const double stiffness, Support hold)
  : stiffness_(stiffness), hold_(std::move(hold)) {
  check(patch);
  if (!(stiffness > 0))
    throw ParameterError(Complaint{.path = "Skin stiffness [1]",
                                   .value = to_text(stiffness),
                                   .rule = "must make a stiffness > 0",
                                   .remedy = "A support resists, it does not push"});
  const std::vector<double> areas = vertex_areas(patch);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (areas[i] == 0)
      continue;
    const auto begin = patch.points.start[i], n = patch.points.start[i + 1] - begin;
    points_.add_row(std::span(patch.points.columns).subspan(begin, n),
                    std::span(patch.points.values).subspan(begin, n));
    rest_.push_back(patch.rest[i]);
    areas_.push_back(areas[i]);
  }
}

double SkinSupport::area() const { return std::accumulate(areas_.begin(), areas_.end(), 0.0); }

double SkinSupport::energy(const double time, const Points& x) const {
  const auto place = hold_.places(time);
  double sum = 0;
  for (std::size_t i = 0; i < areas_.size(); ++i)
    sum += 0.5 * stiffness_ * areas_[i] * (hold_.held * (points_.at(i, x) - place(rest_[i]))).squaredNorm();
  return sum;
}

void SkinSupport::add_force(const Moment& moment, Points& forces) const {
  const auto place = hold_.places(moment.time);
  for (std::size_t i = 0; i < areas_.size(); ++i) {
    const Vec3 missing = hold_.held * (place(rest_[i]) - points_.at(i, moment.x));
    points_.add_force(i, stiffness_ * areas_[i] * missing, forces);
  }
}

void SkinSupport::add_tangent(Tangent, const Moment&, double, LoadTangent& tangent) const {
  for (std::size_t i = 0; i < areas_.size(); ++i)
    tangent.add(points_, i, i, stiffness_ * areas_[i] * hold_.held);
}

} // namespace kerf::dynamics
