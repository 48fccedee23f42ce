#pragma once

/// Strain and stress for output and observables: one tensor a copy, then one a corner.
///
/// A copy's is that of its mean deformation gradient, which is most accurate at the centroid of its material. A
/// corner's is recovered from the copies around it by a linear least-squares fit with their volumes as weights (the
/// patch recovery of Zienkiewicz and Zhu 1992): inside a body of full cells that is their mean, and it keeps second
/// order at the skin too, where a plain mean would be taken on one side. A fit never reaches across a cut. Linear
/// fields are recovered exactly.

#include "fem/hexahedra.h"

namespace kerf::fem {

/// Green's strain (F^T F - I) / 2 of each copy [1], rest configuration; sym(F) - I under the small-strain law.
std::vector<Mat3> strain_of_copies(const Hexahedra& model, const Points& x);

/// Cauchy's stress of each copy [Pa], current configuration (material::cauchy_stress).
std::vector<Mat3> stress_of_copies(const Hexahedra& model, const Points& x);

/// A tensor for each corner out of one for each copy. `rest`: rest positions of the corners [m].
std::vector<Mat3> at_corners(const Hexahedra& model, const Points& rest, const std::vector<Mat3>& of_copies);

/// sqrt(3/2 s:s) of the deviator s of a stress [Pa].
double von_mises(const Mat3& stress);

} // namespace kerf::fem
