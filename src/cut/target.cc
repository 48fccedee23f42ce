#include "cut/target.h"

#include "base/parallel.h"
#include "grid/parts.h"
#include "grid/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace kerf::cut {

namespace cube = grid::cube;

namespace {

constexpr std::size_t edges_per_chunk = 4096, blocks_per_chunk = 16;

/// dx/dX of a copy at a point of the unit cube.
Mat3 deformation_gradient(const grid::Copy& copy, const Points& x, const double h, const Vec3& at) {
  Mat3 F = Mat3::Zero();
  for (int v = 0; v < cube::n_vertices; ++v)
    F += x[copy.corners[v].value] * grid::shape_gradient(v, at).transpose() / h;
  return F;
}

/// Runs fill(k, part) for parts 0 .. n - 1 in parallel, and joins the parts in their order.
template <class Fill>
SweepCuts joined(const std::size_t n, const Fill& fill) {
  std::vector<SweepCuts> parts(n);
  parallel_for(n, [&](const std::size_t k) { fill(k, parts[k]); });
  SweepCuts result;
  for (const SweepCuts& part : parts)
    append(result, part);
  std::ranges::sort(result.cuts, {}, &grid::EdgeCut::edge);
  std::ranges::sort(result.of_skin, {}, &grid::SkinCut::segment);
  std::ranges::sort(result.later, {}, &grid::EdgeCut::edge);
  std::ranges::sort(result.later_of_skin, {}, &grid::SkinCut::segment);
  return result;
}

/// Null without.
const SkinPlaces::mapped_type* places_of(const grid::CellId c, const SkinPlaces* const places) {
  if (!places)
    return nullptr;
  const auto at = places->find(c);
  return at != places->end() ? &at->second : nullptr;
}

/// One of those around an edge.
grid::CellId cell_at(const grid::Grid& grid, const grid::EdgeId edge) {
  const auto around = grid.cells(edge);
  return *std::ranges::find_if(around, [](const grid::CellId cell) { return cell.valid(); });
}

} // namespace

Target::Target(const grid::Solid& solid, const Points& x_before, const Points& x, const EdgeBoxes* boxes,
               const SkinPlaces* places_before)
  : solid_(solid), x_before_(x_before), x_(x), boxes_(boxes), places_before_(places_before) {
  if (!boxes_) // fit() has seen to it
    require_finite(x);
}

SweepCuts Target::cut(const grid::CutLabel label, const Nearness& near, const Judge& judge) const {
  return boxes_ ? cut_near(label, near, judge) : cut_anywhere(label, judge);
}

SweepCuts Target::cut_anywhere(const grid::CutLabel label, const Judge& judge) const {
  const std::size_t n = std::max(solid_.grid.n_edges(), solid_.grid.n_cells());
  return joined((n + edges_per_chunk - 1) / edges_per_chunk, [&](const std::size_t k, SweepCuts& part) {
    for (std::size_t i = k * edges_per_chunk; i < (k + 1) * edges_per_chunk; ++i) {
      if (i < solid_.grid.n_edges() && is_asked(grid::EdgeId(i), label))
        this->judge(grid::EdgeId(i), label, judge, part);
      if (i < solid_.grid.n_cells() && grid::material_of(solid_.grid, grid::CellId(i)) != 0xff)
        judge_skin(grid::CellId(i), nullptr, label, judge, part);
    }
  });
}

SweepCuts Target::cut_near(const grid::CutLabel label, const Nearness& near, const Judge& judge) const {
  const auto is_near = [&](const Box& box) { return geometry::overlap(box, near.reach) && near.may_meet(box); };
  const auto blocks = boxes_->blocks([&](const EdgeBoxes::Block& block) { return is_near(boxes_->with_skin(block)); });
  const std::size_t n = (blocks.size() + blocks_per_chunk - 1) / blocks_per_chunk;
  return joined(n, [&](const std::size_t k, SweepCuts& part) {
    for (std::size_t b = k * blocks_per_chunk; b < std::min(blocks.size(), (k + 1) * blocks_per_chunk); ++b) {
      judge_skin_edges(blocks[b], near, label, judge, part);
      boxes_->for_each_skin_cell(blocks[b], [&](const grid::CellId c) { judge_skin(c, &near, label, judge, part); });
      if (is_near(boxes_->block(blocks[b]).box))
        judge_edges(blocks[b], near, label, judge, part);
    }
  });
}

void Target::judge_edges(const std::uint32_t block, const Nearness& near, const grid::CutLabel label,
                         const Judge& judge, SweepCuts& result) const {
  boxes_->for_each_edge(block, [&](const grid::CornerId lower, const grid::CornerId upper, const int axis) {
    const Segment before{x_before_[lower.value], x_before_[upper.value]}, now{x_[lower.value], x_[upper.value]};
    if (!geometry::overlap(room(before, now), near.reach))
      return;
    const grid::EdgeId edge = solid_.grid.edge(solid_.complex.node[lower], axis);
    if (is_asked(edge, label))
      this->judge(edge, label, judge, result);
  });
}

void Target::judge_skin_edges(const std::uint32_t block, const Nearness& near, const grid::CutLabel label,
                              const Judge& judge, SweepCuts& result) const {
  const double room_around = boxes_->reach_of_skin();
  const auto is_near = [&](const Vec3& before, const Vec3& now) {
    return ((near.reach.lower - before.cwiseMax(now)).array() <= room_around).all() &&
           ((before.cwiseMin(now) - near.reach.upper).array() <= room_around).all();
  };
  boxes_->for_each_skin_edge(block, [&](const grid::EdgeId edge, const grid::CornerId corner) {
    if (!is_near(x_before_[corner.value], x_[corner.value]) || !is_asked(edge, label))
      return;
    const EdgeEnds ends = ends_of(solid_, edge);
    if (geometry::overlap(room(ends.segment(x_before_), ends.segment(x_)), near.reach))
      this->judge(edge, label, judge, result);
  });
}

/// Can it be cut, or has another one cut it?
bool Target::is_asked(const grid::EdgeId edge, const grid::CutLabel label) const {
  if (solid_.cuts.can_be_cut(solid_.grid, edge))
    return true;
  const grid::EdgeCut* const cut = solid_.cuts.find(edge);
  return cut && cut->label != label;
}

/// An edge that is cut already, from its one end to its other, wherever these are now.
void Target::judge_later(const grid::EdgeId edge, const grid::CutLabel label, const Judge& judge,
                         SweepCuts& result) const {
  const grid::EdgeCut& first = *solid_.cuts.find(edge);
  Verdict verdict;
  double from = 0, to = 1;
  if (solid_.cuts.is_cut_twice(edge)) {
    const grid::CellId c = cell_at(solid_.grid, edge);
    const int line = solid_.grid.line(c, edge);
    const SkinNow skin(solid_, c);
    verdict = judge(skin.segment(line, x_before_, places_before_), skin.segment(line, x_));
    from = solid_.grid.is_material(solid_.grid.ends(edge)[0]) ? 0 : 1;
    to = solid_.cuts.find_outer(edge)->t;
  } else {
    const EdgeEnds ends = ends_of(solid_, edge);
    verdict = judge(ends.segment(x_before_), ends.segment(x_));
  }
  if (verdict.n_crossings % 2 == 1) {
    const Vec3 normal = normal_among(solid_.grid.cells(edge), verdict);
    result.later.push_back(
      {edge, from + verdict.t * (to - from), pulled_back(solid_, x_, edge, first.t, normal), label});
  }
}

void Target::judge(const grid::EdgeId edge, const grid::CutLabel label, const Judge& judge, SweepCuts& result) const {
  if (!solid_.cuts.can_be_cut(solid_.grid, edge)) {
    judge_later(edge, label, judge, result);
    return;
  }
  const EdgeEnds ends = ends_of(solid_, edge);
  const Verdict verdict = judge(ends.segment(x_before_), ends.segment(x_));
  if (verdict.n_crossings % 2 == 1) {
    const double t = ends.from + verdict.t * (ends.to - ends.from);
    const Vec3 normal = normal_among(solid_.grid.cells(edge), verdict);
    result.cuts.push_back({edge, t, pulled_back(solid_, x_, edge, t, normal), label});
  } else if (verdict.n_crossings > 0)
    ++result.n_double_crossings;
}

/// In a face the cell below it judges, where there is one. `near` is null where all are judged.
void Target::judge_skin(const grid::CellId cell, const Nearness* const near, const grid::CutLabel label,
                        const Judge& judge, SweepCuts& result) const {
  if (near) {
    const Box box = box_around_copies(cell);
    if (!geometry::overlap(box, near->reach) || !near->may_meet(box))
      return;
  }
  const SkinNow skin(solid_, cell);
  skin.for_each_segment([&](const int segment) {
    const grid::SkinSegment of_skin = grid::skin_segment(solid_.grid, cell, segment);
    const grid::SkinCut* const earlier = solid_.cuts.find(of_skin);
    if (earlier && earlier->label == label)
      return;
    const Segment before = skin.segment(segment, x_before_, places_before_), now = skin.segment(segment, x_);
    if (near && !geometry::overlap(room(before, now), near->reach))
      return;
    const Verdict verdict = judge(before, now);
    if (verdict.n_crossings % 2 == 1) {
      const Vec3 normal = normal_among(std::array{cell}, verdict);
      (earlier ? result.later_of_skin : result.of_skin)
        .push_back({of_skin, verdict.t, skin.pulled_back(segment, verdict.t, x_, normal), label});
    } else if (verdict.n_crossings > 0 && !earlier)
      ++result.n_double_crossings;
  });
}

Vec3 Target::normal_among(const std::span<const grid::CellId> cells, const Verdict& verdict) const {
  if (verdict.along.isZero(0))
    return verdict.normal;
  Vec3 moved = Vec3::Zero();
  int n = 0;
  for (const grid::CellId cell : cells)
    if (cell.valid())
      for (const grid::NodeId node : solid_.grid.nodes(cell))
        if (solid_.grid.is_material(node)) { // of these, so that fronts, which add copies, have no say
          const grid::CornerId corner = solid_.complex.real_corner[node];
          moved += x_[corner.value] - x_before_[corner.value];
          ++n;
        }
  return (verdict.normal - verdict.along.cross(moved / n)).stableNormalized();
}

Box Target::box_around_copies(const grid::CellId cell) const {
  Box box{Vec3::Constant(std::numeric_limits<double>::infinity()), {}};
  box.upper = -box.lower;
  for (const grid::CopyId c : solid_.complex.copies_of(cell))
    for (const grid::CornerId corner : solid_.complex.copies[c].corners) {
      const Vec3 &before = x_before_[corner.value], &now = x_[corner.value];
      box.lower = box.lower.cwiseMin(before).cwiseMin(now);
      box.upper = box.upper.cwiseMax(before).cwiseMax(now);
    }
  if (const auto* const places = places_of(cell, places_before_))
    for (grid::Items left = grid::cuts_of(solid_, cell).skeleton().items; left != 0; left &= left - 1) {
      const Vec3& p = (*places)[std::countr_zero(left)];
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
  // What lies between the corners is found but for round-off.
  const Vec3 slack =
    Vec3::Constant(1e-14 * std::max(box.lower.lpNorm<Eigen::Infinity>(), box.upper.lpNorm<Eigen::Infinity>()));
  box.lower -= slack;
  box.upper += slack;
  return box;
}

EdgeEnds ends_of(const grid::Solid& solid, const grid::EdgeId edge) {
  const auto& [lower, upper] = solid.grid.ends(edge);
  const bool from_lower = solid.grid.is_material(lower);
  if (from_lower == solid.grid.is_material(upper))
    return {{solid.complex.real_corner[lower], solid.complex.real_corner[upper]}};
  const grid::CellId c = cell_at(solid.grid, edge);
  const int v = solid.grid.vertex(c, lower), w = v | 1 << solid.grid.axis(edge);
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
    const int vertex = solid.grid.vertex(c, lower);
    Vec3 at(vertex & 1, vertex >> 1 & 1, vertex >> 2 & 1);
    at[solid.grid.axis(edge)] = t;
    const int held = solid.grid.is_material(lower) ? vertex : vertex | 1 << solid.grid.axis(edge);
    sum += deformation_gradient(solid.complex.copies[solid.complex.copy_at(c, held)], x, solid.grid.h(), at);
  }
  return sum;
}

namespace {

Vec3 unit_normal_at_rest(const Mat3& F, const Vec3& normal, const Vec3& otherwise) {
  const Vec3 at_rest = F.transpose() * normal;
  const double length = at_rest.norm();
  return length > 0 ? Vec3(at_rest / length) : otherwise;
}

} // namespace

Vec3 pulled_back(const grid::Solid& solid, const Points& x, const grid::EdgeId edge, const double t,
                 const Vec3& normal) {
  // Along the edge it is n . (q - p) / h, which is 0 only by rounding, since the surface is crossed.
  return unit_normal_at_rest(gradient_on(solid, x, edge, t), normal, Vec3::Unit(solid.grid.axis(edge)));
}

SkinNow::SkinNow(const grid::Solid& solid, const grid::CellId cell)
  : solid_(solid), cell_(cell), cuts_(grid::cuts_of(solid, cell)), skeleton_(cuts_.skeleton()) {}

/// Of a cell whose skin no blade has cut, the one with what the item hangs on.
const grid::Copy& SkinNow::copy_with(const int item) const {
  const auto& complex = solid_.complex;
  const grid::CopyId holder = complex.copy_with(cell_, item);
  return complex.copies[holder.valid() ? holder : complex.copy_at(cell_, skeleton_.vertex[item])];
}

/// In coordinates of the cell [1].
Vec3 SkinNow::local(const int item) const {
  return (grid::item_point(solid_, cell_, item) - solid_.grid.origin(cell_)) / solid_.grid.h();
}

Segment SkinNow::segment(const int segment, const Points& x) const {
  const auto& [a, b] = skeleton_.segment[segment].ends;
  return {place(a, x), place(b, x)};
}

SkinPlaces::mapped_type SkinNow::places(const Points& x) const {
  SkinPlaces::mapped_type places;
  places.fill(Vec3::Zero());
  for (grid::Items left = skeleton_.items; left != 0; left &= left - 1) {
    const int item = std::countr_zero(left);
    places[item] = place(item, x);
  }
  return places;
}

Segment SkinNow::segment(const int segment, const Points& x, const SkinPlaces* const places) const {
  const auto* const own = places_of(cell_, places);
  if (!own)
    return this->segment(segment, x);
  const auto& [a, b] = skeleton_.segment[segment].ends;
  return {(*own)[a], (*own)[b]};
}

/// The same bits in all cells that know the item: on a line as an edge of the grid ends, in a face by its corners
/// alone.
Vec3 SkinNow::place(const int item, const Points& x) const {
  const grid::Copy& copy = copy_with(item);
  const auto corner = [&](const int v) -> const Vec3& { return x[copy.corners[v].value]; };
  if (item < grid::skeleton::first_on_line)
    return corner(item);
  if (item < grid::skeleton::first_on_arc) {
    const int line = item - grid::skeleton::first_on_line;
    const Vec3 &lower = corner(cube::line_vertices[line][0]), &upper = corner(cube::line_vertices[line][1]);
    return lower + solid_.cuts.find_outer(solid_.grid.edges(cell_)[line])->t * (upper - lower);
  }
  if (item < grid::skeleton::first_middle) {
    const int face = (item - grid::skeleton::first_on_arc) / 2, axis = cube::face_axis(face);
    const auto& vertices = cube::face_vertices[face];
    const Vec3 p = grid::face_point(solid_, solid_.grid.faces(cell_)[face]) -
                   solid_.grid.position(solid_.grid.nodes(cell_)[vertices[0]]);
    const double u = p[(axis + 1) % 3] / solid_.grid.h(), v = p[(axis + 2) % 3] / solid_.grid.h();
    return (1 - v) * ((1 - u) * corner(vertices[0]) + u * corner(vertices[1])) +
           v * ((1 - u) * corner(vertices[2]) + u * corner(vertices[3]));
  }
  return grid::interpolated(local(item), corner);
}

Vec3 SkinNow::pulled_back(const int segment, const double t, const Points& x, const Vec3& normal) const {
  const auto& [a, b] = skeleton_.segment[segment].ends;
  const Vec3 p = local(a), q = local(b);
  const Mat3 F = deformation_gradient(copy_with(a), x, solid_.grid.h(), p + t * (q - p));
  return unit_normal_at_rest(F, normal, (q - p).normalized());
}

} // namespace kerf::cut
