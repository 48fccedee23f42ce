#pragma once

/// Warps between two pictures by multilevel feature matching (thesis §3.4.3.1.1).
///
/// An edge detector runs on every level of a Gaussian stack of each picture, and what it finds is then sampled as
/// coarsely as the level is blurred; beside edges, brightness and the outline of what is section may count. The
/// coarsest level moves a lattice of few cells, each finer level starts from the one before it with more of them, and
/// all but the finest once more from where all stays: of both, what costs less goes on. Both pictures have the same
/// size: whoever calls has made their axis-aligned boxes match.

#include "warp/energy.h"

namespace kerf::warp {

/// A picture to be matched.
struct Picture {
  image::Colours colours;
  image::Grey mask; ///< 1 what is section
};

/// What is taken out of each triangle's Jacobian, estimated from the mean of them by polar decomposition.
enum class Global { none, rotation, rotation_and_scale };

struct MatchOptions {
  int n_levels = 4;      ///< of the Gaussian stack
  int n_cells = 16;      ///< of the finest lattice along the longer side
  double edges = 1;      ///< weight of the edges [1]
  double brightness = 1; ///< weight of blurred luminance [1]
  double outline = 1;    ///< weight of the blurred mask [1]
  /// Of the lattice against the features, whose mean square is 1 [1]: stiff, so that features that come and go do not
  /// grasp at their neighbours.
  double stiffness = 8;
  Global global = Global::none; ///< other than none: the border of the rectangle is free
  int n_iterations = 50;        ///< a level
  std::vector<Pin> pins = {};   ///< in pixels of the two pictures
};

/// Level by level, from the finest: what is compared, scaled so that each channel's mean square is its weight squared.
std::vector<FeatureLevel> features(const Picture& a, const Picture& b, const MatchOptions& options);

/// Maps between two pictures of one size.
struct BothWays {
  LatticeMap there, back;
};

/// The maps from pixels of `a` to pixels of `b` and back over the whole rectangle. On each level both are found, each
/// by itself; the next one starts from those of them, and of what undoes them, that cost least. No triangle of their
/// lattices is flipped. Throws ParameterError if the pictures differ in size or are smaller than 4 x 4, or if a pin
/// starts or ends outside.
BothWays match(const Picture& a, const Picture& b, const MatchOptions& options);

} // namespace kerf::warp
