#pragma once

/// What one trilinear hexahedron needs of its material: stiffness, lumped mass, mean gradient. Local unknowns are
/// 3 a + i for vertex a and direction i. A cube of edge h scales as K ~ h, mass ~ h^3, gradients ~ 1 / h.

#include "fem/moments.h"
#include "material/elastic.h"

namespace kerf::fem {

struct Element {
  alignas(64) std::array<double, 576> stiffness; ///< symmetric, column by column [N/m]
  std::array<Vec3, 8> gradient;                  ///< mean of grad N_a over what carries stiffness [1/m]
  std::array<double, 8> mass;                    ///< density times the integral of N_a [kg]
  double volume = 0;                             ///< of the material [m^3]
};

/// Hooke's law, small strain: K_(ai)(bj) = int lambda N_a,i N_b,j + mu (N_a,j N_b,i + delta_ij grad N_a . grad N_b).
/// Where the material fills less than `sliver_floor` of the cube, the stiffness (not the mass) is topped up to that
/// fraction with a full cube's, so that corners held by slivers stay solvable. The mean gradient, and with it
/// the rotation, is that of the same topped-up material.
Element make_element(const Moments& moments, double h, const material::Elastic& material, double sliver_floor);

/// Gives each corner the same share of a part `part` [1] of the element's mass, the rest stays where it is. Total
/// mass stays, and so does momentum across a cut (copies of a cell share velocities there); a full cube does not
/// change. It bounds the largest frequency of slivers, whose far corners carry hardly any mass: what explicit
/// integrators need.
void spread_mass(Element& element, double part);

} // namespace kerf::fem
