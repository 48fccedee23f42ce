#include "cut/recut.h"

#include "cut/target.h"
#include "geometry/box_tree.h"
#include "geometry/predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>

namespace kerf::cut {
namespace {

using geometry::box_around;
using geometry::overlap;

struct Sweep {
  std::span<const std::array<Vec3, 3>> triangles;
  std::vector<Box> boxes;
  Box box;

  explicit Sweep(const std::span<const std::array<Vec3, 3>> strip) : triangles(strip) {
    if (strip.empty())
      return;
    box = box_around(strip.front());
    for (const auto& triangle : strip) {
      boxes.push_back(box_around(triangle));
      box.lower = box.lower.cwiseMin(boxes.back().lower);
      box.upper = box.upper.cwiseMax(boxes.back().upper);
    }
  }
};

/// The normal that a cut gets from the triangle it was made by: that of the blade's own motion, where it moves. The
/// relative motion tilts with every recoil of the material, and would roughen the cut.
Vec3 cut_normal(const Sweep& seen, const std::size_t triangle, const Sweep& blade_alone) {
  const bool same_strip = seen.triangles.size() == blade_alone.triangles.size();
  const Vec3 own = same_strip ? geometry::unit_normal(blade_alone.triangles[triangle]) : Vec3(Vec3::Zero());
  return own.isZero(0) ? geometry::unit_normal(seen.triangles[triangle]) : own;
}

/// Which of a sweep's triangles a segment crosses.
class Crossings {
 public:
  Crossings(const Sweep& sweep, const Segment& segment) : sweep_(sweep), segment_(segment) {}

  void test(const std::size_t triangle) {
    const auto& corners = sweep_.triangles[triangle];
    if (!geometry::crosses(segment_[0], segment_[1], corners))
      return;
    ++n_;
    const double t = geometry::crossing_parameter(segment_[0], segment_[1], corners);
    if (std::pair(t, triangle) < std::pair(t_, first_)) { // so that the order of the tests has no say
      t_ = t;
      first_ = triangle;
    }
  }

  Verdict verdict(const Sweep& blade_alone) const {
    return n_ == 0 ? Verdict() : Verdict{n_, t_, cut_normal(sweep_, first_, blade_alone)};
  }

 private:
  const Sweep& sweep_;
  const Segment& segment_;
  std::size_t n_ = 0;
  double t_ = std::numeric_limits<double>::infinity();
  std::size_t first_ = 0;
};

/// The similarity that takes one segment to another with the least turn.
class SegmentMap {
 public:
  SegmentMap(const Segment& from, const Segment& to)
    : from_(0.5 * (from[0] + from[1])), to_(0.5 * (to[0] + to[1])), linear_(Mat3::Identity()) {
    const Vec3 before = from[1] - from[0], after = to[1] - to[0];
    if (before.norm() > 0 && after.norm() > 0)
      linear_ = Eigen::Quaterniond::FromTwoVectors(before, after).toRotationMatrix() * (after.norm() / before.norm());
  }
  Vec3 operator()(const Vec3& p) const { return to_ + linear_ * (p - from_); }

 private:
  Vec3 from_, to_;
  Mat3 linear_;
};

/// The strip that a blade sweeps as an edge sees it that moves itself from one segment to another, in the place where
/// it ends. Where the strip of one step ends, that of the next step begins: nothing slips through between steps.
std::vector<std::array<Vec3, 3>> strip_seen_from(const BladePath& path, const Segment& before, const Segment& now) {
  std::vector<std::array<Vec3, 3>> strip;
  Points last;
  for (std::size_t k = 0; k < path.lines.size(); ++k) {
    Points line = path.lines[k];
    if (const double f = path.fractions[k]; f < 1) {
      const SegmentMap to_now({(1 - f) * before[0] + f * now[0], (1 - f) * before[1] + f * now[1]}, now);
      std::transform(line.begin(), line.end(), line.begin(), to_now);
    }
    if (k > 0)
      add_strip(last, line, strip);
    last = std::move(line);
  }
  return strip;
}

/// A sweep that few segments are tested against: its boxes one by one.
Verdict meet(const Sweep& sweep, const Segment& segment, const Sweep& blade_alone) {
  const Box box = box_around(segment);
  Crossings crossings(sweep, segment);
  if (!sweep.triangles.empty() && overlap(box, sweep.box))
    for (std::size_t i = 0; i < sweep.triangles.size(); ++i)
      if (overlap(box, sweep.boxes[i]))
        crossings.test(i);
  return crossings.verdict(blade_alone);
}

} // namespace

SweepCuts cut_edges(const std::span<const std::array<Vec3, 3>> sweep, const grid::Grid& grid, const grid::Cuts& cuts,
                    const grid::CellComplex& complex, const Points& x, const grid::CutLabel label) {
  if (sweep.empty())
    return {};
  const Target target(grid, cuts, complex, x);
  const Sweep boxed(sweep);
  const geometry::BoxTree tree(boxed.boxes);
  return target.cut(label, [&](const grid::EdgeId edge) {
    const Segment segment = target.segment(edge);
    Crossings crossings(boxed, segment);
    tree.for_each(box_around(segment), [&](const std::size_t i) { crossings.test(i); });
    return crossings.verdict(boxed);
  });
}

SweepCuts cut_edges(const BladePath& path, const grid::Grid& grid, const grid::Cuts& cuts,
                    const grid::CellComplex& complex, const Points& x_before, const Points& x,
                    const grid::CutLabel label) {
  const Target target(grid, cuts, complex, x);
  std::vector<std::array<Vec3, 3>> strip;
  Points places;
  for (std::size_t k = 0; k < path.lines.size(); ++k) {
    places.insert(places.end(), path.lines[k].begin(), path.lines[k].end());
    if (k > 0)
      add_strip(path.lines[k - 1], path.lines[k], strip);
  }
  const Sweep alone(strip); // what edges see that have not moved
  const Box reach = box_around(places);
  return target.cut(label, [&](const grid::EdgeId edge) {
    const Segment before = target.segment(edge, x_before), now = target.segment(edge);
    if (before == now)
      return meet(alone, now, alone);
    Box passed = box_around(std::array{before[0], before[1], now[0], now[1]});
    const Vec3 slack = Vec3::Constant((now[1] - now[0]).norm()); // the carried strip strays a little from the true one
    passed.lower -= slack;
    passed.upper += slack;
    if (!overlap(passed, reach))
      return Verdict();
    const auto seen = strip_seen_from(path, before, now);
    return meet(Sweep(seen), now, alone);
  });
}

} // namespace kerf::cut
