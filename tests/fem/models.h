#pragma once

/// Every law with both kinds of strain, for tests that hold for all of them.

#include "fem/hexahedra.h"
#include "tests/fem/bodies.h"

namespace kerf::fem {

inline const std::vector<std::string> all_laws = {"small strain", "corotational", "St. Venant-Kirchhoff",
                                                  "neo-Hookean"};
inline const std::vector<Strain> all_strains = {Strain::trilinear, Strain::enhanced};

inline material::Elastic with_law(material::Elastic material, const std::string& law) {
  material.law = law;
  return material;
}

inline Hexahedra make_model(const Body& body, const HexahedraOptions& options) { return Hexahedra(body, options); }

/// What a test prints when it fails.
inline std::string name_of(const HexahedraOptions& options) {
  return options.material.law + (options.strain == Strain::enhanced ? ", enhanced" : ", trilinear");
}

} // namespace kerf::fem
