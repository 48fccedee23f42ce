#include "cut/blade.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parameters.h"

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

/// [degrees]
double hinge_angle(const Hinge& hinge, const double t) {
  const auto& angles = hinge.angles;
  const auto after = std::find_if(angles.begin(), angles.end(), [t](const AngleFrame& a) { return a.time > t; });
  if (after == angles.begin())
    return angles.front().angle;
  const AngleFrame& before = *(after - 1);
  if (after == angles.end())
    return before.angle;
  return before.angle + (t - before.time) / (after->time - before.time) * (after->angle - before.angle);
}

Pose hinge_pose(const Hinge& hinge, const double t) {
  const Mat3 R = Eigen::AngleAxisd(hinge_angle(hinge, t) * radians, hinge.axis).toRotationMatrix();
  return {hinge.pivot - R * hinge.pivot, R};
}

/// At most how far the blade turns between two times without a key frame in between [rad].
double turn(const Blade& blade, const double t0, const double t1) {
  const double of_tool = turn(blade.key_frames, t0, t1);
  if (!blade.hinge)
    return of_tool;
  return of_tool + radians * std::abs(hinge_angle(*blade.hinge, t1) - hinge_angle(*blade.hinge, t0));
}

/// The ends of a step and the key frames within, in order.
Loan<double> breaks(const Blade& blade, const double t0, const double t1) {
  Loan<double> times =
    Loan<double>::with_room(2 + blade.key_frames.size() + (blade.hinge ? blade.hinge->angles.size() : 0));
  times->assign({t0, t1});
  const auto add = [&](const double t) {
    if (t0 < t && t < t1)
      times->push_back(t);
  };
  for (const KeyFrame& frame : blade.key_frames)
    add(frame.time);
  if (blade.hinge)
    for (const AngleFrame& frame : blade.hinge->angles)
      add(frame.time);
  std::sort(times.begin(), times.end());
  times->erase(std::unique(times.begin() + 1, times.end()), times.end()); // a step without length keeps both its ends
  return times;
}

/// Does the blade cut between two times without a key frame in between? On a hinge only while its angle falls.
bool cuts_between(const Blade& blade, const double t0, const double t1) {
  return !blade.hinge || std::abs(hinge_angle(*blade.hinge, t1)) < std::abs(hinge_angle(*blade.hinge, t0));
}

/// Calls begin() for each path, and then add(time) for each of its moments.
template <class Begin, class Add>
void for_each_moment(const Blade& blade, const double t0, const double t1, const Begin& begin, const Add& add) {
  if (!(t0 < t1))
    return;
  const Loan<double> times = breaks(blade, t0, t1);
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const double from = times[k], to = times[k + 1];
    if (!cuts_between(blade, from, to))
      continue;
    const int n = std::max(1, static_cast<int>(std::ceil(turn(blade, from, to) / max_turn - 1e-9)));
    begin();
    for (int i = 0; i <= n; ++i)
      add(i < n ? from + (to - from) * i / n : to);
  }
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

void check_hinge(const Blade& blade) {
  const Hinge& hinge = *blade.hinge;
  if (!hinge.pivot.allFinite())
    refuse(blade, "Pivot [m]", "", "must be finite", "Write three numbers");
  if (!(std::abs(hinge.axis.norm() - 1) < 1e-9))
    refuse(blade, "Axis [1]", "", "must be a direction: finite and not zero", "Write the axis that the blade turns on");
  if (hinge.angles.empty())
    refuse(blade, "Angles", "none", "must have at least one angle", "Write how far the blade is turned");
  for (std::size_t k = 0; k < hinge.angles.size(); ++k) {
    const AngleFrame& frame = hinge.angles[k];
    if (!std::isfinite(frame.time) || !(std::abs(frame.angle) < 180))
      refuse(blade, "Angles", to_text(frame.angle) + " degrees at " + to_text(frame.time) + " s",
             "must be less than 180 degrees at a finite time", "Write smaller angles");
    if (k > 0 && !(hinge.angles[k - 1].time < frame.time))
      refuse(blade, "Angle times",
             "time " + to_text(frame.time) + " s after " + to_text(hinge.angles[k - 1].time) + " s",
             "times must increase", "Sort the angles and remove repeated times");
  }
}

} // namespace

void check(const Blade& blade) {
  check_edge(blade);
  check_key_frames(blade.key_frames, "Blade " + blade.name);
  if (blade.hinge)
    check_hinge(blade);
}

void divide_edge_of_turning(Blade& blade, const double longest) {
  constexpr double most = 200;
  bool turns = blade.hinge.has_value();
  for (std::size_t k = 1; k < blade.key_frames.size(); ++k)
    turns |= blade.key_frames[k].rotation != blade.key_frames[k - 1].rotation;
  if (!turns)
    return;
  Points edge = {blade.edge.front()};
  for (std::size_t i = 1; i < blade.edge.size(); ++i) {
    const Vec3 &from = blade.edge[i - 1], &to = blade.edge[i];
    const auto n = static_cast<int>(std::clamp(std::ceil((to - from).norm() / longest), 1.0, most));
    for (int k = 1; k < n; ++k)
      edge.push_back(from + double(k) / n * (to - from));
    edge.push_back(to);
  }
  blade.edge = std::move(edge);
}

Pose pose(const Blade& blade, const double t) {
  const Pose tool = pose(blade.key_frames, t);
  if (!blade.hinge)
    return tool;
  const Pose within = hinge_pose(*blade.hinge, t);
  return {tool(within.position), tool.rotation * within.rotation};
}

void put_world_points(const Blade& blade, const double t, Points& points) {
  const Pose placed = pose(blade, t);
  points.resize(blade.edge.size());
  std::ranges::transform(blade.edge, points.begin(), placed);
}

Points world_points(const Blade& blade, const double t) {
  Points points;
  put_world_points(blade, t, points);
  return points;
}

std::vector<BladePath> paths(const Blade& blade, const double t0, const double t1) {
  std::vector<BladePath> result;
  for_each_moment(
    blade, t0, t1, [&] { result.emplace_back(); },
    [&](const double t) {
      result.back().fractions.push_back((t - t0) / (t1 - t0));
      result.back().lines.push_back(world_points(blade, t));
    });
  return result;
}

Box reach_of_paths(const Blade& blade, const double t0, const double t1) {
  Box box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for_each_moment(
    blade, t0, t1, [] {},
    [&](const double t) {
      const Pose placed = pose(blade, t);
      for (const Vec3& p : blade.edge) {
        box.lower = box.lower.cwiseMin(placed(p));
        box.upper = box.upper.cwiseMax(placed(p));
      }
    });
  return box;
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
  for (const BladePath& path : paths(blade, t0, t1))
    for (std::size_t k = 1; k < path.lines.size(); ++k)
      add_strip(path.lines[k - 1], path.lines[k], strip);
  return strip;
}

} // namespace kerf::cut
