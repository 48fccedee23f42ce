#pragma once

/// Stiffness of a trilinear hexahedron against what its nodes can do beside an affine motion (hourglass modes).
///
/// With y the coordinates of the unit cube from the centroid of the material, the strain of a trilinear displacement
/// is its mean plus a combination of six monomials q = y0, y1, y2, y0 y1, y1 y2, y2 y0, each less its mean over the
/// material. Mean and rest do not mix under a constant elasticity D, so K = V B^T D B + H^T (G x D) H with G the 6 x 6
/// Gram matrix of the monomials: all integrals are exact from the 27 moments.
///
/// trilinear: the strain of the displacement, as it is. It locks in bending and near nu = 0.5. enhanced: that strain
/// may be changed by 12 modes of the element's own, condensed: the gradients of the three parabolas in each
/// displacement component (Wilson's incompatible modes; Taylor, Beresford and Wilson 1976) and three dilatations along
/// y0 y1, y1 y2, y2 y0 (Simo, Armero and Taylor 1993). All have no mean, so the patch test holds for every shape of
/// the material (Simo and Rifai 1990). In coordinates from the centroid, a copy that a plane across an axis halves is
/// just a cuboid of half the size.
///
/// Condensing minimises |A H u + A M a|^2 over a, with A^T A = G x D: by a rank-revealing QR factorisation of A M, so
/// slivers and flat material, where modes coincide or vanish, need no special care, and K is positive semi-definite.

#include "fem/kernels.h"
#include "fem/moments.h"
#include "material/elastic.h"

namespace kerf::fem {

enum class Strain { trilinear, enhanced };

using Matrix24 = Eigen::Matrix<double, 24, 24>;
using Vector24 = Eigen::Matrix<double, 24, 1>;

/// Moments about the centroid.
struct Centred {
  double volume; ///< of the unit cube [1]
  Vec3 centroid; ///< in the unit cube [1]
  /// Integrals of the products of the six monomials less their means [1]; symmetric, positive semi-definite.
  Eigen::Matrix<double, 6, 6> gram;
  /// Means of the three products y0 y1, y1 y2, y2 y0 [1].
  Vec3 mean_products;
};

Centred centred(const Moments& moments);

/// Means of grad N_a over the material, for a cube of edge 1 m [1/m].
std::array<Vec3, 8> mean_gradients(const Centred& moments);

/// Sign of a mode (kernels.h) at a vertex: a mode's amplitude is the sum of what its vertices have, times these.
int sign(int mode, int vertex);
/// By amplitudes of the hourglass modes: 3 k + i for the k-th of them and direction i.
using MatrixOfModes = Eigen::Matrix<double, n_hourglass, n_hourglass>;
/// The same by displacements of the nodes. Vanishes on affine ones.
Matrix24 by_nodes(const MatrixOfModes& by_modes);

/// Stiffness for a cube of edge 1 m, Hooke's law [N/m].
MatrixOfModes hourglass_stiffness(const Centred& moments, const material::Elastic& material, Strain strain);

/// Displacement gradients less their mean, one for each of the six monomials (less its own mean), 9 rows each, column
/// by column, of the 24 nodal displacements of a cube of edge 1 m: with the modes of the element's own, as they settle
/// [1/m].
using Gradients = Eigen::Matrix<double, 54, 24>;
Gradients hourglass_gradients(const Centred& moments, const material::Elastic& material, Strain strain);

/// Stiffness V B^T D B of the mean strain for a cube of edge 1 m, Hooke's law [N/m]; `gradient`: means of grad N_a
/// [1/m].
Matrix24 mean_stiffness(double volume, const std::array<Vec3, 8>& gradient, const material::Elastic& material);

} // namespace kerf::fem
