#pragma once

/// Manufactured solution: u(X) = sum of p_m sin(k_m . X + phi_m), its body force -div sigma and its tractions sigma n.
///
/// With the normals of the body's own triangles, u solves the problem on the body as it is embedded, exactly: what is
/// left is the error of the elements, without that of the shape.

#include "tests/verification/statics.h"

namespace kerf::verification {

/// What is loaded and held.
enum class Shape {
  fitted_cube,  ///< nodes on its faces; one face held, tractions on the others
  rotated_cube, ///< about an arbitrary axis; tractions all around, rigid motion held
  ball          ///< the same
};

/// Whether the solution changes volume. The stress of one that does grows with 1 / (1 - 2 nu), and with it the error of
/// any displacement: near nu = 0.5 only one that does not, as every solution under given loads tends to be, shows
/// whether elements lock (|u|_2 + lambda |div u|_1 is what bounds the error of those that do not: Brenner and Sung
/// 1992, Linear finite element methods for planar linear elasticity, Math. Comp. 59).
enum class Dilatation { some, none };

struct ManufacturedOptions {
  Shape shape = Shape::ball;
  double h = 0.1; ///< of a body of size 1 [m]
  Vec3 offset = Vec3(0.37, 0.21, 0.83);
  fem::HexahedraOptions model;
  Dilatation dilatation = Dilatation::some;
  LinearSolver solver = LinearSolver::conjugate_gradients;
};

/// Errors over the norm of the solution, rigid motion fitted where it is not held [1].
struct FieldErrors {
  double l2 = 0, h1 = 0;
  std::size_t n_cells = 0;
  double smallest_fraction = 0; ///< of a cell [1]
  Cost cost;
};

FieldErrors manufactured(const ManufacturedOptions& options);

} // namespace kerf::verification
