#pragma once

/// A blade: a polyline that moves rigidly by key frames in world space, and the strip of triangles it sweeps (thesis
/// §2.3.3). A scalpel is one segment, scissors are two blades, a curved tool has many segments.
///
/// Method: position linear, rotation at constant angular velocity between key frames; constant outside them. A strip is
/// split at key frames and wherever the blade has turned by 2 degrees. Vertices are pose(t) of the polyline, a function
/// of t alone, so consecutive sweeps share theirs bit by bit and leave no gap.

#include "base/vec.h"
#include "grid/cuts.h"

#include <string>
#include <vector>

namespace kerf::cut {

struct KeyFrame {
  double time = 0;              ///< [s]
  Vec3 position = Vec3::Zero(); ///< of the blade frame's origin, world frame [m]
  Vec3 rotation = Vec3::Zero(); ///< rotation vector, blade to world frame [degrees]
};

struct Blade {
  std::string name;
  Points edge; ///< the cutting edge, a polyline, blade frame [m]
  std::vector<KeyFrame> key_frames;
  grid::CutLabel label = 1;
  Vec3 spine = Vec3::Zero(); ///< from the cutting edge to the back, blade frame [m]; drawn only
};

/// A rigid placement: blade frame to world frame.
struct Pose {
  Vec3 position = Vec3::Zero(); ///< [m]
  Mat3 rotation = Mat3::Identity();

  Vec3 operator()(const Vec3& p) const { return rotation * p + position; }
};

/// Throws ParameterError: fewer than two points, two equal points in a row, no key frames, times that do not increase,
/// numbers that are not finite, key frames in a row that turn by 180 degrees or more (which way would be ambiguous).
void check(const Blade& blade);

/// Where the blade is at time t [s]. Here and below, check() must accept the blade.
Pose pose(const Blade& blade, double t);

/// The cutting edge at time t [s], world frame [m].
Points world_points(const Blade& blade, double t);

/// Where the cutting edge stands at successive moments of a step: first at its start, last at its end.
struct BladePath {
  std::vector<double> fractions; ///< of the step, from 0 to 1
  std::vector<Points> lines;     ///< world frame [m]
};
BladePath path(const Blade& blade, double t0, double t1);

/// The triangles between two successive places of the cutting edge; none when they are the same.
void add_strip(const Points& before, const Points& after, std::vector<std::array<Vec3, 3>>& strip);

/// The triangles [m, world frame] that the cutting edge sweeps from t0 to t1 [s]; none while the blade rests.
std::vector<std::array<Vec3, 3>> sweep(const Blade& blade, double t0, double t1);

} // namespace kerf::cut
