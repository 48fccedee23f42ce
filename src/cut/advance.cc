#include "cut/advance.h"

#include "base/function_ref.h"
#include "base/parallel.h"
#include "cut/in_plane.h"
#include "cut/swept_pieces.h"
#include "grid/fronts.h"
#include "grid/parts.h"
#include "grid/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Front;
using grid::Solid;

constexpr std::size_t most_pieces = 128; // the last ones are kept: a body may swing about a blade that rests

/// Where the plane of a front meets the material of its cell.
Raster section_of(const Solid& solid, const Front& front, const InPlane& in_plane) {
  const CellAtPlane cell(solid, front.cell, {front.point, front.normal}, rest_of(solid, front.cell));
  Raster section;
  for (const Polygon& piece : cell.material())
    draw(piece, in_plane, section);
  if (!section.any()) // of less than a texel
    section.draw({Vec3(-texel, -texel, 0), Vec3(2 * texel, -texel, 0), Vec3(-texel, 2 * texel, 0)}, off_plane);
  return section;
}

/// A little more than the cube, so that what neighbours have of the cut has no seam.
Box in_sight_of(const Solid& solid, const CellId c) { return around(solid, c, 0.01 * solid.grid.h()); }

/// What of the section is drawn, with its lag.
Raster come_in(const Front& front, const Fronts fronts, const double h, const Raster& section, const Raster& swept) {
  const InPlane in_plane(front.point, front.normal, h);
  const auto further = [&](const double x, const double y) { return lag(fronts, x * in_plane.u + y * in_plane.v); };
  return section & swept.grown(further, most_lag(fronts));
}

/// Over the texels of a part of a front's plane.
OfVertices weighted(const Solid& solid, const Front& front, const Raster& part) {
  const double h = solid.grid.h();
  const InPlane in_plane(front.point, front.normal, h);
  const Vec3 middle = (in_plane.origin - solid.grid.origin(front.cell)) / h, along_u = h * in_plane.u,
             along_v = h * in_plane.v;
  OfVertices sums{};
  part.for_each([&](const double x, const double y) {
    const Vec3 xi = middle + x * along_u + y * along_v;
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      sums[v] += grid::shape(v, xi);
  });
  return sums;
}

} // namespace

void Advance::sweep(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x,
                    const EdgeBoxes& boxes, const grid::CutLabel label) {
  const bool rests = path.lines.front() == path.lines.back();
  sweep(SweptPieces(path, solid, x_before, x, most_lag(fronts_)), solid, boxes, label, rests);
  for (const CellId c : touched_)
    for (std::vector<Polygon>* const pieces : {&cells_.at(c).pieces, &cells_.at(c).at_rest})
      if (pieces->size() > most_pieces)
        pieces->erase(pieces->begin(), pieces->end() - most_pieces);
}

void Advance::sweep(const geometry::TriangleMesh& mesh, const Solid& solid, const Points& x, const EdgeBoxes& boxes,
                    const grid::CutLabel label) {
  sweep(SweptPieces(mesh, solid, x, most_lag(fronts_)), solid, boxes, label, false);
}

void Advance::sweep(const SweptPieces& sweep, const Solid& solid, const EdgeBoxes& boxes, const grid::CutLabel label,
                    const bool rests) {
  std::vector<CellId> near;
  for (const std::uint32_t k : boxes.blocks([&](const EdgeBoxes::Block& block) { return sweep.is_near(block); }))
    boxes.for_each_cell(k, [&](const CellId c) {
      const bool is_whole = !solid.complex.copies[solid.complex.first_copy[c]].next.valid(),
                 has_front = ahead_ == Ahead::ends && solid.cuts.front(c) != nullptr;
      if ((is_whole || has_front || cells_.contains(c)) && sweep.is_near(c))
        near.push_back(c);
    });
  std::vector<std::vector<Polygon>> pieces(near.size());
  parallel_for(
    near.size(), [&](const std::size_t i) { pieces[i] = sweep.in(near[i]); }, 16);
  for (std::size_t i = 0; i < near.size(); ++i)
    for (const Polygon& piece : pieces[i])
      add(solid, near[i], piece, label, rests);
}

void Advance::add(const Solid& solid, const CellId c, const Polygon& piece, const grid::CutLabel label,
                  const bool rests) {
  Cell& cell = cells_.emplace(c, Cell{label}).first->second;
  const Front* const front = solid.cuts.front(c);
  const bool moves_front = front && ahead_ == Ahead::goes_on;
  if (cell.label != label) {
    const bool goes_on = moves_front && is_along(*front, {mean(piece), normal(piece)}, solid.grid.h()),
               has_stopped = !front && !touched_.contains(c) && !touched_before_.contains(c);
    if (has_stopped)
      cell = Cell{label};
    else if (!goes_on)
      return;
  }
  if (moves_front) {
    const InPlane in_plane(front->point, front->normal, solid.grid.h());
    const int n_new = draw(piece, in_plane, cell.swept);
    if (tell_faces())
      cell.add_fresh(*front, solid.grid.h(), clipped(piece, in_sight_of(solid, c)), n_new);
  } else {
    (rests ? cell.at_rest : cell.pieces).push_back(piece);
  }
  touched_.insert(c);
}

/// By how the blade has moved, or else by all that it has met.
std::optional<Front> Advance::front_in(const Solid& solid, const CellId c, const grid::CutLabel label) const {
  const auto at = cells_.find(c);
  const Cell not_met;
  const Cell& cell = at != cells_.end() && at->second.label == label ? at->second : not_met;
  const std::vector<Polygon>&pieces = cell.pieces, &at_rest = cell.at_rest;
  const auto around = [&](Points& points) { add_around(solid, c, label, points); };
  auto front = pieces.empty() && !at_rest.empty() ? std::nullopt : front_ahead(solid, c, pieces, label, ahead_, around);
  if (!front && !at_rest.empty()) {
    std::vector<Polygon> all = pieces;
    all.insert(all.end(), at_rest.begin(), at_rest.end());
    front = front_ahead(solid, c, all, label, ahead_, around);
  }
  return front;
}

/// What has been swept in the cells around, in part where that is much.
void Advance::add_around(const Solid& solid, const CellId c, const grid::CutLabel label, Points& points) const {
  constexpr std::size_t enough = 16; // pieces a cell
  for (const CellId next : cells_around(solid.grid, c)) {
    const auto at = cells_.find(next);
    if (next == c || at == cells_.end() || at->second.label != label)
      continue;
    const std::vector<Polygon>& pieces = at->second.pieces;
    for (std::size_t i = 0; i < pieces.size(); i += 1 + pieces.size() / enough)
      points.insert(points.end(), pieces[i].begin(), pieces[i].end());
  }
}

bool Advance::can_begin(const Solid& solid, const CellId c) const {
  return !solid.cuts.front(c) && !solid.cuts.joined(c) && grid::whole_parts_of(grid::cuts_of(solid, c)).n == 1;
}

/// What a step's fronts are: before it, or as they have begun or moved on in it.
class Advance::Stand {
 public:
  Stand(const Solid& solid, const std::map<CellId, Cell>& cells) : solid_(solid), cells_(cells) {}

  void begin(const Front& front, Cell&& cell) {
    fronts_.insert_or_assign(front.cell, front);
    begun_.insert_or_assign(front.cell, std::move(cell));
  }
  void move(const Front& front) { fronts_.insert_or_assign(front.cell, front); }
  /// One that is not to begin.
  void drop(const CellId c) {
    fronts_.erase(c);
    begun_.erase(c);
  }
  const FrontsOfCells& fronts() const { return fronts_; }
  bool has_begun(const CellId c) const { return begun_.contains(c); }
  Cell& begun(const CellId c) { return begun_.at(c); }
  const Front* front(const CellId c) const {
    const auto at = fronts_.find(c);
    return at != fronts_.end() ? &at->second : solid_.cuts.front(c);
  }

  /// Of what lies around a vertex of a front's cell.
  double part(const CellId c, const int v) {
    return around(c).part(solid_, c, v, [&](const CellId next, const int w) {
      const Front* const its = front(next);
      return is_parted(next) ? 1.0 : its ? its->reached[w] : 0.0;
    });
  }
  const AroundFront& around(const CellId c) const {
    const auto at = begun_.find(c);
    return at != begun_.end() ? at->second.around : cells_.at(c).around;
  }
  OfVertices held(const CellId c) {
    OfVertices all;
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      all[v] = cut::held(around(c).area(v), part(c, v), solid_.grid.h());
    return all;
  }

 private:
  /// For good.
  bool is_parted(const CellId c) {
    if (fronts_.contains(c))
      return false;
    const auto [at, is_new] = parted_.try_emplace(c);
    if (is_new) {
      const Front* const front = solid_.cuts.front(c);
      at->second = front ? !is_ahead(solid_, *front) : grid::whole_parts_of(grid::cuts_of(solid_, c)).n > 1;
    }
    return at->second;
  }

  const Solid& solid_;
  const std::map<CellId, Cell>& cells_;
  FrontsOfCells fronts_;
  std::map<CellId, Cell> begun_;
  std::map<CellId, bool> parted_;
};

/// What a cell comes to in which blades have swept.
struct Advance::Outcome {
  enum class Of { nothing, forgotten, waiting, begun, moved };
  Of of = Of::nothing;
  std::optional<Front> front = {}; ///< that has begun or moved on
  std::optional<Cell> cell = {};   ///< what follows the front from then on; none: what did
};

Advance::Outcome Advance::outcome(const Solid& solid, const CellId c, const FunctionRef<bool(CellId)> waits) const {
  const Cell& cell = cells_.at(c);
  const Front* const earlier = solid.cuts.front(c);
  if (earlier ? !is_ahead(solid, *earlier) : !can_begin(solid, c))
    return {Outcome::Of::forgotten};
  if (waits(c))
    return {Outcome::Of::waiting};
  if (!earlier)
    return begun(solid, c, cell.label);
  Front moved = *earlier;
  if (ahead_ == Ahead::ends) { // of another cut, or of a blade
    if (!is_along(*earlier, cell.pieces, solid.grid.h()))
      return {};
    Cell followed = follow(solid, moved);
    return {Outcome::Of::moved, std::move(moved), std::move(followed)};
  }
  if (!cell.section.any())
    return {};
  come_to(solid, cell, moved);
  return {Outcome::Of::moved, std::move(moved)};
}

Advance::Outcome Advance::begun(const Solid& solid, const CellId c, const grid::CutLabel label) const {
  std::optional<Front> front = front_in(solid, c, label);
  if (!front)
    return {};
  Cell cell = follow(solid, *front);
  return {Outcome::Of::begun, std::move(front), std::move(cell)};
}

std::vector<Front> Advance::take(const Solid& solid, const PendingCuts& pending) {
  std::vector<CellId> forgotten;
  std::set<CellId> later;
  const auto waits = [&](const CellId c) {
    return std::ranges::any_of(solid.grid.edges(c), [&](const grid::EdgeId e) { return pending.waits(e); });
  };
  const std::vector<CellId> touched(touched_.begin(), touched_.end());
  std::vector<Outcome> outcomes(touched.size());
  parallel_for(touched.size(), [&](const std::size_t i) { outcomes[i] = outcome(solid, touched[i], waits); });
  Stand stand(solid, cells_);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    auto& [of, front, cell] = outcomes[i];
    if (of == Outcome::Of::forgotten)
      forgotten.push_back(touched[i]);
    else if (of == Outcome::Of::waiting)
      later.insert(touched[i]);
    else if (of == Outcome::Of::begun)
      stand.begin(*front, std::move(*cell));
    else if (of == Outcome::Of::moved) {
      stand.move(*front);
      if (cell)
        cells_.at(touched[i]) = std::move(*cell);
    }
  }
  std::vector<Front> fronts = begin(solid, stand, waits, later);
  if (!tell_faces() || ahead_ == Ahead::ends)
    move(solid, stand, fronts);
  for (const CellId c : forgotten)
    cells_.erase(c);
  if (tell_faces())
    tell_where_they_have_come(solid, fronts);
  touched_before_ = std::move(touched_);
  touched_ = std::move(later);
  std::ranges::sort(fronts, {}, &Front::cell);
  return fronts;
}

/// In all cells around vertices that open.
std::vector<Front> Advance::begin(const Solid& solid, Stand& stand, const FunctionRef<bool(CellId)> waits,
                                  std::set<CellId>& later) {
  std::map<CellId, grid::CutLabel> wanted;
  for (const auto& [c, front] : stand.fronts())
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      if (stand.part(c, v) > least_part_open)
        stand.around(c).for_each_cell(solid, c, v, [&](const CellId next) { wanted.emplace(next, front.label); });
  std::vector<std::pair<CellId, grid::CutLabel>> others;
  for (const auto& [c, label] : wanted)
    if (!stand.front(c) && !touched_.contains(c))
      others.emplace_back(c, label);
  std::vector<Outcome> outcomes(others.size());
  parallel_for(others.size(), [&](const std::size_t i) {
    const auto& [c, label] = others[i];
    if (can_begin(solid, c) && !waits(c))
      outcomes[i] = begun(solid, c, label);
  });
  for (Outcome& outcome : outcomes)
    if (outcome.of == Outcome::Of::begun)
      stand.begin(*outcome.front, std::move(*outcome.cell));
  std::vector<Front> in_order, fronts;
  FrontsOfCells begun;
  for (const auto& [c, label] : wanted)
    if (stand.has_begun(c))
      in_order.push_back(*stand.front(c));
  std::ranges::stable_sort(in_order, std::greater<>(), [&](const Front& front) {
    const Cell& cell = stand.begun(front.cell);
    return std::pair((cell.section & cell.swept).any(), front.passed);
  });
  for (Front& front : in_order) {
    front.passed = std::max(front.passed, least_passed);
    if (fits_in(solid, front, begun))
      begun.emplace(front.cell, front);
    else
      stand.drop(front.cell);
  }
  for (auto& [c, front] : begun) {
    front.held = stand.held(c);
    fronts.push_back(front);
  }
  for (const Front& front : fronts)
    cells_[front.cell] = std::move(stand.begun(front.cell));
  for (const auto& [c, front] : stand.fronts()) // which may lack what waits
    if (touched_.contains(c) && std::ranges::any_of(cells_around(solid.grid, c), waits))
      later.insert(c);
  return fronts;
}

/// Of earlier fronts those that have come on, or around which others have.
void Advance::move(const Solid& solid, Stand& stand, std::vector<Front>& fronts) {
  constexpr double little = 1e-3;
  std::set<CellId> near;
  for (const auto& [c, front] : stand.fronts())
    for (const CellId next : cells_around(solid.grid, c))
      near.insert(next);
  for (const CellId c : near) {
    const Front* const earlier = solid.cuts.front(c);
    const auto at = cells_.find(c);
    if (!earlier || at == cells_.end() || !at->second.section.any() ||
        (at->second.label != earlier->label && ahead_ == Ahead::goes_on) || !is_ahead(solid, *earlier))
      continue;
    Front moved = *stand.front(c);
    const bool ends_farther = !keep_farther_end(*earlier, solid.grid.h(), moved);
    moved.passed = std::max(moved.passed, earlier->passed);
    bool comes_on = moved.passed > earlier->passed || ends_farther;
    const OfVertices held = stand.held(c);
    for (int v = 0; v < grid::cube::n_vertices; ++v) {
      comes_on = comes_on || held[v] < (1 - little) * earlier->held[v];
      moved.held[v] = std::min(held[v], earlier->held[v]);
    }
    if (comes_on)
      fronts.push_back(std::move(moved));
  }
}

/// A front that has come through a part of its cell's section.
void Advance::come_to(const Solid& solid, const Cell& cell, Front& front) const {
  const Raster come = come_in(front, fronts_, solid.grid.h(), cell.section, cell.swept);
  put_end(cell.section, cell.swept, come, solid.grid.h(), front);
  front.passed = cell.section.any() ? std::min(most_passed, double(come.count()) / cell.section.count()) : 0;
  const OfVertices sums = weighted(solid, front, come);
  for (int v = 0; v < grid::cube::n_vertices; ++v)
    front.reached[v] = std::max(front.reached[v], cell.whole[v] > 0 ? sums[v] / cell.whole[v] : 0);
}

/// All of them at once, when one has come on by enough: what sees them is made anew then (physics/phyxels.h).
void Advance::tell_where_they_have_come(const Solid& solid, std::vector<Front>& fronts) {
  constexpr double enough = 0.05; // squares of a cube's edge
  if (std::ranges::none_of(touched_, [&](const CellId c) {
        const auto at = cells_.find(c);
        return at != cells_.end() && at->second.n_fresh * texel * texel >= enough;
      }))
    return;
  for (auto& [c, cell] : cells_)
    if (const Front* const earlier = solid.cuts.front(c); earlier && cell.n_fresh > 0) {
      Front moved = *earlier;
      come_to(solid, cell, moved);
      keep_farther_end(*earlier, solid.grid.h(), moved);
      moved.passed = std::max(earlier->passed, moved.passed);
      moved.come = cell.take_fresh(moved, solid.grid.h());
      fronts.push_back(moved);
    }
}

void Advance::Cell::add_fresh(const Front& front, const double h, const Polygon& piece, const int n_new) {
  constexpr std::size_t many = 64;
  const InPlane in_plane(front.point, front.normal, h);
  if (std::ranges::any_of(piece, [&](const Vec3& p) { return std::abs(in_plane(p)[2]) > off_plane; }))
    return;
  fresh.insert(fresh.end(), piece.begin(), piece.end());
  if (fresh.size() > many)
    fresh = hull(fresh, in_plane);
  n_fresh += n_new;
}

std::vector<Points> Advance::Cell::take_fresh(const Front& front, const double h) {
  n_fresh = 0;
  const Polygon around = hull(std::exchange(fresh, {}), InPlane(front.point, front.normal, h));
  return around.size() < 3 ? std::vector<Points>() : std::vector<Points>{around};
}

/// Sets how far the front has come, and what follows it from then on.
Advance::Cell Advance::follow(const Solid& solid, Front& front) const {
  const auto at = cells_.find(front.cell);
  const Cell not_met;
  const bool is_its = at != cells_.end() && (at->second.label == front.label || ahead_ == Ahead::ends);
  const Cell& cell = is_its ? at->second : not_met;
  const InPlane in_plane(front.point, front.normal, solid.grid.h());
  Cell followed{.label = front.label, .section = section_of(solid, front, in_plane)};
  for (const std::vector<Polygon>* const pieces : {&cell.pieces, &cell.at_rest})
    for (const Polygon& piece : *pieces) {
      draw(piece, in_plane, followed.swept);
      if (tell_faces())
        followed.add_fresh(front, solid.grid.h(), clipped(piece, in_sight_of(solid, front.cell)), 0);
    }
  followed.whole = weighted(solid, front, followed.section);
  followed.around = AroundFront(solid, front);
  come_to(solid, followed, front);
  front.come = followed.take_fresh(front, solid.grid.h());
  return followed;
}

} // namespace kerf::cut
