#pragma once

/// Fronts of cracks, around which a scene asks for energy release rates.

#include "fem/energy_release.h"
#include "scene/composing.h"
#include "scene/text_grammar.h"

namespace kerf::scene {

struct Body;

/// A front that a scene names.
struct NamedFront {
  std::string name;
  fem::CrackFront front;
  fem::Tubes tubes;
};

/// Describes the keys of `form`, all of which must be set but those of the tubes; those of all forms while it is empty.
struct CrackFrontParameters {
  std::string form;
  Vec3 first = Vec3::Zero(), second = Vec3::UnitY(), growth = Vec3::UnitX(); ///< [m], [m], any length [1]
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitZ();                        ///< [m], any length [1]
  double radius = 1;                                                         ///< [m]
  double inner = 2, outer = 4;                                               ///< cube edges [1]
  void describe(Parameters& p);
};

/// Which form.
struct CrackFormParameters {
  std::string form = "line";
  void describe(Parameters& p);
};

/// The section `Crack front`.
SectionKind crack_front_kind();

/// Reads the fronts of a body's section. Throws ParameterError, also for a body that is not of finite elements.
std::vector<NamedFront> compose_crack_fronts(const Section& section, double cube_edge, const std::string& backend);

/// Warns, once the body is there, of lines whose ends are not on the skin and of supports within the outer tubes, as G
/// would be wrong. Throws ParameterError where a front lies outside of the body.
std::vector<std::string> check_crack_fronts(const Section& section, const Body& body);

/// G of a front of the body as it stands [J/m^2]; and K [Pa m^1/2].
double energy_release_rate(const Body& body, const NamedFront& front);
double stress_intensity(const Body& body, const NamedFront& front);

} // namespace kerf::scene
