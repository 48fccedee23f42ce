#include "reference/mesh.h"

#include <cmath>
#include <numbers>

namespace kerf::reference {

namespace {

using Cell = std::array<std::uint32_t, 8>;

/// The vertex at a place: one that is there already, or a new one. Few vertices lie in a plane mesh.
std::uint32_t vertex_at(Mesh& mesh, const Vec3& X) {
  const double near = 1e-12 * (1 + X.norm());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if ((mesh.vertices[v] - X).norm() < near)
      return v;
  mesh.vertices.push_back(X);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

/// A quadrilateral a, b, c, d, where a b and c d are opposite sides, both in the same direction.
void add_cell(Mesh& mesh, const std::array<Vec3, 4>& corners, const Sides sides) {
  Cell cell{};
  for (std::size_t i = 0; i < 4; ++i)
    cell[i] = vertex_at(mesh, corners[i]);
  mesh.cells.push_back(cell);
  mesh.sides.push_back(sides);
}

Vec3 on_circle(const double radius, const double eighths) {
  const double angle = eighths * std::numbers::pi / 4;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

/// From a circle, or the core's square, out to the next circle.
void add_rings(Mesh& mesh, const std::vector<double>& radii) {
  for (std::size_t r = 1; r < radii.size(); ++r)
    for (int i = 0; i < 2; ++i)
      add_cell(mesh,
               {on_circle(radii[r - 1], i), on_circle(radii[r], i), on_circle(radii[r - 1], i + 1),
                on_circle(radii[r], i + 1)},
               Sides::round);
}

void add_core(Mesh& mesh, const double radius) {
  const Vec3 right(0.5 * radius, 0, 0), up(0, 0.5 * radius, 0), corner = on_circle(0.6 * radius, 1);
  add_cell(mesh, {Vec3::Zero(), right, up, corner}, Sides::straight);
  add_cell(mesh, {right, on_circle(radius, 0), corner, on_circle(radius, 1)}, Sides::blended);
  add_cell(mesh, {up, corner, on_circle(radius, 2), on_circle(radius, 1)}, Sides::blended);
}

/// A quarter, turned around the z axis.
Mesh four_of(const Mesh& quarter) {
  Mesh mesh;
  for (int turn = 0; turn < 4; ++turn)
    for (std::size_t c = 0; c < quarter.cells.size(); ++c) {
      std::array<Vec3, 4> corners;
      for (std::size_t i = 0; i < 4; ++i) {
        const Vec3& X = quarter.vertices[quarter.cells[c][i]];
        const std::array<Vec3, 4> turned = {X, Vec3(-X[1], X[0], 0), -X, Vec3(X[1], -X[0], 0)};
        corners[i] = turned[static_cast<std::size_t>(turn)];
      }
      add_cell(mesh, corners, quarter.sides[c]);
    }
  return mesh;
}

} // namespace

std::vector<double> graded(const double lower, const double upper, const int n, const double ratio) {
  std::vector<double> all = {lower};
  for (int i = 1; i <= n; ++i)
    all.push_back(lower + (upper - lower) * std::pow(ratio, n - i));
  return all;
}

std::vector<double> graded_to_both(const double lower, const double upper, const int n, const double ratio) {
  const double middle = (lower + upper) / 2;
  std::vector<double> all = graded(lower, middle, n, ratio);
  for (int i = n; i-- > 0;)
    all.push_back(upper - (all[static_cast<std::size_t>(i)] - lower));
  return all;
}

std::vector<double> equal(const double lower, const double upper, const int n) {
  std::vector<double> all;
  for (int i = 0; i <= n; ++i)
    all.push_back(lower + (upper - lower) * i / n);
  return all;
}

Mesh rectangles(const std::vector<double>& x, const std::vector<double>& y) {
  Mesh mesh;
  for (const double yj : y)
    for (const double xi : x)
      mesh.vertices.emplace_back(xi, yj, 0);
  const auto at = [&](const std::size_t i, const std::size_t j) {
    return static_cast<std::uint32_t>(j * x.size() + i);
  };
  for (std::size_t j = 0; j + 1 < y.size(); ++j)
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
      mesh.cells.push_back({at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
  mesh.sides.assign(mesh.cells.size(), Sides::straight);
  return mesh;
}

Mesh quarter_disc(const std::vector<double>& radii) {
  Mesh mesh;
  add_core(mesh, radii.front());
  add_rings(mesh, radii);
  return mesh;
}

Mesh disc(const std::vector<double>& radii) { return four_of(quarter_disc(radii)); }

Mesh disc_in_square(const std::vector<double>& radii, const double width) {
  return four_of(quarter_disc_in_square(radii, width));
}

Mesh quarter_disc_in_square(const std::vector<double>& radii, const double width) {
  Mesh mesh = quarter_disc(radii);
  const double R = radii.back();
  const Vec3 corner(width, width, 0);
  add_cell(mesh, {on_circle(R, 0), Vec3(width, 0, 0), on_circle(R, 1), corner}, Sides::blended);
  add_cell(mesh, {on_circle(R, 2), on_circle(R, 1), Vec3(0, width, 0), corner}, Sides::blended);
  return mesh;
}

Mesh extruded(const Mesh& plane, const std::vector<double>& z) {
  Mesh mesh{3, {}, {}, {}};
  const auto n = static_cast<std::uint32_t>(plane.vertices.size());
  for (const double zk : z)
    for (const Vec3& X : plane.vertices)
      mesh.vertices.emplace_back(X[0], X[1], zk);
  for (std::uint32_t k = 0; k + 1 < z.size(); ++k)
    for (std::size_t c = 0; c < plane.cells.size(); ++c) {
      Cell cell{};
      for (std::size_t i = 0; i < 4; ++i) {
        cell[i] = plane.cells[c][i] + k * n;
        cell[i + 4] = plane.cells[c][i] + (k + 1) * n;
      }
      mesh.cells.push_back(cell);
      mesh.sides.push_back(plane.sides[c]);
    }
  return mesh;
}

void map_vertices(Mesh& mesh, const std::function<Vec3(const Vec3&)>& to) {
  for (Vec3& X : mesh.vertices)
    X = to(X);
}

} // namespace kerf::reference
