#pragma once

/// Forceps: a tool that holds a part of a body for a time and carries it with its own rigid motion.
///
/// Method: while it holds, the particles of its physics whose rest position lies in its region are a support. A step
/// from t0 to t1 takes them from where they are to pose(t1) pose(t0)^-1 of that, so all history is in the state: the
/// first step takes them from wherever they were gripped, new corners after a cut are held as their parents were, and a
/// step made again gives the same bits. Released, they keep the velocity of their last step.
/// Limits: what is gripped does not deform; the jaws themselves touch nothing.

#include "cut/motion.h"
#include "scene/body.h"

#include <span>
#include <string>
#include <vector>

namespace kerf::scene {

struct Forceps {
  std::string name;
  Region region;
  std::vector<cut::KeyFrame> key_frames;
  int grip_step = 1, release_step = 2; ///< the first step that holds, the first that does no more
  Vec3 jaws = Vec3::Zero();            ///< from the middle between the jaws to one that holds, tool frame [m]; drawn
  Vec3 handle = Vec3::Zero();          ///< from there to the joint of the arms, tool frame [m]; drawn
};

inline bool holds(const Forceps& forceps, const int step) {
  return forceps.grip_step <= step && step < forceps.release_step;
}

/// Makes supports of the body's corners that forceps hold in step `step`, which begins at `t0` [s], in place of those
/// of the step before. They come after the supports of the body's own regions, in the order of the forceps.
void hold(Body& body, std::span<const Forceps> forceps, int step, double t0);

} // namespace kerf::scene
