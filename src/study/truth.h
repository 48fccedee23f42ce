#pragma once

/// References that deal.II finds on a mesh fitted to the body (reference/): the section `Truth` of a study, for problems without
/// a closed form. Solved twice, the second time with a degree less; both must agree. Kept in a cache by a hash of the section.

#include "scene/parameter_file.h"
#include "study/plan.h"

#include <filesystem>

namespace kerf::study {

/// A quadrilateral, in plane strain or extruded, of Hooke's material in equilibrium, and the displacement that is asked for.
struct TruthParameters {
  Points corners;              ///< [m] four, counter-clockwise, z = 0
  std::vector<double> heights; ///< [m] two, or none: plane strain
  std::vector<double> cells = {4, 4, 2};
  double youngs_modulus = 0, poissons_ratio = 0;
  Vec3 force = Vec3::Zero(); ///< [N/m^3]
  Vec3 point = Vec3::Zero(), minus_point = Vec3::Zero();
  std::string axis = "z";
  int degree = 4, n_adaptations = 12;
  double tolerance = 1e-4;
  void describe(Parameters& p);
};

struct TruthPartParameters {
  Box box;
  void describe(Parameters& p);
};

struct TruthHeldParameters : TruthPartParameters {
  std::string axes = "xyz";
  void describe(Parameters& p);
};

struct TruthPulledParameters : TruthPartParameters {
  Vec3 traction = Vec3::Zero();
  void describe(Parameters& p);
};

struct TruthCrackParameters : TruthPartParameters {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();
  void describe(Parameters& p);
};

scene::SectionKind truth_grammar();

/// The value and where it comes from: "deal.II, degree 4, 11856 unknowns; degree 3 differs by 2e-07". `cache` holds a file each;
/// an empty path: none. Throws ParameterError for a section that cannot be, and where the unit of the study is not m;
/// NumericalError where the two solutions differ by more than the tolerance.
Reference find_truth(const scene::Section& section, const std::filesystem::path& cache);

/// Where truths are kept: references/ in $XDG_CACHE_HOME/kerf or ~/.cache/kerf; empty where neither is known.
std::filesystem::path truth_cache();

} // namespace kerf::study
