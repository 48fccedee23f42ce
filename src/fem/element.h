#pragma once

/// What one hexahedron needs of its material: stiffness, mass, mean gradient. Local unknowns are 3 a + i for vertex a
/// and direction i. A cube of edge h scales as K ~ h, mass ~ h^3, gradients ~ 1 / h.

#include "fem/hourglass.h"

namespace kerf::fem {

/// Which part of Hooke's stiffness an element keeps as a matrix.
enum class Part {
  whole,    ///< for laws that are Hooke's in a turned frame
  hourglass ///< beside a law that is evaluated at the mean deformation gradient
};

struct ElementOptions {
  Strain strain = Strain::trilinear;
  Part part = Part::whole;
  double sliver_floor = 1e-3; ///< [1]
  double mass_spread = 0;     ///< spread_mass [1]
};

struct Element {
  alignas(64) std::array<double, 576> stiffness; ///< symmetric, column by column [N/m]
  std::array<Vec3, 8> gradient;                  ///< mean of grad N_a over what carries stiffness [1/m]
  std::array<double, 8> mass;                    ///< lumped: density times the integral of N_a [kg]
  std::array<double, 64> consistent_mass;        ///< density times the integral of N_a N_b, symmetric [kg]
  Vec3 centroid;                                 ///< of what carries stiffness, in the unit cube [1]
  double volume = 0;                             ///< of the material [m^3]
  double stiff_volume = 0;                       ///< of what carries stiffness: at least the sliver floor's [m^3]
};

/// Hooke's law, small strain. Where the material fills less than `sliver_floor` of the cube, the stiffness (not the
/// mass) is topped up to that fraction with a full cube's, so that corners held by slivers stay solvable. The mean
/// gradient, and with it the rotation, is that of the same topped-up material.
Element make_element(const Moments& moments, double h, const material::Elastic& material,
                     const ElementOptions& options);

/// Gives each corner the same share of a part `part` [1] of the element's lumped mass, the rest stays where it is.
/// Total mass stays, and so does momentum across a cut (copies of a cell share velocities there); a full cube does not
/// change. It bounds the largest frequency of slivers, whose far corners carry hardly any mass: what explicit
/// integrators need.
void spread_mass(Element& element, double part);

} // namespace kerf::fem
