#pragma once

/// Elements of coarse copies.
///
/// Galerkin's coarse element is the sum of its children's energies for trilinear motions of the coarse cube, in one
/// frame. It is again a mean gradient against Hooke's law and a matrix against hourglass modes, as for every motion u
/// the mean part is the volume's mean of the children's: V b_m = sum V_c g_m with g_m the child's gradient of the
/// coarse mode m, and what the children's energies hold beside that meets hourglass modes alone. In the child the
/// coarse mode of axes m is sum over its parts n of 2^-|m| sigma^(m without n) times the child's mode n, sigma = +-1
/// the child's octant.

#include "fem/element.h"

#include <span>

namespace kerf::fem {

struct Child {
  const Element* element;
  int octant; ///< bits of the axes
};

/// `h`: edge of the children's cubes [m]. Masses and centroid are left at zero.
Element coarse_element(std::span<const Child> children, double h, const material::Elastic& material);

} // namespace kerf::fem
