#include "cut/blade.h"

#include "base/error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::cut {
namespace {

constexpr double radians = std::numbers::pi / 180;
constexpr double max_turn = 2 * radians; ///< of one pair of strip triangles

[[noreturn]] void refuse(const Blade& blade, const std::string& path, const std::string& value, const std::string& rule,
                         const std::string& remedy) {
  throw ParameterError(
    Complaint{.path = "Blade " + blade.name + "/" + path, .value = value, .rule = rule, .remedy = remedy});
}

/// Not normalised in sign: the two quaternions of one rotation tell turns by 10 and by 370 degrees apart.
Eigen::Quaterniond quaternion(const Vec3& rotation_in_degrees) {
  const double angle = rotation_in_degrees.norm() * radians;
  const Vec3 axis = angle > 0 ? Vec3(rotation_in_degrees.normalized()) : Vec3::UnitX();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

Eigen::Quaterniond rotation(const Blade& blade, const double t) {
  const auto& frames = blade.key_frames;
  const auto after = std::find_if(frames.begin(), frames.end(), [t](const KeyFrame& k) { return k.time > t; });
  if (after == frames.begin())
    return quaternion(frames.front().rotation);
  const KeyFrame& before = *(after - 1);
  if (after == frames.end() || before.rotation == after->rotation) // exactly at rest, where slerp would round
    return quaternion(before.rotation);
  const double part = (t - before.time) / (after->time - before.time);
  return quaternion(before.rotation).slerp(part, quaternion(after->rotation));
}

Vec3 position(const Blade& blade, const double t) {
  const auto& frames = blade.key_frames;
  const auto after = std::find_if(frames.begin(), frames.end(), [t](const KeyFrame& k) { return k.time > t; });
  if (after == frames.begin())
    return frames.front().position;
  const KeyFrame& before = *(after - 1);
  if (after == frames.end())
    return before.position;
  return before.position + (t - before.time) / (after->time - before.time) * (after->position - before.position);
}

/// Times at which the strip has vertices.
std::vector<double> strip_times(const Blade& blade, const double t0, const double t1) {
  std::vector<double> breaks = {t0};
  for (const KeyFrame& frame : blade.key_frames)
    if (t0 < frame.time && frame.time < t1)
      breaks.push_back(frame.time);
  breaks.push_back(t1);

  std::vector<double> times = {t0};
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double turn = rotation(blade, breaks[k]).angularDistance(rotation(blade, breaks[k + 1]));
    const int n = std::max(1, static_cast<int>(std::ceil(turn / max_turn - 1e-9)));
    for (int i = 1; i < n; ++i)
      times.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * i / n);
    times.push_back(breaks[k + 1]);
  }
  return times;
}

void check_edge(const Blade& blade) {
  const Points& edge = blade.edge;
  if (edge.size() < 2)
    refuse(blade, "Edge [m]", std::to_string(edge.size()) + " points", "must have at least two points",
           "Write the ends of the cutting edge");
  for (std::size_t i = 0; i < edge.size(); ++i)
    if (!edge[i].allFinite())
      refuse(blade, "Edge [m]", "point " + std::to_string(i + 1), "must be finite", "Write three numbers");
  for (std::size_t i = 1; i < edge.size(); ++i)
    if (edge[i] == edge[i - 1])
      refuse(blade, "Edge [m]", "point " + std::to_string(i + 1), "must differ from the point before it", "Remove it");
}

void check_pair(const Blade& blade, const KeyFrame& before, const KeyFrame& after) {
  if (!(before.time < after.time))
    refuse(blade, "Key frames", "time " + std::to_string(after.time) + " s after " + std::to_string(before.time) + " s",
           "times must increase", "Sort the key frames and remove repeated times");
  if (quaternion(before.rotation).dot(quaternion(after.rotation)) < 1e-9)
    refuse(blade, "Key frames", "rotation at " + std::to_string(after.time) + " s",
           "must be turned by less than 180 degrees from the key frame before it",
           "Add a key frame between them, to say which way the blade turns");
}

} // namespace

void check(const Blade& blade) {
  check_edge(blade);
  const auto& frames = blade.key_frames;
  if (frames.empty())
    refuse(blade, "Key frames", "none", "must have at least one key frame", "Write where the blade is");
  for (const KeyFrame& frame : frames)
    if (!std::isfinite(frame.time) || !frame.position.allFinite() || !frame.rotation.allFinite())
      refuse(blade, "Key frames", "key frame " + std::to_string(&frame - frames.data() + 1), "must be finite",
             "Write numbers");
  for (std::size_t k = 0; k + 1 < frames.size(); ++k)
    check_pair(blade, frames[k], frames[k + 1]);
}

Pose pose(const Blade& blade, const double t) { return {position(blade, t), rotation(blade, t).toRotationMatrix()}; }

Points world_points(const Blade& blade, const double t) {
  const Pose placed = pose(blade, t);
  Points points;
  points.reserve(blade.edge.size());
  for (const Vec3& p : blade.edge)
    points.push_back(placed(p));
  return points;
}

BladePath path(const Blade& blade, const double t0, const double t1) {
  BladePath result;
  for (const double t : strip_times(blade, t0, t1)) {
    result.fractions.push_back((t - t0) / (t1 - t0));
    result.lines.push_back(world_points(blade, t));
  }
  return result;
}

void add_strip(const Points& before, const Points& after, std::vector<std::array<Vec3, 3>>& strip) {
  if (after == before)
    return;
  for (std::size_t i = 0; i + 1 < before.size(); ++i) {
    strip.push_back({before[i], before[i + 1], after[i + 1]});
    strip.push_back({before[i], after[i + 1], after[i]});
  }
}

std::vector<std::array<Vec3, 3>> sweep(const Blade& blade, const double t0, const double t1) {
  std::vector<std::array<Vec3, 3>> strip;
  if (!(t0 < t1))
    return strip;
  const BladePath places = path(blade, t0, t1);
  for (std::size_t k = 1; k < places.lines.size(); ++k)
    add_strip(places.lines[k - 1], places.lines[k], strip);
  return strip;
}

} // namespace kerf::cut
