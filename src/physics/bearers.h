#pragma once

/// Which corners take up the forces on points, where corners may have hardly any material.
///
/// The problem: a spike thinner than a cube, or what a blade leaves between itself and the skin, has a surface like
/// others, and so gets loads like others; but its corners have next to no mass, and what holds them next to no
/// stiffness. So it flies off by cubes in a step, however short.
///
/// The method: a corner is light if it holds less material than 1/64 of a cube. A point that follows a light corner
/// follows the nearest copy instead (fewest steps between copies of the piece) that has no light ones, by the affine
/// motion of its corners: with the middle c of that cube and its vertices p_v at rest, a corner at X has the weights
///
///     w_v = 1 / 8 + (X - c).(p_v - c) / (2 h^2).
///
/// They sum to 1 and give X at rest, so forces keep their sum and their moment at rest.
///
/// Limits: pieces without such a copy, as crumbs, bear their loads as they are.

#include "base/interpolation.h"
#include "grid/solid.h"
#include "surface/surface.h"

namespace kerf::physics {

class Bearers {
 public:
  Bearers() = default; ///< each corner bears what acts on it
  /// Of each corner: the part of a cube that it holds of its copies' material [1], and 1 if it need not bear what acts
  /// on it.
  Bearers(const grid::Solid& solid, std::span<const double> material, std::span<const std::uint8_t> may_be_light);

  /// Points that follow corners, as they follow those that bear their loads.
  Interpolation carry(const Interpolation& of_corners) const;

 private:
  std::vector<std::uint32_t> which_; // of each corner, in rows_; `itself` of those that bear; none where all do
  Interpolation rows_;
};

/// 1 for each corner all copies of which have a face that a cut has revealed.
std::vector<std::uint8_t> corners_of_cut_copies(const grid::Solid& solid, const surface::Surface& surface);

} // namespace kerf::physics
