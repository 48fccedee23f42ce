#include "dynamics/surface_load.h"

#include "base/error.h"
#include "base/sort_unique.h"

#include <Eigen/Geometry>

#include <map>

namespace kerf::dynamics {

namespace {

/// Twice the area times the normal of a triangle.
Vec3 double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// Vertices that carry flat triangles.
TriangleCarriers flat_carriers(const SurfacePatch& patch) {
  TriangleCarriers carriers{patch.points, {}, {}};
  Eigen::Matrix<double, n_triangle_nodes, 8> linear = Eigen::Matrix<double, n_triangle_nodes, 8>::Zero();
  for (int i = 0; i < n_triangle_nodes; ++i)
    linear.row(i).head<3>() = triangle_node(i);
  for (const auto& [a, b, c] : patch.triangles)
    carriers.of_triangle.push_back({a, b, c, a, a, a, a, a});
  carriers.shape_at_nodes.assign(patch.triangles.size(), linear);
  return carriers;
}

TriangleCarriers carriers_of(const SurfacePatch& patch) {
  check(patch);
  return patch.carriers.of_triangle.empty() ? flat_carriers(patch) : patch.carriers;
}

/// What the corners get of the traction of each vertex [m^2].
Interpolation shares_of_vertices(const SurfacePatch& patch, const TriangleCarriers& carriers) {
  const TriangleRule& rule = triangle_rule();
  const Eigen::Matrix<double, n_triangle_nodes, 3> of_nodes =
    2 * rule.shape.transpose() * rule.weight.asDiagonal() * rule.L;
  std::vector<std::map<std::uint32_t, double>> shares(patch.rest.size());
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
    const auto& [a, b, c] = patch.triangles[t];
    const double area = 0.5 * double_area(patch.rest[a], patch.rest[b], patch.rest[c]).norm();
    const Eigen::Matrix<double, 8, 3> of_corners = area * carriers.shape_at_nodes[t].transpose() * of_nodes;
    for (int k = 0; k < 3; ++k)
      for (int v = 0; v < 8; ++v)
        shares[patch.triangles[t][k]][carriers.of_triangle[t][v]] += of_corners(v, k);
  }
  Interpolation all;
  for (const auto& of_vertex : shares) {
    std::vector<std::uint32_t> corners;
    std::vector<double> values;
    for (const auto& [corner, value] : of_vertex) {
      corners.push_back(corner);
      values.push_back(value);
    }
    all.add_row(corners, values);
  }
  return all;
}

/// Where the corners of carriers are.
Loan<Vec3> places_of(const Interpolation& corners, const Points& x) {
  Loan<Vec3> places(corners.n_points());
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = corners.at(i, x);
  return places;
}

void add_forces(const Interpolation& corners, const Points& of_corners, Points& forces) {
  for (std::size_t i = 0; i < of_corners.size(); ++i)
    corners.add_force(i, of_corners[i], forces);
}

} // namespace

void check(const SurfacePatch& patch) {
  if (patch.points.n_points() != patch.rest.size())
    throw ParameterError("a surface load needs a rest position for each vertex");
  for (const Triangle& triangle : patch.triangles)
    for (const auto vertex : triangle)
      if (vertex >= patch.rest.size())
        throw ParameterError("a surface load has a triangle of a vertex that it does not know");
  const TriangleCarriers& carriers = patch.carriers;
  if (carriers.of_triangle.size() != carriers.shape_at_nodes.size() ||
      (!carriers.of_triangle.empty() && carriers.of_triangle.size() != patch.triangles.size()))
    throw ParameterError("a surface load needs carriers for each triangle, or for none");
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

Traction::Traction(const SurfacePatch& patch, Field traction)
  : rest_(patch.rest), moments_(patch.rest.size(), Vec3::Zero()), traction_(std::move(traction)) {
  TriangleCarriers carriers = carriers_of(patch);
  shares_ = shares_of_vertices(patch, carriers);
  corners_ = std::move(carriers.corners);
  for (const Triangle& triangle : patch.triangles) {
    const auto& [a, b, c] = triangle;
    const double area = 0.5 * double_area(rest_[a], rest_[b], rest_[c]).norm();
    for (const auto vertex : triangle)
      moments_[vertex] += area / 12 * (rest_[a] + rest_[b] + rest_[c] + rest_[vertex]);
  }
}

double Traction::energy(const double time, const Points& x) const {
  const Loan<Vec3> places = places_of(corners_, x);
  double sum = 0;
  for (std::size_t i = 0; i < rest_.size(); ++i)
    if (shares_.start[i] != shares_.start[i + 1])
      sum -= traction_(rest_[i], time).dot(shares_.at(i, places) - moments_[i]);
  return sum;
}

void Traction::add_force(const Moment& moment, Points& forces) const {
  Loan<Vec3> of_corners(corners_.n_points(), Vec3::Zero());
  for (std::size_t i = 0; i < rest_.size(); ++i)
    if (shares_.start[i] != shares_.start[i + 1])
      shares_.add_force(i, traction_(rest_[i], moment.time), of_corners);
  add_forces(corners_, of_corners, forces);
}

/// Of all triangles, at a time and at places.
class Pressure::Images {
 public:
  using AtPoints = Eigen::Matrix<double, n_triangle_points, 3>;
  using AtCorners = Eigen::Matrix<double, 8, 3>;

  Images(const Pressure& of, const double time, const Points& x)
    : patch_(of.patch_), places_(places_of(patch_.carriers.corners, x)), pressures_(patch_.rest.size()) {
    for (const auto vertex : of.vertices_)
      pressures_[vertex] = of.pressure_(patch_.rest[vertex], time);
  }
  /// Derivatives of positions along two sides, and weight times pressure, at the points of the rule.
  struct Image {
    AtPoints u, v;
    Eigen::Matrix<double, n_triangle_points, 1> pressure;
  };
  /// False where there is no pressure.
  bool make(const std::size_t triangle, Image& image) const {
    const auto& [a, b, c] = patch_.triangles[triangle];
    const Vec3 p(pressures_[a], pressures_[b], pressures_[c]);
    if (p.isZero(0))
      return false;
    const TriangleRule& rule = triangle_rule();
    AtCorners x;
    for (int v = 0; v < 8; ++v)
      x.row(v) = places_[patch_.carriers.of_triangle[triangle][v]];
    const Eigen::Matrix<double, n_triangle_nodes, 3> nodes =
      patch_.carriers.shape_at_nodes[triangle].lazyProduct(x); // Eigen's own blocks cost more than such small products
    image.u = rule.du.lazyProduct(nodes);
    image.v = rule.dv.lazyProduct(nodes);
    image.pressure = rule.weight.cwiseProduct(rule.L * p);
    return true;
  }

 private:
  const SurfacePatch& patch_;
  Loan<Vec3> places_;
  Loan<double> pressures_;
};

Pressure::Pressure(SurfacePatch patch, ScalarField pressure)
  : patch_(std::move(patch)), pressure_(std::move(pressure)) {
  patch_.carriers = carriers_of(patch_);
  for (const Triangle& triangle : patch_.triangles)
    vertices_.insert(vertices_.end(), triangle.begin(), triangle.end());
  sort_unique(vertices_);
}

void Pressure::add_force(const Moment& moment, Points& forces) const {
  const TriangleCarriers& carriers = patch_.carriers;
  const Images images(*this, moment.time, moment.x);
  Loan<Vec3> of_corners(carriers.corners.n_points(), Vec3::Zero());
  Images::Image image;
  for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
    if (!images.make(t, image))
      continue;
    Images::AtPoints at_points;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      at_points.col(k) = image.pressure.cwiseProduct(image.v.col(i).cwiseProduct(image.u.col(j)) -
                                                     image.u.col(i).cwiseProduct(image.v.col(j)));
    }
    const Eigen::Matrix<double, n_triangle_nodes, 3> at_nodes =
      triangle_rule().shape.transpose().lazyProduct(at_points);
    const Images::AtCorners at_corners = carriers.shape_at_nodes[t].transpose().lazyProduct(at_nodes);
    for (int v = 0; v < 8; ++v)
      of_corners[carriers.of_triangle[t][v]] += Vec3(at_corners.row(v));
  }
  add_forces(carriers.corners, of_corners, forces);
}

/// -d(force on a)/dx_c = int p L_a (L_c,v [x_u]x - L_c,u [x_v]x).
void Pressure::add_tangent(const Tangent kind, const Moment& moment, double, LoadTangent& tangent) const {
  if (kind == Tangent::positive)
    return;
  const TriangleRule& rule = triangle_rule();
  const TriangleCarriers& carriers = patch_.carriers;
  const Images images(*this, moment.time, moment.x);
  Images::Image image;
  std::array<Eigen::Matrix<double, 8, 8>, 3> pairs; // [s]x of two corners
  for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
    if (!images.make(t, image))
      continue;
    const Eigen::Matrix<double, n_triangle_points, 8> L = rule.shape * carriers.shape_at_nodes[t],
                                                      du = rule.du * carriers.shape_at_nodes[t],
                                                      dv = rule.dv * carriers.shape_at_nodes[t];
    for (int k = 0; k < 3; ++k)
      pairs[k] = L.transpose() * image.pressure.asDiagonal() *
                 (image.u.col(k).asDiagonal() * dv - image.v.col(k).asDiagonal() * du);
    for (int a = 0; a < 8; ++a)
      for (int c = 0; c < 8; ++c)
        if (const Vec3 s(pairs[0](a, c), pairs[1](a, c), pairs[2](a, c)); !s.isZero(0))
          tangent.add(carriers.corners, carriers.of_triangle[t][a], carriers.of_triangle[t][c], cross_matrix(s));
  }
}

} // namespace kerf::dynamics
