#include "cut/target.h"

#include "base/error.h"
#include "base/parallel.h"
#include "grid/cube.h"

#include <algorithm>
#include <string>

namespace kerf::cut {

namespace {

constexpr std::size_t edges_per_chunk = 4096;

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

} // namespace

Target::Target(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex, const Points& x)
  : grid_(grid), cuts_(cuts), complex_(complex), x_(x) {
  require_finite(x);
}

Segment Target::segment(const grid::EdgeId edge, const Points& x) const {
  const auto& [lower, upper] = grid_.ends(edge);
  return {x[complex_.real_corner[lower].value], x[complex_.real_corner[upper].value]};
}

SweepCuts Target::cut(const grid::CutLabel label, const std::function<Verdict(grid::EdgeId)>& judge) const {
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

bool Target::is_inside(const grid::EdgeId edge) const {
  const auto& [lower, upper] = grid_.ends(edge);
  return grid_.is_material(lower) && grid_.is_material(upper);
}

void Target::add(const grid::EdgeId edge, const Verdict& verdict, const grid::CutLabel label, SweepCuts& result) const {
  if (verdict.n_crossings % 2 == 1)
    result.cuts.push_back({edge, verdict.t, rest_normal(edge, verdict.t, verdict.normal), label});
  else if (verdict.n_crossings > 0)
    ++result.n_double_crossings;
}

Vec3 Target::rest_normal(const grid::EdgeId edge, const double t, const Vec3& normal) const {
  const Vec3 pulled_back = mean_gradient(edge, t).transpose() * normal;
  // Along the edge it is n . (q - p) / h, which is 0 only by rounding, since the surface is crossed.
  const double length = pulled_back.norm();
  return length > 0 ? Vec3(pulled_back / length) : Vec3::Unit(grid_.axis(edge));
}

Mat3 Target::mean_gradient(const grid::EdgeId edge, const double t) const {
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

} // namespace kerf::cut
