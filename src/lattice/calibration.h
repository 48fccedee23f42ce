#pragma once

/// What lattice shape matching is worth as a material.
///
/// A region of the full box, strained by a small uniform e, has second moments of its mass q I, q = h^2 w (w + 1) / 3,
/// and is left with the energy k/2 q |e|^2 per mass after matching. Hooke's law with lambda = 0 has mu |e|^2 per
/// volume:
///
///     E = 2 mu = density k h^2 w (w + 1) / 3,    nu = 0.
///
/// Since alpha = k dt^2 <= 1, waves travel at most h sqrt(w (w + 1) / 3) a step: that bounds E for a given step.
///
/// Limits, measured on bars of square section (tests/lattice/bar_test.cc): tension follows E for every section, to
/// 0.2 % in the middle of a bar, to 2 % from 2 w + 1 cells off its ends on; nearer, where regions are trimmed, it is
/// softer: a bar of 31 cells that hangs under its weight stretches 0, 5 and 15 % more for w = 1, 2, 3. The first
/// longitudinal mode of a bar of 20 cells is up to 1 % slow, of 40 up to 0.4 %. Bending is too stiff in thin bars,
/// since a region also resists the change of strain within itself: a cantilever 8 times as long as thick bends by this
/// part of Timoshenko's deflection:
///
///     thick [cells]      2      4      8
///     w = 1           0.54   0.82   0.95
///     w = 2           0.52   0.80   0.95
///     w = 3           0.67   0.85   0.98

namespace kerf::lattice {

/// E [Pa] of shape matching with k [1/s^2], density [kg/m^3], cubes of h [m] and regions of half width w.
inline double youngs_modulus(const double k, const double density, const double h, const int w) {
  return density * k * h * h * w * (w + 1) / 3;
}

/// k [1/s^2] for a wanted E [Pa].
inline double stiffness_for(const double youngs_modulus, const double density, const double h, const int w) {
  return 3 * youngs_modulus / (density * h * h * w * (w + 1));
}

/// The smallest half width with which alpha = k dt^2 stays within 1 for a wanted E [Pa].
inline int least_half_width(const double youngs_modulus, const double density, const double h, const double dt) {
  int w = 1;
  while (stiffness_for(youngs_modulus, density, h, w) * dt * dt > 1)
    ++w;
  return w;
}

} // namespace kerf::lattice
