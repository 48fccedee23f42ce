#pragma once

/// Principal stretches with signs, and second derivatives of an isotropic energy in their frame.
///
/// F = U diag(s) V^T with proper rotations U and V; s descends, and only s[2] may be negative, where F is inverted
/// (Irving, Teran and Fedkiw 2004, section 4). An isotropic energy density is a function of s alone, and its second
/// derivative with respect to F has the same nine eigen-directions for every law (Stomakhin, Howes, Schroeder and
/// Teran 2012; Smith, de Goes and Kim 2019): three that mix the stretches, three symmetric (flips) and three
/// antisymmetric (twists) ones, each in the plane of two principal directions.

#include "base/vec.h"

namespace kerf::material {

/// dP/dF of column-stacked F: entry (i + 3 j, k + 3 l) is dP_ij / dF_kl [Pa].
using Tangent = Eigen::Matrix<double, 9, 9>;

struct Stretches {
  Mat3 U, V;
  Vec3 s; ///< [1]

  Mat3 rotation() const { return U * V.transpose(); }
};

Stretches stretches_of(const Mat3& F);

/// Second derivatives of an energy density psi(s) [Pa]. Entry k of `flip` and `twist` belongs to the plane of the other
/// two directions i and j.
struct Curvature {
  Mat3 stretch; ///< d^2 psi / ds_i ds_j
  Vec3 flip;    ///< (psi_i - psi_j) / (s_i - s_j)
  Vec3 twist;   ///< (psi_i + psi_j) / (s_i + s_j)
};

/// That with the absolute values of its eigenvalues (Chen, Liu, Levin, Zheng and Jacobson 2024, Stabler neo-Hookean
/// simulation: absolute eigenvalue filtering for projected Newton). Leaving negative ones out instead is as positive,
/// but lets an inverted element, which is most unstable, move as if nothing held it: for a scrambled block conjugate
/// gradients then take five times the iterations, or run out.
Curvature absolute_value(const Curvature& curvature);

/// dP/dF from its eigen-directions.
Tangent tangent_of(const Stretches& stretches, const Curvature& curvature);

} // namespace kerf::material
