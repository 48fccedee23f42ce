#pragma once

/// Linear statics by a direct solver, and bodies cut out of a mesh.

#include "dynamics/state.h"
#include "fem/hexahedra.h"
#include "surface/surface.h"
#include "tests/fem/bodies.h"
#include "tests/fem/quadrature.h"
#include "tests/support/placed.h"

#include <Eigen/SparseCholesky>

namespace kerf::fem {

inline Body make_embedded(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset) {
  Body body{support::embedded(mesh, h, offset)};
  body.complex = grid::build_complex(body);
  return body;
}

/// Nodal forces of a traction [Pa] on the surface triangles that lie in x = `plane` [N].
inline Points end_traction(const Body& body, const double plane, const Vec3& traction) {
  static const auto rule = triangle_rule(3);
  const auto skin = surface::build_surface(body);
  Points sum(body.complex.n_corners(), Vec3::Zero());
  for (std::size_t i = 0; i < skin.triangles.size(); ++i) {
    const auto vertex = [&](const int k) { return skin.rest[skin.triangles[i][k]]; };
    if (std::abs(vertex(0)[0] - plane) + std::abs(vertex(1)[0] - plane) + std::abs(vertex(2)[0] - plane) > 1e-6)
      continue;
    const grid::Copy& copy = body.complex.copies[skin.copies[i]];
    const Vec3 a = vertex(1) - vertex(0), b = vertex(2) - vertex(0);
    for (const auto& [x, weight] : rule) {
      const Vec3 local = (vertex(0) + x[0] * a + x[1] * b - body.grid.origin(copy.cell)) / body.grid.h();
      for (int v = 0; v < 8; ++v)
        sum[copy.corners[v].value] += weight * shape(v, local) * a.cross(b).norm() * traction;
    }
  }
  return sum;
}

/// Displacements u of K u = f at rest, where is_held(corner, direction) says which are zero.
template <class IsHeld>
Points solve(const Hexahedra& model, const Points& rest, const Points& f, const IsHeld& is_held) {
  const Eigen::SparseMatrix<double> K = model.stiffness_matrix(rest, dynamics::Tangent::exact);
  std::vector<int> index(3 * rest.size(), -1);
  int n = 0;
  for (std::size_t i = 0; i < index.size(); ++i)
    if (!is_held(i / 3, static_cast<int>(i % 3)))
      index[i] = n++;
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < K.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it)
      if (index[it.row()] >= 0 && index[column] >= 0)
        entries.emplace_back(index[it.row()], index[column], it.value());
  Eigen::SparseMatrix<double> reduced(n, n);
  reduced.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd rhs(n);
  for (std::size_t i = 0; i < index.size(); ++i)
    if (index[i] >= 0)
      rhs[index[i]] = dynamics::flat(f)[i];
  const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(reduced).solve(rhs);
  Points u(rest.size(), Vec3::Zero());
  for (std::size_t i = 0; i < index.size(); ++i)
    if (index[i] >= 0)
      dynamics::flat(u)[i] = solution[index[i]];
  return u;
}

} // namespace kerf::fem
