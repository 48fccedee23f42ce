#pragma once

/// A problem of linear elasticity at small strain on a fitted mesh, and how finely it is solved.

#include "reference/mesh.h"

#include <string>

namespace kerf::reference {

/// What of a body is meant: asked at the centres of the coarse mesh's faces on the skin, cracks included.
using Region = std::function<bool(const Vec3& X)>;
using Field = std::function<Vec3(const Vec3& X)>;

/// Holds a part of the skin in some directions.
struct Support {
  Region where;
  std::array<bool, 3> held = {true, true, true};
  Field displacement = nullptr; ///< [m]; none: 0
};

/// Holds the vertex that is nearest to a point in some directions: against what tractions leave free.
struct Pin {
  Vec3 at = Vec3::Zero(); ///< [m]
  std::array<bool, 3> held = {true, true, true};
};

/// Pulls at a part of the skin.
struct Traction {
  Region where;
  std::function<Vec3(const Vec3& X, const Vec3& normal)> value; ///< [N/m^2], normal outwards
};

struct Problem {
  Mesh mesh;                 ///< of quadrilaterals: plane strain
  double youngs_modulus = 1; ///< [Pa]
  double poissons_ratio = 0; ///< [1]
  double density = 1;        ///< [kg/m^3]
  std::vector<Support> supports;
  std::vector<Pin> pins;
  std::vector<Traction> tractions;
  Field body_force = nullptr; ///< [N/m^3]; none: 0
};

struct Discretisation {
  int degree = 2;        ///< of FE_Q, 1 to 4
  int n_refinements = 0; ///< of all cells, each into four or eight
  int n_adaptations =
    0; ///< after these: solutions that an estimate of the error refines the mesh by (KellyErrorEstimator)
  double refined_part = 0.1; ///< of the cells, each time: those with the largest estimate
};

} // namespace kerf::reference
