#pragma once

/// The rigid motion of a tool by key frames in world space: position linear, rotation at constant angular velocity
/// between key frames; constant outside them.

#include "base/vec.h"

#include <span>
#include <string>
#include <vector>

namespace kerf::cut {

struct KeyFrame {
  double time = 0;              ///< [s]
  Vec3 position = Vec3::Zero(); ///< of the tool frame's origin, world frame [m]
  Vec3 rotation = Vec3::Zero(); ///< rotation vector, tool to world frame [degrees]
};

/// A rigid placement: tool frame to world frame.
struct Pose {
  Vec3 position = Vec3::Zero(); ///< [m]
  Mat3 rotation = Mat3::Identity();

  Vec3 operator()(const Vec3& p) const { return rotation * p + position; }
};

/// Throws ParameterError at the path "TOOL/Key frames": no key frames, times that do not increase, numbers that are not
/// finite; at "TOOL/Rotations": key frames in a row that turn by 180 degrees or more (which way would be ambiguous).
void check_key_frames(std::span<const KeyFrame> frames, const std::string& tool);

/// Where the tool is at time t [s]. Here and below, check_key_frames() must accept the key frames.
Pose pose(std::span<const KeyFrame> frames, double t);

/// The angle [rad] between the rotations at two times: at most 180 degrees.
double turn(std::span<const KeyFrame> frames, double t0, double t1);

} // namespace kerf::cut
