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
};

struct Element {
  alignas(64) std::array<double, 576> stiffness; ///< symmetric, column by column [N/m]
  std::array<Vec3, 8> gradient;                  ///< mean of grad N_a over the material [1/m]
  std::array<double, 8> mass;                    ///< lumped: density times the integral of N_a [kg]
  std::array<double, 64> consistent_mass;        ///< density times the integral of N_a N_b, symmetric [kg]
  Vec3 centroid;                                 ///< of the material, in the unit cube [1]
  double volume = 0;                             ///< of the material [m^3]
};

/// Hooke's law, small strain, exact for the material as it lies.
Element make_element(const Moments& moments, double h, const material::Elastic& material,
                     const ElementOptions& options);

} // namespace kerf::fem
