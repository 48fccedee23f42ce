#pragma once

/// Scissors: two blades on a pivot that close on each other (thesis §2.8, figure 2.22).
///
/// Method: both cutting edges are given where they are when closed. At an opening angle a, the first is turned by a / 2
/// about the axis and the second by -a / 2, and the key frames move the whole. Closed edges that are equal meet bit by
/// bit, so what the two sweep leaves no gap between them. They cut while they close (Hinge), not while they open or are
/// only moved. What they give the cutter are two blades like any other.

#include "cut/blade.h"

namespace kerf::cut {

struct Scissors {
  std::string name;
  Vec3 pivot = Vec3::Zero();   ///< tool frame [m]
  Vec3 axis = Vec3::UnitZ();   ///< of the pivot, unit, tool frame
  std::array<Points, 2> edges; ///< cutting edges when closed, polylines, tool frame [m]
  std::array<Vec3, 2> spines = {Vec3(Vec3::Zero()), Vec3(Vec3::Zero())}; ///< as Blade's, when closed
  std::vector<AngleFrame> openings;                                      ///< angle between the blades
  std::vector<KeyFrame> key_frames;                                      ///< of the whole
};

/// The two blades, "NAME first" and "NAME second", with labels `label` and `label` + 1. Throws ParameterError for
/// openings below 0 or not below 180 degrees, and for what check(Blade) refuses.
std::array<Blade, 2> blades(const Scissors& scissors, grid::CutLabel label);

} // namespace kerf::cut
