#include "cut/motion.h"

#include "base/error.h"
#include "base/parameters.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::cut {
namespace {

constexpr double radians_a_degree = std::numbers::pi / 180;

using Frames = std::span<const KeyFrame>;

/// Not normalised in sign: the two quaternions of one rotation tell turns by 10 and by 370 degrees apart.
Eigen::Quaterniond quaternion(const Vec3& rotation_in_degrees) {
  const double angle = rotation_in_degrees.norm() * radians_a_degree;
  const Vec3 axis = angle > 0 ? Vec3(rotation_in_degrees.normalized()) : Vec3::UnitX();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

Eigen::Quaterniond rotation(const Frames frames, const double t) {
  const auto after = std::find_if(frames.begin(), frames.end(), [t](const KeyFrame& k) { return k.time > t; });
  if (after == frames.begin())
    return quaternion(frames.front().rotation);
  const KeyFrame& before = *(after - 1);
  if (after == frames.end() || before.rotation == after->rotation) // exactly at rest, where slerp would round
    return quaternion(before.rotation);
  const double part = (t - before.time) / (after->time - before.time);
  return quaternion(before.rotation).slerp(part, quaternion(after->rotation));
}

Vec3 position(const Frames frames, const double t) {
  const auto after = std::find_if(frames.begin(), frames.end(), [t](const KeyFrame& k) { return k.time > t; });
  if (after == frames.begin())
    return frames.front().position;
  const KeyFrame& before = *(after - 1);
  if (after == frames.end())
    return before.position;
  return before.position + (t - before.time) / (after->time - before.time) * (after->position - before.position);
}

[[noreturn]] void refuse(const std::string& tool, const std::string& value, const std::string& rule,
                         const std::string& remedy, const std::string& what = "Key frames") {
  throw ParameterError(Complaint{.path = tool + '/' + what, .value = value, .rule = rule, .remedy = remedy});
}

void check_pair(const KeyFrame& before, const KeyFrame& after, const std::string& tool) {
  if (!(before.time < after.time))
    refuse(tool, "time " + to_text(after.time) + " s after " + to_text(before.time) + " s", "times must increase",
           "Sort the key frames and remove repeated times");
  if (quaternion(before.rotation).dot(quaternion(after.rotation)) < 1e-9)
    refuse(tool, "rotation at " + to_text(after.time) + " s",
           "must be turned by less than 180 degrees from the key frame before it",
           "Add a key frame between them, to say which way it turns", "Rotations");
}

} // namespace

void check_key_frames(const Frames frames, const std::string& tool) {
  if (frames.empty())
    refuse(tool, "none", "must have at least one key frame", "Write where it is");
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (!std::isfinite(frames[k].time) || !frames[k].position.allFinite() || !frames[k].rotation.allFinite())
      refuse(tool, "key frame " + std::to_string(k + 1), "must be finite", "Write numbers");
  for (std::size_t k = 0; k + 1 < frames.size(); ++k)
    check_pair(frames[k], frames[k + 1], tool);
}

Pose pose(const Frames frames, const double t) { return {position(frames, t), rotation(frames, t).toRotationMatrix()}; }

double turn(const Frames frames, const double t0, const double t1) {
  return rotation(frames, t0).angularDistance(rotation(frames, t1));
}

} // namespace kerf::cut
