#pragma once

/// Where the corners of a body may be when a blade meets it: physics never promises more than finite numbers.

#include "tests/fuzz/subject.h"

namespace kerf::fuzz {

/// Puts the corners into a state drawn at random: at rest, moved rigidly, stretched and sheared, twisted, folded over
/// itself, scrambled, collapsed to a plane, a line or a point. Returns its name.
std::string put_into_state(Subject& subject, Random& random);

/// What happens to the body between two sweeps: nothing, a rigid motion, a jitter, its pieces and copies pulled
/// apart, a new state. What the cutter knows of where it was stays. Returns its name.
std::string move(Subject& subject, Random& random);

/// 0 .. n - 1.
inline int draw(Random& random, const int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); }

/// The same, as a solid moves in a step: nothing, a rigid motion, a jitter of up to a hundredth of a cube.
std::string move_gently(Subject& subject, Random& random);

/// Lower and upper end of all corners, and a margin of h [m].
Box reach(const Subject& subject);

inline Vec3 random_point(Random& random, const Box& box) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis)
    p[axis] = support::uniform(random, box.lower[axis], box.upper[axis]);
  return p;
}

} // namespace kerf::fuzz
