#include "dynamics/surface_load.h"

#include "base/error.h"
#include "base/sort_unique.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::dynamics {

namespace {

/// Twice the area times the normal of a triangle.
Vec3 double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// Nodes of triangles that are flat between their vertices.
Interpolation flat_nodes(const SurfacePatch& patch) {
  Interpolation nodes;
  std::vector<std::uint32_t> corners;
  std::vector<double> weights;
  for (const Triangle& triangle : patch.triangles)
    for (std::size_t node = 0; node < n_triangle_nodes; ++node) {
      const Vec3 L = triangle_node(node);
      corners.clear();
      weights.clear();
      for (int k = 0; k < 3; ++k)
        for (auto i = patch.points.start[triangle[k]]; i < patch.points.start[triangle[k] + 1]; ++i) {
          corners.push_back(patch.points.corners[i]);
          weights.push_back(L[k] * patch.points.values[i]);
        }
      nodes.add_point(corners, weights);
    }
  return nodes;
}

/// Where a node rests: at rest triangles are flat.
Vec3 rest_of_node(const SurfacePatch& patch, const std::size_t node) {
  const Triangle& triangle = patch.triangles[node / n_triangle_nodes];
  const Vec3 L = triangle_node(node % n_triangle_nodes);
  return L[0] * patch.rest[triangle[0]] + L[1] * patch.rest[triangle[1]] + L[2] * patch.rest[triangle[2]];
}

/// A point of a triangle's image.
struct Tangents {
  Vec3 u = Vec3::Zero(), v = Vec3::Zero(); ///< derivatives of its position
};

class Image {
 public:
  Image(const Interpolation& nodes, const std::size_t triangle, const Points& x) {
    for (std::size_t i = 0; i < n_triangle_nodes; ++i)
      nodes_[i] = nodes.at(n_triangle_nodes * triangle + i, x);
  }
  Tangents at(const TrianglePoint& point) const {
    Tangents tangents;
    for (std::size_t i = 0; i < n_triangle_nodes; ++i) {
      tangents.u += point.du[i] * nodes_[i];
      tangents.v += point.dv[i] * nodes_[i];
    }
    return tangents;
  }

 private:
  std::array<Vec3, n_triangle_nodes> nodes_;
};

/// A pair of a triangle's nodes meets a 3 x 3 matrix [s]x; three such numbers for all pairs.
using PairsOfNodes = std::array<Eigen::Matrix<double, n_triangle_nodes, n_triangle_nodes>, 3>;

/// The corners of a triangle's nodes, each once, and how nodes follow them.
struct CornersOfNodes {
  std::vector<std::uint32_t> corners;
  Eigen::Matrix<double, n_triangle_nodes, Eigen::Dynamic> weights;

  CornersOfNodes(const Interpolation& nodes, const std::size_t triangle) {
    const std::size_t first = n_triangle_nodes * triangle;
    corners.assign(nodes.corners.begin() + nodes.start[first],
                   nodes.corners.begin() + nodes.start[first + n_triangle_nodes]);
    sort_unique(corners);
    weights.setZero(n_triangle_nodes, static_cast<Eigen::Index>(corners.size()));
    for (std::size_t i = 0; i < n_triangle_nodes; ++i)
      for (auto k = nodes.start[first + i]; k < nodes.start[first + i + 1]; ++k) {
        const auto at = std::ranges::lower_bound(corners, nodes.corners[k]);
        weights(static_cast<Eigen::Index>(i), at - corners.begin()) += nodes.values[k];
      }
  }
};

} // namespace

void check(const SurfacePatch& patch) {
  if (patch.points.n_points() != patch.rest.size())
    throw ParameterError("a surface load needs a rest position for each vertex");
  for (const Triangle& triangle : patch.triangles)
    for (const auto vertex : triangle)
      if (vertex >= patch.rest.size())
        throw ParameterError("a surface load has a triangle of a vertex that it does not know");
  if (const std::size_t n = patch.nodes.n_points(); n != 0 && n != n_triangle_nodes * patch.triangles.size())
    throw ParameterError("a surface load needs ten nodes a triangle");
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
  if (patch_.nodes.n_points() == 0)
    patch_.nodes = flat_nodes(patch_);
}

Loan<Vec3> Traction::forces(const double time) const {
  Loan<Vec3> forces(n_triangle_nodes * patch_.triangles.size(), Vec3::Zero());
  for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
    const auto& [a, b, c] = patch_.triangles[t];
    const double twice_area = double_area(patch_.rest[a], patch_.rest[b], patch_.rest[c]).norm();
    const Vec3 of_a = traction_(patch_.rest[a], time), of_b = traction_(patch_.rest[b], time),
               of_c = traction_(patch_.rest[c], time);
    for (const TrianglePoint& q : triangle_rule()) {
      const Vec3 force = q.weight * twice_area * (q.L[0] * of_a + q.L[1] * of_b + q.L[2] * of_c);
      for (std::size_t i = 0; i < n_triangle_nodes; ++i)
        forces[n_triangle_nodes * t + i] += q.shape[i] * force;
    }
  }
  return forces;
}

double Traction::energy(const double time, const Points& x) const {
  const Loan<Vec3> of_nodes = forces(time);
  double sum = 0;
  for (std::size_t i = 0; i < of_nodes.size(); ++i)
    if (!of_nodes[i].isZero(0))
      sum -= of_nodes[i].dot(patch_.nodes.at(i, x) - rest_of_node(patch_, i));
  return sum;
}

void Traction::add_force(const Moment& moment, Points& forces) const {
  const Loan<Vec3> of_nodes = this->forces(moment.time);
  for (std::size_t i = 0; i < of_nodes.size(); ++i)
    if (!of_nodes[i].isZero(0))
      patch_.nodes.add_force(i, of_nodes[i], forces);
}

Pressure::Pressure(SurfacePatch patch, ScalarField pressure)
  : patch_(std::move(patch)), pressure_(std::move(pressure)) {
  check(patch_);
  if (patch_.nodes.n_points() == 0)
    patch_.nodes = flat_nodes(patch_);
  const std::vector<std::uint32_t>& corners = patch_.nodes.corners;
  corners_ = corners_themselves(corners.empty() ? 0 : 1 + *std::ranges::max_element(corners));
}

Vec3 Pressure::pressures(const Triangle& triangle, const double time) const {
  return {pressure_(patch_.rest[triangle[0]], time), pressure_(patch_.rest[triangle[1]], time),
          pressure_(patch_.rest[triangle[2]], time)};
}

void Pressure::add_force(const Moment& moment, Points& forces) const {
  for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
    const Vec3 p = pressures(patch_.triangles[t], moment.time);
    if (p.isZero(0))
      continue;
    const Image image(patch_.nodes, t, moment.x);
    std::array<Vec3, n_triangle_nodes> of_nodes;
    of_nodes.fill(Vec3::Zero());
    for (const TrianglePoint& q : triangle_rule()) {
      const Tangents x = image.at(q);
      const Vec3 force = -q.weight * p.dot(q.L) * x.u.cross(x.v);
      for (std::size_t i = 0; i < n_triangle_nodes; ++i)
        of_nodes[i] += q.shape[i] * force;
    }
    for (std::size_t i = 0; i < n_triangle_nodes; ++i)
      patch_.nodes.add_force(n_triangle_nodes * t + i, of_nodes[i], forces);
  }
}

/// -d(force on a)/dx_c = int p L_a (L_c,v [x_u]x - L_c,u [x_v]x).
void Pressure::add_tangent(const Tangent kind, const Moment& moment, double, LoadTangent& tangent) const {
  if (kind == Tangent::positive)
    return;
  for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
    const Vec3 p = pressures(patch_.triangles[t], moment.time);
    if (p.isZero(0))
      continue;
    const Image image(patch_.nodes, t, moment.x);
    PairsOfNodes pairs;
    for (auto& one : pairs)
      one.setZero();
    for (const TrianglePoint& q : triangle_rule()) {
      const Tangents x = image.at(q);
      const Eigen::Map<const Eigen::Matrix<double, n_triangle_nodes, 1>> L(q.shape.data()), du(q.du.data()),
        dv(q.dv.data());
      for (int k = 0; k < 3; ++k)
        pairs[k] += q.weight * p.dot(q.L) * L * (x.u[k] * dv - x.v[k] * du).transpose();
    }
    const CornersOfNodes of(patch_.nodes, t);
    std::array<Eigen::MatrixXd, 3> by_corner;
    for (int k = 0; k < 3; ++k)
      by_corner[k] = of.weights.transpose() * pairs[k] * of.weights;
    for (std::size_t a = 0; a < of.corners.size(); ++a)
      for (std::size_t c = 0; c < of.corners.size(); ++c)
        tangent.add(corners_, of.corners[a], of.corners[c],
                    cross_matrix(Vec3(by_corner[0](a, c), by_corner[1](a, c), by_corner[2](a, c))));
  }
}

} // namespace kerf::dynamics
