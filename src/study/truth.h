#pragma once

/// References that deal.II finds on a mesh fitted to the body (reference/): the section `Truth` of a study, for
/// problems without a closed form. Solved twice, the second time with a degree less, and in time with twice the step;
/// both must agree. Kept in a cache by a hash of the section and of what is asked beside it.

#include "scene/parameter_file.h"
#include "study/plan.h"

#include <filesystem>

namespace kerf::study {

scene::SectionKind truth_grammar();

/// What else is asked of a truth beside the displacement that its section names.
struct TruthAsked {
  Points points = {}; ///< of the scene [m]
  bool frequency = false;
};

/// The value, what else is asked, and where it comes from: "deal.II, degree 4, 11856 unknowns; degree 3 differs by
/// 2e-07". `cache` holds a file each; an empty path: none. Throws ParameterError for a section that cannot be, and
/// where the unit of the study is not m; NumericalError where the two solutions differ by more than the tolerance.
Reference find_truth(const scene::Section& section, const TruthAsked& asked, const std::filesystem::path& cache);

/// Where truths are kept: references/ in $XDG_CACHE_HOME/kerf or ~/.cache/kerf; empty where neither is known.
std::filesystem::path truth_cache();

} // namespace kerf::study
