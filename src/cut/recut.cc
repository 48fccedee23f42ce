#include "cut/recut.h"

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/predicates.h"
#include "grid/cube.h"

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
  if (!overlap(box, sweep.box))
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

/// Decides about one edge at a time.
class Cutter {
 public:
  Cutter(const Sweep& sweep, const grid::Grid& grid, const grid::CellComplex& complex, const Points& x,
         const grid::CutLabel label)
    : sweep_(sweep), grid_(grid), complex_(complex), x_(x), label_(label) {}

  void add(const grid::EdgeId edge, SweepCuts& result) const {
    const auto& [lower, upper] = grid_.ends(edge);
    if (!grid_.is_material(lower) || !grid_.is_material(upper))
      return;
    const Crossings found =
      crossings(sweep_, x_[complex_.real_corner[lower].value], x_[complex_.real_corner[upper].value]);
    if (found.n % 2 == 1)
      result.cuts.push_back({edge, found.t, rest_normal(edge, found), label_});
    else if (found.n > 0)
      ++result.n_double_crossings;
  }

 private:
  Vec3 rest_normal(const grid::EdgeId edge, const Crossings& found) const {
    const Vec3 normal = geometry::unit_normal(sweep_.triangles[found.triangle]);
    const Vec3 pulled_back = mean_gradient(edge, found.t).transpose() * normal;
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

  const Sweep& sweep_;
  const grid::Grid& grid_;
  const grid::CellComplex& complex_;
  const Points& x_;
  grid::CutLabel label_;
};

/// Exact predicates have no answer for what is not a number.
void require_finite(const Points& x) {
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!x[i].allFinite())
      throw NumericalError("the position of corner " + std::to_string(i) + " is not finite, so it cannot be cut");
}

} // namespace

SweepCuts cut_edges(const std::span<const std::array<Vec3, 3>> sweep, const grid::Grid& grid, const grid::Cuts& cuts,
                    const grid::CellComplex& complex, const Points& x, const grid::CutLabel label) {
  SweepCuts result;
  if (sweep.empty())
    return result;
  require_finite(x);
  const Sweep boxed(sweep);
  const Cutter cutter(boxed, grid, complex, x, label);
  std::vector<SweepCuts> parts((grid.n_edges() + edges_per_chunk - 1) / edges_per_chunk);
  parallel_for(parts.size(), [&](const std::size_t k) {
    const std::size_t end = std::min(grid.n_edges(), (k + 1) * edges_per_chunk);
    for (std::size_t e = k * edges_per_chunk; e < end; ++e)
      if (const grid::EdgeId edge(e); !cuts.is_cut(edge))
        cutter.add(edge, parts[k]);
  });
  for (const SweepCuts& part : parts) {
    result.cuts.insert(result.cuts.end(), part.cuts.begin(), part.cuts.end());
    result.n_double_crossings += part.n_double_crossings;
  }
  return result;
}

} // namespace kerf::cut
