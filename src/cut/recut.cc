#include "cut/recut.h"

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/predicates.h"
#include "grid/cube.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <string>

namespace kerf::cut {
namespace {

constexpr std::size_t edges_per_chunk = 4096;

Box box_around(const std::span<const Vec3> points) {
  Box box{points.front(), points.front()};
  for (const Vec3& p : points) {
    box.lower = box.lower.cwiseMin(p);
    box.upper = box.upper.cwiseMax(p);
  }
  return box;
}

/// Closed boxes: the displaced triangle may be met from its very border.
bool overlap(const Box& a, const Box& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

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

struct Crossings {
  std::size_t n = 0;
  double t = std::numeric_limits<double>::infinity(); ///< of the first one [1]
  std::size_t triangle = 0;                           ///< of the first one
};

Crossings crossings(const Sweep& sweep, const Vec3& p, const Vec3& q) {
  Crossings found;
  const Box box = box_around(std::array{p, q});
  if (sweep.triangles.empty() || !overlap(box, sweep.box))
    return found;
  for (std::size_t i = 0; i < sweep.triangles.size(); ++i) {
    if (!overlap(box, sweep.boxes[i]) || !geometry::crosses(p, q, sweep.triangles[i]))
      continue;
    ++found.n;
    if (const double t = geometry::crossing_parameter(p, q, sweep.triangles[i]); t < found.t) {
      found.t = t;
      found.triangle = i;
    }
  }
  return found;
}

/// dx/dX of a copy at a point of the unit cube: sum of corners times gradients of the trilinear shape functions.
Mat3 deformation_gradient(const grid::Copy& copy, const Points& x, const double h, const Vec3& at) {
  Mat3 F = Mat3::Zero();
  for (int v = 0; v < grid::cube::n_vertices; ++v) {
    Vec3 value, slope;
    for (int d = 0; d < 3; ++d) {
      const bool is_upper = v >> d & 1;
      value[d] = is_upper ? at[d] : 1 - at[d];
      slope[d] = is_upper ? 1 : -1;
    }
    const Vec3 gradient(slope[0] * value[1] * value[2], value[0] * slope[1] * value[2], value[0] * value[1] * slope[2]);
    F += x[copy.corners[v].value] * gradient.transpose() / h;
  }
  return F;
}

/// Exact predicates have no answer for what is not a number.
void require_finite(const Points& x) {
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!x[i].allFinite())
      throw NumericalError("the position of corner " + std::to_string(i) + " is not finite, so it cannot be cut");
}

/// An edge of the grid as a segment of the current configuration.
using Segment = std::array<Vec3, 2>;

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

/// The strip that a blade sweeps as an edge sees it that moves itself from one segment to another, in the place where it
/// ends. Where the strip of one step ends, that of the next step begins: nothing slips through between steps.
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

/// The normal that a cut gets from the triangle it was made by: that of the blade's own motion, where it moves. The relative
/// motion tilts with every recoil of the material, and would roughen the cut.
Vec3 cut_normal(const Sweep& seen, const std::size_t triangle, const Sweep& blade_alone) {
  const bool same_strip = seen.triangles.size() == blade_alone.triangles.size();
  const Vec3 own = same_strip ? geometry::unit_normal(blade_alone.triangles[triangle]) : Vec3(Vec3::Zero());
  return own.isZero(0) ? geometry::unit_normal(seen.triangles[triangle]) : own;
}

/// Which crossings an edge has, and with what.
struct Verdict {
  Crossings crossings;
  Vec3 normal = Vec3::Zero(); ///< unit normal of the cut where it is met first, current configuration
};

Verdict meet(const Sweep& sweep, const Segment& segment, const Sweep& blade_alone) {
  Verdict verdict{crossings(sweep, segment[0], segment[1])};
  if (verdict.crossings.n > 0)
    verdict.normal = cut_normal(sweep, verdict.crossings.triangle, blade_alone);
  return verdict;
}

/// The body that is cut, edge by edge.
class Target {
 public:
  Target(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex, const Points& x)
    : grid_(grid), cuts_(cuts), complex_(complex), x_(x) {
    require_finite(x);
  }

  Segment segment(const grid::EdgeId edge, const Points& x) const {
    const auto& [lower, upper] = grid_.ends(edge);
    return {x[complex_.real_corner[lower].value], x[complex_.real_corner[upper].value]};
  }
  Segment segment(const grid::EdgeId edge) const { return segment(edge, x_); }

  /// Cuts every edge inside the material that `judge` (edge -> Verdict) finds crossed an odd number of times.
  template <class Judge>
  SweepCuts cut(const grid::CutLabel label, const Judge& judge) const {
    std::vector<SweepCuts> parts((grid_.n_edges() + edges_per_chunk - 1) / edges_per_chunk);
    parallel_for(parts.size(), [&](const std::size_t k) {
      const std::size_t end = std::min(grid_.n_edges(), (k + 1) * edges_per_chunk);
      for (std::size_t e = k * edges_per_chunk; e < end; ++e)
        if (const grid::EdgeId edge(e); !cuts_.is_cut(edge) && is_inside(edge))
          add(edge, judge(edge), label, parts[k]);
    });
    SweepCuts result;
    for (const SweepCuts& part : parts) {
      result.cuts.insert(result.cuts.end(), part.cuts.begin(), part.cuts.end());
      result.n_double_crossings += part.n_double_crossings;
    }
    return result;
  }

 private:
  bool is_inside(const grid::EdgeId edge) const {
    const auto& [lower, upper] = grid_.ends(edge);
    return grid_.is_material(lower) && grid_.is_material(upper);
  }

  void add(const grid::EdgeId edge, const Verdict& verdict, const grid::CutLabel label, SweepCuts& result) const {
    const Crossings& found = verdict.crossings;
    if (found.n % 2 == 1)
      result.cuts.push_back({edge, found.t, rest_normal(edge, found.t, verdict.normal), label});
    else if (found.n > 0)
      ++result.n_double_crossings;
  }

  Vec3 rest_normal(const grid::EdgeId edge, const double t, const Vec3& normal) const {
    const Vec3 pulled_back = mean_gradient(edge, t).transpose() * normal;
    // Along the edge it is n . (q - p) / h, which is 0 only by rounding, since the triangle is crossed.
    const double length = pulled_back.norm();
    return length > 0 ? Vec3(pulled_back / length) : Vec3::Unit(grid_.axis(edge));
  }

  Mat3 mean_gradient(const grid::EdgeId edge, const double t) const {
    const grid::NodeId lower = grid_.ends(edge)[0];
    Mat3 sum = Mat3::Zero();
    for (const grid::CellId c : grid_.cells(edge)) {
      if (!c.valid())
        continue;
      const auto& nodes = grid_.nodes(c);
      const int vertex = static_cast<int>(std::find(nodes.begin(), nodes.end(), lower) - nodes.begin());
      Vec3 at(vertex & 1, vertex >> 1 & 1, vertex >> 2 & 1);
      at[grid_.axis(edge)] = t;
      sum += deformation_gradient(complex_.copies[complex_.copy_at(c, vertex)], x_, grid_.h(), at);
    }
    return sum; // only its direction matters, so the sum is as good as the mean
  }

  const grid::Grid& grid_;
  const grid::Cuts& cuts_;
  const grid::CellComplex& complex_;
  const Points& x_;
};

} // namespace

SweepCuts cut_edges(const std::span<const std::array<Vec3, 3>> sweep, const grid::Grid& grid, const grid::Cuts& cuts,
                    const grid::CellComplex& complex, const Points& x, const grid::CutLabel label) {
  if (sweep.empty())
    return {};
  const Target target(grid, cuts, complex, x);
  const Sweep boxed(sweep);
  return target.cut(label, [&](const grid::EdgeId edge) { return meet(boxed, target.segment(edge), boxed); });
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
