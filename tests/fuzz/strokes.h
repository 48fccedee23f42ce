#pragma once

/// Blades that cut a body step by step while it moves, and may end in it: what a scene does with them, at random.

#include "cut/blade.h"
#include "tests/fuzz/subject.h"

namespace kerf::fuzz {

struct Strokes {
  std::string name;
  std::vector<cut::Blade> blades; ///< one or two
  std::vector<double> times;      ///< at which steps begin and end [s]
};

/// Blades for the body as it stands, with labels from `first` on: straight or bent, that go straight, turn, come back
/// or rest, in steps of any length.
Strokes random_strokes(const Subject& subject, grid::CutLabel first, Random& random);

} // namespace kerf::fuzz
