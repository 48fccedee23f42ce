#include "cut/advance.h"

#include "base/function_ref.h"
#include "cut/in_plane.h"
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

/// A cell's cube at rest, and so much around it [m].
Box around(const Solid& solid, const CellId c, const double more) {
  const Vec3 origin = solid.grid.origin(c);
  return {origin - Vec3::Constant(more), origin + Vec3::Constant(solid.grid.h() + more)};
}

/// A little more than the cube, so that what neighbours have of the cut has no seam.
Box in_sight_of(const Solid& solid, const CellId c) { return around(solid, c, 0.01 * solid.grid.h()); }

/// With what a front in another cell may reach over by its lag.
Box reach_of(const Solid& solid, const CellId c) { return around(solid, c, grid::most_front_lag * solid.grid.h()); }

bool is_in(const Box& box, const Patch& patch) {
  const Box around = geometry::box_around(patch);
  return (around.lower.array() <= box.upper.array()).all() && (box.lower.array() <= around.upper.array()).all();
}

Polygon clipped(Polygon polygon, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    polygon = cut::clipped(polygon, {-Vec3::Unit(axis), -box.lower[axis]});
    polygon = cut::clipped(polygon, {Vec3::Unit(axis), box.upper[axis]});
  }
  return polygon;
}

/// What of the section is drawn, with its lag.
Raster come_in(const Front& front, const double h, const Raster& section, const Raster& swept) {
  const InPlane in_plane(front.point, front.normal, h);
  const auto lag = [&](const double x, const double y) { return grid::front_lag(x * in_plane.u + y * in_plane.v); };
  return section & swept.grown(lag, grid::most_front_lag);
}

/// Over the texels of a part of a front's plane.
OfVertices weighted(const Solid& solid, const Front& front, const Raster& part) {
  const double h = solid.grid.h();
  const InPlane in_plane(front.point, front.normal, h);
  const Vec3 origin = solid.grid.origin(front.cell);
  OfVertices sums{};
  part.for_each([&](const double x, const double y) {
    const Vec3 xi = (in_plane.point({x, y}) - origin) / h;
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      sums[v] += grid::shape(v, xi);
  });
  return sums;
}

} // namespace

/// What is swept, in the cells that it comes into.
class Advance::Sweep {
 public:
  /// `fractions`: of the way from x_before to x, at which the first and the last two points of a patch stand.
  Sweep(std::vector<Patch> patches, std::vector<std::array<double, 2>> fractions, const Solid& solid,
        const Points& x_before, const Points& x)
    : patches_(std::move(patches)),
      fractions_(std::move(fractions)),
      solid_(solid),
      x_before_(x_before),
      x_(x),
      near_(patches_) {}

  static Sweep of(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x) {
    std::vector<std::array<double, 2>> fractions;
    for (std::size_t k = 1; k < path.lines.size(); ++k)
      fractions.insert(fractions.end(), path.lines[k].size() - 1, {path.fractions[k - 1], path.fractions[k]});
    return {patches(path), std::move(fractions), solid, x_before, x};
  }
  static Sweep of(const geometry::TriangleMesh& mesh, const Solid& solid, const Points& x) {
    std::vector<std::array<Vec3, 3>> triangles(mesh.triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
      triangles[i] = corners(mesh, i);
    return {patches(triangles), std::vector(triangles.size(), std::array{0.0, 0.0}), solid, x, x};
  }

  bool is_near(const EdgeBoxes::Block& block) const { return near_.may_be_in(block.around_cells()); }
  bool is_near(const CellId c) const { return near_.may_be_in(box_of(c)); }

  /// Calls f(polygon at rest [m]) for what lies in the reach of the cell.
  template <class Function>
  void for_each_piece(const CellId c, const Function& f) const {
    const ToRest before(solid_, c, x_before_), now(solid_, c, x_);
    const Box reach = reach_of(solid_, c);
    std::vector<std::size_t> near;
    near_.for_each(box_of(c), [&](const std::size_t i) { near.push_back(i); });
    std::ranges::sort(near);
    for (const std::size_t i : near) {
      Patch at_rest;
      for (std::size_t k = 0; k < at_rest.size(); ++k) {
        const double t = fractions_[i][k / 2];
        at_rest[k] = (1 - t) * before(patches_[i][k]) + t * now(patches_[i][k]);
      }
      if (!is_in(reach, at_rest))
        continue;
      const Polygon piece = clipped({at_rest.begin(), at_rest.end()}, reach);
      if (area(piece) > 0)
        f(piece);
    }
  }

 private:
  /// Around a cell on its way, with the lag of fronts.
  Box box_of(const CellId c) const {
    const grid::Copy& copy = solid_.complex.copies[solid_.complex.first_copy[c]];
    std::array<Vec3, 16> corners;
    for (int v = 0; v < 8; ++v) {
      corners[v] = x_[copy.corners[v].value];
      corners[8 + v] = x_before_[copy.corners[v].value];
    }
    const Box box = geometry::box_around(corners);
    const Vec3 lag = Vec3::Constant(grid::most_front_lag * (box.upper - box.lower).maxCoeff());
    return {box.lower - lag, box.upper + lag};
  }

  std::vector<Patch> patches_;
  std::vector<std::array<double, 2>> fractions_;
  const Solid& solid_;
  const Points &x_before_, &x_;
  NearSweep near_;
};

void Advance::sweep(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x,
                    const EdgeBoxes& boxes, const grid::CutLabel label) {
  const bool rests = path.lines.front() == path.lines.back();
  sweep(Sweep::of(path, solid, x_before, x), solid, boxes, label, rests);
  for (const CellId c : touched_)
    for (std::vector<Polygon>* const pieces : {&cells_.at(c).pieces, &cells_.at(c).at_rest})
      if (pieces->size() > most_pieces)
        pieces->erase(pieces->begin(), pieces->end() - most_pieces);
}

void Advance::sweep(const geometry::TriangleMesh& mesh, const Solid& solid, const Points& x, const EdgeBoxes& boxes,
                    const grid::CutLabel label) {
  sweep(Sweep::of(mesh, solid, x), solid, boxes, label, false);
}

void Advance::sweep(const Sweep& sweep, const Solid& solid, const EdgeBoxes& boxes, const grid::CutLabel label,
                    const bool rests) {
  for (const std::uint32_t k : boxes.blocks([&](const EdgeBoxes::Block& block) { return sweep.is_near(block); }))
    boxes.for_each_cell(k, [&](const CellId c) {
      const bool is_whole = !solid.complex.copies[solid.complex.first_copy[c]].next.valid(),
                 has_front = ahead_ == Ahead::ends && solid.cuts.front(c) != nullptr;
      if ((is_whole || has_front || cells_.contains(c)) && sweep.is_near(c))
        sweep.for_each_piece(c, [&](const Polygon& piece) { add(solid, c, piece, label, rests); });
    });
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
    if (as_faces_)
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

std::vector<Front> Advance::take(const Solid& solid, const PendingCuts& pending) {
  std::vector<CellId> forgotten;
  std::vector<std::pair<CellId, Cell>> moved_on;
  std::set<CellId> later;
  const auto waits = [&](const CellId c) {
    return std::ranges::any_of(solid.grid.edges(c), [&](const grid::EdgeId e) { return pending.waits(e); });
  };
  Stand stand(solid, cells_);
  const auto look_for = [&](const CellId c, const grid::CutLabel label) {
    if (auto front = front_in(solid, c, label)) {
      Cell cell = follow(solid, *front);
      stand.begin(*front, std::move(cell));
    }
  };
  for (const CellId c : touched_) {
    Cell& cell = cells_.at(c);
    const Front* const earlier = solid.cuts.front(c);
    if (earlier ? !is_ahead(solid, *earlier) : !can_begin(solid, c))
      forgotten.push_back(c);
    else if (waits(c))
      later.insert(c);
    else if (earlier && ahead_ == Ahead::ends) { // of another cut, or of a blade
      Front moved = *earlier;
      if (!is_along(*earlier, cell.pieces, solid.grid.h()))
        continue;
      moved_on.emplace_back(c, follow(solid, moved));
      stand.move(moved);
    } else if (earlier && cell.section.any()) {
      Front moved = *earlier;
      come_to(solid, come_in(moved, solid.grid.h(), cell.section, cell.swept), cell, moved);
      stand.move(moved);
    } else if (!earlier) {
      look_for(c, cell.label);
    }
  }
  for (auto& [c, cell] : moved_on) // others have asked for what is swept around them
    cells_[c] = std::move(cell);
  std::vector<Front> fronts = begin(solid, stand, waits, later);
  if (!as_faces_ || ahead_ == Ahead::ends)
    move(solid, stand, fronts);
  for (const CellId c : forgotten)
    cells_.erase(c);
  if (as_faces_)
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
  for (const auto& [c, label] : wanted)
    if (!stand.front(c) && !touched_.contains(c) && can_begin(solid, c) && !waits(c))
      if (auto front = front_in(solid, c, label)) {
        Cell cell = follow(solid, *front);
        stand.begin(*front, std::move(cell));
      }
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
    moved.passed = std::max(moved.passed, earlier->passed);
    bool comes_on = moved.passed > earlier->passed;
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
void Advance::come_to(const Solid& solid, const Raster& come, const Cell& cell, Front& front) {
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
      come_to(solid, come_in(moved, solid.grid.h(), cell.section, cell.swept), cell, moved);
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
      if (as_faces_)
        followed.add_fresh(front, solid.grid.h(), clipped(piece, in_sight_of(solid, front.cell)), 0);
    }
  followed.whole = weighted(solid, front, followed.section);
  followed.around = AroundFront(solid, front);
  come_to(solid, come_in(front, solid.grid.h(), followed.section, followed.swept), followed, front);
  front.come = followed.take_fresh(front, solid.grid.h());
  return followed;
}

} // namespace kerf::cut
