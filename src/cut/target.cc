#include "cut/target.h"

#include "base/parallel.h"
#include "grid/parts.h"
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

/// The vertex that a node is of a cell.
int vertex_of(const grid::Grid& grid, const grid::CellId c, const grid::NodeId node) {
  const auto nodes = grid.nodes(c);
  return static_cast<int>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
}

/// The block's box holds edges between material nodes; edges of the skin begin at one of those. How far they reach, to
/// corners outside of the material, is not known: not farther than so many times the longest edge of the body.
constexpr double reach_of_skin = 4;

Box with_skin(const EdgeBoxes::Block& block, const double longest) {
  const Vec3 slack = Vec3::Constant(reach_of_skin * longest);
  return {block.box.lower - slack, block.box.upper + slack};
}

} // namespace

Target::Target(const grid::Solid& solid, const Points& x_before, const Points& x, const EdgeBoxes* boxes)
  : solid_(solid), x_before_(x_before), x_(x), boxes_(boxes) {
  if (!boxes_) // fit() has seen to it
    require_finite(x);
}

Segment Target::segment(const grid::EdgeId edge, const Points& x) const { return ends_of(solid_, edge).segment(x); }

SweepCuts Target::cut(const grid::CutLabel label, const Nearness& near,
                      const std::function<Verdict(grid::EdgeId)>& judge) const {
  return boxes_ ? cut_near(label, near, judge) : cut_anywhere(label, judge);
}

SweepCuts Target::cut_anywhere(const grid::CutLabel label, const std::function<Verdict(grid::EdgeId)>& judge) const {
  return joined((solid_.grid.n_edges() + edges_per_chunk - 1) / edges_per_chunk,
                [&](const std::size_t k, SweepCuts& part) {
                  const std::size_t end = std::min(solid_.grid.n_edges(), (k + 1) * edges_per_chunk);
                  for (std::size_t e = k * edges_per_chunk; e < end; ++e)
                    if (const grid::EdgeId edge(e); solid_.cuts.can_be_cut(solid_.grid, edge))
                      add(edge, judge(edge), label, part);
                });
}

SweepCuts Target::cut_near(const grid::CutLabel label, const Nearness& near,
                           const std::function<Verdict(grid::EdgeId)>& judge) const {
  const auto is_near = [&](const Box& box) { return geometry::overlap(box, near.reach) && near.may_meet(box); };
  const double longest = std::max(boxes_->longest(), solid_.grid.h());
  const auto blocks = boxes_->blocks([&](const EdgeBoxes::Block& block) { return is_near(with_skin(block, longest)); });
  const std::size_t n = (blocks.size() + blocks_per_chunk - 1) / blocks_per_chunk;
  SweepCuts result = joined(n, [&](const std::size_t k, SweepCuts& part) {
    const auto add_judged = [&](const grid::EdgeId edge) { add(edge, judge(edge), label, part); };
    for (std::size_t b = k * blocks_per_chunk; b < std::min(blocks.size(), (k + 1) * blocks_per_chunk); ++b) {
      judge_skin(blocks[b], near, longest, add_judged);
      if (!is_near(boxes_->block(blocks[b]).box))
        continue;
      boxes_->for_each_edge(blocks[b], [&](const grid::CornerId lower, const grid::CornerId upper, const int axis) {
        const Segment before{x_before_[lower.value], x_before_[upper.value]}, now{x_[lower.value], x_[upper.value]};
        if (!geometry::overlap(room(before, now), near.reach))
          return;
        const grid::EdgeId edge = solid_.grid.edge(solid_.complex.node[lower], axis);
        if (solid_.cuts.can_be_cut(solid_.grid, edge))
          add_judged(edge);
      });
    }
  });
  std::sort(result.cuts.begin(), result.cuts.end(),
            [](const grid::EdgeCut& a, const grid::EdgeCut& b) { return a.edge < b.edge; });
  return result;
}

void Target::judge_skin(const std::uint32_t block, const Nearness& near, const double longest,
                        const std::function<void(grid::EdgeId)>& judge) const {
  const double room_around = reach_of_skin * longest;
  const auto is_near = [&](const Vec3& before, const Vec3& now) {
    return ((near.reach.lower - before.cwiseMax(now)).array() <= room_around).all() &&
           ((before.cwiseMin(now) - near.reach.upper).array() <= room_around).all();
  };
  boxes_->for_each_skin_edge(block, [&](const grid::EdgeId edge, const grid::CornerId corner) {
    if (!is_near(x_before_[corner.value], x_[corner.value]) || !solid_.cuts.can_be_cut(solid_.grid, edge))
      return;
    const EdgeEnds ends = ends_of(solid_, edge);
    if (geometry::overlap(room(ends.segment(x_before_), ends.segment(x_)), near.reach))
      judge(edge);
  });
}

void Target::add(const grid::EdgeId edge, const Verdict& verdict, const grid::CutLabel label, SweepCuts& result) const {
  if (verdict.n_crossings % 2 == 1) {
    const EdgeEnds ends = ends_of(solid_, edge);
    const double t = ends.from + verdict.t * (ends.to - ends.from), least = grid::min_edge_parameter;
    if ((ends.from == 0 || t > ends.from + least) && (ends.to == 1 || t < ends.to - least)) // else on the skin itself
      result.cuts.push_back({edge, t, pulled_back(solid_, x_, edge, t, verdict.normal), label});
  } else if (verdict.n_crossings > 0)
    ++result.n_double_crossings;
}

EdgeEnds ends_of(const grid::Solid& solid, const grid::EdgeId edge) {
  const auto& [lower, upper] = solid.grid.ends(edge);
  const bool from_lower = solid.grid.is_material(lower);
  if (from_lower == solid.grid.is_material(upper))
    return {{solid.complex.real_corner[lower], solid.complex.real_corner[upper]}};
  const auto around = solid.grid.cells(edge);
  const grid::CellId c = *std::ranges::find_if(around, [](const grid::CellId cell) { return cell.valid(); });
  const int v = vertex_of(solid.grid, c, lower), w = v | 1 << solid.grid.axis(edge);
  const grid::Copy& copy = solid.complex.copies[solid.complex.copy_at(c, from_lower ? v : w)];
  const double skin = solid.cuts.find_outer(edge)->t;
  return {{copy.corners[v], copy.corners[w]}, from_lower ? 0 : skin, from_lower ? skin : 1};
}

Mat3 gradient_on(const grid::Solid& solid, const Points& x, const grid::EdgeId edge, const double t) {
  const auto& [lower, upper] = solid.grid.ends(edge);
  Mat3 sum = Mat3::Zero();
  for (const grid::CellId c : solid.grid.cells(edge)) {
    if (!c.valid())
      continue;
    const int vertex = vertex_of(solid.grid, c, lower);
    Vec3 at(vertex & 1, vertex >> 1 & 1, vertex >> 2 & 1);
    at[solid.grid.axis(edge)] = t;
    const int held = solid.grid.is_material(lower) ? vertex : vertex | 1 << solid.grid.axis(edge);
    sum += deformation_gradient(solid.complex.copies[solid.complex.copy_at(c, held)], x, solid.grid.h(), at);
  }
  return sum;
}

Vec3 pulled_back(const grid::Solid& solid, const Points& x, const grid::EdgeId edge, const double t,
                 const Vec3& normal) {
  const Vec3 at_rest = gradient_on(solid, x, edge, t).transpose() * normal;
  // Along the edge it is n . (q - p) / h, which is 0 only by rounding, since the surface is crossed.
  const double length = at_rest.norm();
  return length > 0 ? Vec3(at_rest / length) : Vec3::Unit(solid.grid.axis(edge));
}

} // namespace kerf::cut
