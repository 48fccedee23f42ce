#include "cut/target.h"

#include "base/parallel.h"
#include "grid/cube.h"
#include "grid/shape.h"

#include <algorithm>

namespace kerf::cut {

namespace {

constexpr std::size_t edges_per_chunk = 4096, blocks_per_chunk = 16;

/// dx/dX of a copy at a point of the unit cube.
Mat3 deformation_gradient(const grid::Copy& copy, const Points& x, const double h, const Vec3& at) {
  Mat3 F = Mat3::Zero();
  for (int v = 0; v < grid::cube::n_vertices; ++v)
    F += x[copy.corners[v].value] * grid::shape_gradient(v, at).transpose() / h;
  return F;
}

/// Runs fill(k, part) for parts 0 .. n - 1 in parallel, and joins the parts in their order.
template <class Fill>
SweepCuts joined(const std::size_t n, const Fill& fill) {
  std::vector<SweepCuts> parts(n);
  parallel_for(n, [&](const std::size_t k) { fill(k, parts[k]); });
  SweepCuts result;
  for (const SweepCuts& part : parts) {
    result.cuts.insert(result.cuts.end(), part.cuts.begin(), part.cuts.end());
    result.n_double_crossings += part.n_double_crossings;
  }
  return result;
}

} // namespace

Target::Target(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex, const Points& x_before,
               const Points& x, const EdgeBoxes* boxes)
  : grid_(grid), cuts_(cuts), complex_(complex), x_before_(x_before), x_(x), boxes_(boxes) {
  if (!boxes_) // fit() has seen to it
    require_finite(x);
}

Segment Target::segment(const grid::EdgeId edge, const Points& x) const {
  const auto& [lower, upper] = grid_.ends(edge);
  return {x[complex_.real_corner[lower].value], x[complex_.real_corner[upper].value]};
}

SweepCuts Target::cut(const grid::CutLabel label, const Nearness& near,
                      const std::function<Verdict(grid::EdgeId)>& judge) const {
  return boxes_ ? cut_near(label, near, judge) : cut_anywhere(label, judge);
}

SweepCuts Target::cut_anywhere(const grid::CutLabel label, const std::function<Verdict(grid::EdgeId)>& judge) const {
  return joined((grid_.n_edges() + edges_per_chunk - 1) / edges_per_chunk, [&](const std::size_t k, SweepCuts& part) {
    const std::size_t end = std::min(grid_.n_edges(), (k + 1) * edges_per_chunk);
    for (std::size_t e = k * edges_per_chunk; e < end; ++e)
      if (const grid::EdgeId edge(e); can_be_cut(edge))
        add(edge, judge(edge), label, part);
  });
}

SweepCuts Target::cut_near(const grid::CutLabel label, const Nearness& near,
                           const std::function<Verdict(grid::EdgeId)>& judge) const {
  const auto blocks = boxes_->blocks([&](const EdgeBoxes::Block& block) {
    return geometry::overlap(block.box, near.reach) && near.may_meet(block.box);
  });
  const std::size_t n = (blocks.size() + blocks_per_chunk - 1) / blocks_per_chunk;
  SweepCuts result = joined(n, [&](const std::size_t k, SweepCuts& part) {
    for (std::size_t b = k * blocks_per_chunk; b < std::min(blocks.size(), (k + 1) * blocks_per_chunk); ++b)
      boxes_->for_each_edge(blocks[b], [&](const grid::CornerId lower, const grid::CornerId upper, const int axis) {
        const Segment before{x_before_[lower.value], x_before_[upper.value]}, now{x_[lower.value], x_[upper.value]};
        if (!geometry::overlap(room(before, now), near.reach))
          return;
        const grid::EdgeId edge = grid_.edge(complex_.node[lower], axis);
        if (can_be_cut(edge))
          add(edge, judge(edge), label, part);
      });
  });
  std::sort(result.cuts.begin(), result.cuts.end(),
            [](const grid::EdgeCut& a, const grid::EdgeCut& b) { return a.edge < b.edge; });
  return result;
}

bool Target::can_be_cut(const grid::EdgeId edge) const {
  const auto& [lower, upper] = grid_.ends(edge);
  return !cuts_.is_cut(edge) && grid_.is_material(lower) && grid_.is_material(upper);
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
