#pragma once

/// What one hexahedron needs of its material: stiffness, mass, mean gradient. Local unknowns are 3 a + i for vertex a
/// and direction i. A cube of edge h scales as K ~ h, mass ~ h^3, gradients ~ 1 / h.

#include "fem/hourglass.h"
#include "fem/kernels.h"

namespace kerf::fem {

struct ElementOptions {
  Strain strain = Strain::trilinear;
};

/// Its stiffness is what single precision holds of it, in energies, forces, products and factorisations alike: the next
/// representable material, exact for affine motions, which hourglass modes do not know.
struct Element {
  std::array<float, n_hourglass_pairs> hourglass = {}; ///< stiffness against the hourglass modes (kernels.h) [N/m]
  std::array<Vec3, 4> mode_gradient;                   ///< of the hourglass modes, mean over the material [1/m]
  double slope = 0;                                    ///< the same of linear modes, along their axes: 1 / (4 h) [1/m]
  std::array<double, 8> mass = {};                     ///< lumped: density times the integral of N_a [kg]
  Vec3 centroid;                                       ///< of the material, in the unit cube [1]
  double volume = 0;                                   ///< of the material [m^3]
  double bound = 0; ///< of the eigenvalues of D^-1 K, see jacobi_bound(); of A too (dilatation.h) [1]

  /// Mean of grad N_a over the material [1/m].
  Vec3 gradient(int a) const;
};

/// Hooke's law, small strain, exact for the material as it lies.
Element make_element(const Moments& moments, double h, const material::Elastic& material,
                     const ElementOptions& options);

/// Which part of Hooke's stiffness.
enum class Part {
  whole,    ///< for laws that are Hooke's in a turned frame
  hourglass ///< beside a law that is evaluated at the mean deformation gradient
};
/// Of an element as a matrix, symmetric [N/m].
Matrix24 stiffness(const Element& element, const material::Elastic& material, Part part = Part::whole);

/// The largest eigenvalue of D^-1 K for the 3 x 3 diagonal blocks D of Hooke's stiffness [1]: at most 8. The largest
/// over all elements of a body bounds that of the body, however the elements turn.
double jacobi_bound(const Element& element, const material::Elastic& material);

/// Density times the integral of N_a N_b for each pair of vertices [kg]; `mass_of_cube`: of a full one.
Eigen::Matrix<double, 8, 8> consistent_mass(const Moments& moments, double mass_of_cube);

} // namespace kerf::fem
