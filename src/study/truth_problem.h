#pragma once

/// What the section Truth of a study says, and the problem of the reference room that it means.

#include "reference/problem.h"
#include "scene/parameter_file.h"

namespace kerf::study {

/// A body of Hooke's material at small strain, and the displacement that is asked for.
struct TruthParameters {
  std::string shape = "quadrilateral";
  Points corners;              ///< [m] four, counter-clockwise, z = 0
  double half_width = 0;       ///< of a square around the origin [m]
  double radius = 0;           ///< of a disc around the origin that cells are fitted to [m]
  std::vector<double> heights; ///< [m] two, or none: plane strain
  std::vector<double> cells = {4, 4, 2};
  double youngs_modulus = 0, poissons_ratio = 0;
  double density = 1;                                   ///< [kg/m^3]
  Vec3 force = Vec3::Zero();                            ///< [N/m^3]
  double end_time = 0, time_step = 0, mass_damping = 0; ///< [s], [s], [1/s]
  void describe(Parameters& p);
};

/// What is asked of its solution.
struct TruthAnswerParameters {
  Vec3 point = Vec3::Zero(), minus_point = Vec3::Zero(); ///< [m]
  std::string axis = "z";
  std::string take = "end";
  std::string axes = "xyz"; ///< of the scene, that x, y, z here stand for
  double energy_factor = 1;
  int degree = 4, n_adaptations = 12;
  double tolerance = 1e-4;
  void describe(Parameters& p);
};

/// The sections below Truth.
std::vector<scene::SectionKind> truth_parts();

/// The layers of cells at a disc's border: each is as wide as the one before times this, towards the border. The square
/// root that displacements have at the front of a crack leaves an error in proportion to the innermost layer, whatever
/// the degree.
constexpr double layer_ratio = 0.3;
/// Whether a body has such layers.
bool has_layers(const TruthParameters& p);

/// With so many layers fewer than it says. Throws ParameterError for a section that cannot be.
reference::Problem problem_of(const TruthParameters& p, const scene::Section& section, int fewer_layers = 0);

} // namespace kerf::study
