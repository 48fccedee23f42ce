#pragma once

/// A homogeneous isotropic elastic solid.

#include "base/parameters.h"

#include <cmath>
#include <string>

namespace kerf::material {

struct Elastic {
  double density = 1000;            ///< [kg/m^3]
  double youngs_modulus = 1e4;      ///< E [Pa]
  double poissons_ratio = 0.3;      ///< nu [1]
  std::string law = "corotational"; ///< law_of() in laws.h

  /// Lame's parameters [Pa]: lambda = E nu / ((1 + nu) (1 - 2 nu)), mu = E / (2 (1 + nu)).
  double lambda() const { return youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio)); }
  double mu() const { return youngs_modulus / (2 * (1 + poissons_ratio)); }

  double pressure_wave_speed() const { return std::sqrt((lambda() + 2 * mu()) / density); } ///< [m/s]

  void describe(Parameters& p) {
    p.number("Density [kg/m^3]", density, positive, "Mass per rest volume.");
    p.number("Young's modulus [Pa]", youngs_modulus, positive, "Stiffness in uniaxial tension.");
    p.number("Poisson's ratio [1]", poissons_ratio, {.min = -1, .max = 0.5, .min_excluded = true, .max_excluded = true},
             "Lateral contraction; trilinear cells lock near 0.5, enhanced ones do not.");
    p.choice(
      "Law", law, {"small strain", "corotational", "St. Venant-Kirchhoff", "neo-Hookean"},
      "Stress of a deformation. Small strain: Hooke's law, for small rotations. Corotational: the same, turned with "
      "the material. St. Venant-Kirchhoff: for large rotations, not for strong compression. Neo-Hookean: for "
      "large strain, m/2 (F:F - 3) + l/2 (J - a)^2 - m/2 log(F:F + 1) with m = 4/3 mu, l = lambda + 5/6 mu, a = 1 + "
      "3 m / (4 l) (Smith, de Goes and Kim 2018), which other laws of that name differ from by some % at large "
      "strain.");
  }
};

} // namespace kerf::material
