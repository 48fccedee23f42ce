#pragma once

/// The energy that the virtual growth of a crack would release, as an integral over a domain around its front.
///
/// Material that is shifted by q, with all corners held where they are, changes the elastic energy by the integral of
/// (W I - F^T P) : grad q (Eshelby 1951, 1975). In equilibrium, with q along the crack and along the skin, and zero
/// where loads and supports act, that is what the whole body's energy changes by: so minus the integral, over the area
/// by which the crack grows, is the energy release rate G (Li, Shih and Needleman 1985, A comparison of methods for
/// calculating energy release rates, Eng. Fract. Mech. 21). q is of one length in a tube around the front, where fields
/// are singular and where copies are tied (grid/fronts.h), and falls to zero in a wider one. Any law, any rotation.
///
/// In place of F stands F - F_0, F_0 its mean over the domain: virtual work of F_0 q is zero in equilibrium, and P :
/// grad q is of lower order in the strain than what is looked for.
///
/// F and P are those of the elements: the law at the mean gradient of a copy, and beside it Hooke's gradients that are
/// linear and bilinear in the copy, with the modes of the element's own (hourglass.h). In bent arms they hold 1 / n^2
/// of the energy, with n cells over an arm; and as a circle grows, so does the length of its tube, which most of the
/// energy near the front is in, and that of the ties, whose energy grows with their area.
///
/// Limits: statics only; along the skin q must be tangential; between the tubes the crack must be plane, and there must
/// be no load. What is of third order in the gradients beside the mean, that of q among them, is left out; it is odd in
/// a full cube.

#include "fem/hexahedra.h"

#include <functional>
#include <variant>

namespace kerf::fem {

/// A front from skin to skin, along a line; the crack grows along `growth`.
struct LineFront {
  Vec3 first = Vec3::Zero(), second = Vec3::UnitY(); ///< rest configuration [m]
  Vec3 growth = Vec3::UnitX();                       ///< unit, across the line
};

/// A whole circle, of which the crack is the inside.
struct CircleFront {
  Vec3 centre = Vec3::Zero();  ///< rest configuration [m]
  Vec3 normal = Vec3::UnitZ(); ///< unit
  double radius = 1;           ///< [m]
};

using CrackFront = std::variant<LineFront, CircleFront>;

/// Radii of the two tubes [m].
struct Tubes {
  double inner = 0, outer = 0;
};

/// Which way a point at X would move as the front does, unit or zero; how far it is from the front, which a line goes
/// on beyond its ends [m]; and by what part the front is longer for each metre that it moves [1/m].
struct Growth {
  Vec3 direction = Vec3::Zero();
  double distance = 0, lengthening = 0;
};
Growth growth_at(const CrackFront& front, const Vec3& X);

/// A point of the front, at a part of its length from its first end, or around the circle [m].
Vec3 point_on(const CrackFront& front, double part);

/// Length of the front [m].
double length(const CrackFront& front);

/// G, the mean along the front [J/m^2], for corners of the solid at `x` [m].
double energy_release_rate(const grid::Solid& solid, const Hexahedra& model, const Points& x, const CrackFront& front,
                           const Tubes& tubes);

/// |K| of a crack that opens in plane strain, sqrt(G E / (1 - nu^2)) [Pa m^1/2]; zero where G is negative.
double stress_intensity(double energy_release_rate, const material::Elastic& material);

} // namespace kerf::fem
