#include "cut/recut.h"

#include "cut/moving_edge.h"
#include "cut/near_sweep.h"
#include "cut/target.h"
#include "geometry/box_tree.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <limits>

namespace kerf::cut {
namespace {

using geometry::box_around;
using geometry::overlap;

using Strip = std::span<const std::array<Vec3, 3>>;

/// Which of a sweep's triangles a segment crosses.
class Crossings {
 public:
  Crossings(const Strip sweep, const Segment& segment) : sweep_(sweep), segment_(segment) {}

  void test(const std::size_t triangle) {
    const auto& corners = sweep_[triangle];
    if (!geometry::crosses(segment_[0], segment_[1], corners))
      return;
    ++n_;
    const double t = geometry::crossing_parameter(segment_[0], segment_[1], corners);
    if (std::pair(t, triangle) < std::pair(t_, first_)) { // so that the order of the tests has no say
      t_ = t;
      first_ = triangle;
    }
  }

  Verdict verdict() const { return n_ == 0 ? Verdict() : Verdict{n_, t_, geometry::unit_normal(sweep_[first_])}; }

 private:
  Strip sweep_;
  const Segment& segment_;
  std::size_t n_ = 0;
  double t_ = std::numeric_limits<double>::infinity();
  std::size_t first_ = 0;
};

} // namespace

void append(SweepCuts& all, const SweepCuts& more) {
  all.cuts.insert(all.cuts.end(), more.cuts.begin(), more.cuts.end());
  all.of_skin.insert(all.of_skin.end(), more.of_skin.begin(), more.of_skin.end());
  all.later.insert(all.later.end(), more.later.begin(), more.later.end());
  all.later_of_skin.insert(all.later_of_skin.end(), more.later_of_skin.begin(), more.later_of_skin.end());
  all.n_double_crossings += more.n_double_crossings;
}

SweepCuts cut_edges(const Strip sweep, const grid::Solid& solid, const Points& x, const grid::CutLabel label,
                    const EdgeBoxes* const boxes) {
  if (sweep.empty())
    return {};
  const Target target(solid, x, x, boxes);
  std::vector<Box> triangle_boxes;
  for (const auto& triangle : sweep)
    triangle_boxes.push_back(box_around(triangle));
  const geometry::BoxTree tree(triangle_boxes);
  const NearSweep near(patches(sweep));
  return target.cut(label, {near.reach(), [&](const Box& box) { return near.may_be_in(box); }},
                    [&](const Segment&, const Segment& segment) {
                      Crossings crossings(sweep, segment);
                      tree.for_each(box_around(segment), [&](const std::size_t i) { crossings.test(i); });
                      return crossings.verdict();
                    });
}

SweepCuts cut_edges(const BladePath& path, const grid::Solid& solid, const Points& x_before, const Points& x,
                    const grid::CutLabel label, const EdgeBoxes* const boxes, const SkinPlaces* const places_before) {
  if ((!places_before || places_before->empty()) && (boxes ? !boxes->moves() : x_before == x)) { // one method for all edges of a body: they agree on what passes their
    std::vector<std::array<Vec3, 3>> strip;      // common node
    for (std::size_t k = 1; k < path.lines.size(); ++k)
      add_strip(path.lines[k - 1], path.lines[k], strip);
    return cut_edges(strip, solid, x, label, boxes);
  }
  const Target target(solid, x_before, x, boxes, places_before);
  const NearSweep near(patches(path));
  return target.cut(label, {near.reach(), [&](const Box& box) { return near.may_be_in(box); }},
                    [&](const Segment& before, const Segment& now) {
                      return overlap(room(before, now), near.reach()) ? meet(path, before, now) : Verdict();
                    });
}

} // namespace kerf::cut
