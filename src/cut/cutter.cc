#include "cut/cutter.h"

#include "base/loan.h"
#include "base/sort_unique.h"
#include "cut/course.h"
#include "cut/fronts.h"
#include "cut/shreds.h"
#include "cut/sides.h"
#include "cut/target.h"
#include "grid/parts.h"
#include "grid/touched.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace kerf::cut {

using grid::CutChange;
using grid::EdgeCut;
using grid::EdgeId;
using grid::Solid;

namespace {

std::array<grid::CellId, 2> cells_of(const grid::Grid& grid, const grid::SkinSegment& segment) {
  return segment.face.valid() ? grid.cells(segment.face) : std::array{segment.cell, grid::CellId()};
}

/// Of an edge, or a segment of the skin.
template <class Segment>
bool is_known(const Solid& solid, const Segment& segment, const grid::CutLabel label) {
  const auto* const first = solid.cuts.find(segment);
  if (!first || first->label == label)
    return first != nullptr; // where it is left whole it may be cut yet
  const auto later = solid.cuts.later_cuts(segment);
  return std::ranges::find(later, label, &grid::LaterCut::label) != later.end();
}

/// The material on an edge between its cut and a later one, over h, when the corners are at x; times the square of the
/// later normal along it, so that the sum over the edges of all three axes is a volume in cells. What is longer than h
/// is open where it is cut: a blade that comes through there cuts nothing.
double between(const Solid& solid, const EdgeCut& later, const Points& x) {
  const auto& [lower, upper] = solid.grid.ends(later.edge);
  const EdgeCut* const first = solid.cuts.find(later.edge);
  if (!first || !solid.grid.is_material(lower) || !solid.grid.is_material(upper))
    return 0;
  const auto& corners = solid.complex.real_corner;
  const double length = std::max(1.0, (x[corners[upper].value] - x[corners[lower].value]).norm() / solid.grid.h()),
               below = later.t * length, above = (1 - later.t) * length,
               part = std::max({first->t - below, 1 - first->t - above, 0.0}),
               along = later.normal[solid.grid.axis(later.edge)];
  return part * along * along;
}

/// Where something is met, in blocks of cells.
class Meetings {
 public:
  Meetings(const grid::Grid& grid, const std::vector<grid::CellId>& cells) : grid_(grid) {
    for (const grid::CellId c : cells)
      blocks_.insert(block(index(c), 0));
  }

  bool any() const { return !blocks_.empty(); }
  /// Is one within two cells of a cell that is stored? Some that are up to five away count too.
  bool are_near(const grid::CellId c) const {
    if (!c.valid())
      return false;
    for (int corner = 0; corner < 8; ++corner) { // of a cube of five cells, which spans two blocks at most
      const Index3 lower = block(index(c), -2), upper = block(index(c), 2);
      if (blocks_.contains(
            {corner & 1 ? upper[0] : lower[0], corner & 2 ? upper[1] : lower[1], corner & 4 ? upper[2] : lower[2]}))
        return true;
    }
    return false;
  }

 private:
  Index3 index(const grid::CellId c) const { return grid_.index(grid_.nodes(c)[0]); }
  static Index3 block(Index3 i, const int shift) {
    constexpr int edge = 4;
    for (int& k : i)
      k = (k + shift + edge) / edge;
    return i;
  }

  const grid::Grid& grid_;
  std::set<Index3> blocks_;
};

/// What was left whole near meetings, and all of it in cells with that: what hangs by some is left with all or none.
template <class Cells>
void find_left_ones(const Solid& solid, const Meetings& meetings, const Cells& cells_around,
                    std::map<EdgeId, grid::LaterCut>& edges, std::map<grid::SkinSegment, grid::LaterCut>& segments) {
  std::set<grid::CellId> known;
  const auto take_all = [&](const auto& left, auto& taken) {
    std::size_t n = 0;
    for (const auto& [one, cut] : left) {
      const auto cells = cells_around(one);
      if (taken.contains(one) || std::ranges::none_of(cells, [&](const grid::CellId c) {
            return meetings.are_near(c) || known.contains(c);
          }))
        continue;
      taken.emplace(one, cut);
      for (const grid::CellId c : cells)
        if (c.valid())
          known.insert(c);
      ++n;
    }
    return n;
  };
  while (take_all(solid.cuts.edges_left_whole(), edges) + take_all(solid.cuts.segments_left_whole(), segments) > 0) {
  }
}

/// Cuts what was left whole near to where something is met now: there it tells on which sides of all cuts things lie,
/// in a cell and, by intervals, across the faces of that; and a shred of a cell beside may be none any more (shreds.h).
/// Edges of which another cut waits stay until that is released. Adds it to what is cut.
void take_up_left_ones(Solid& solid, const PendingCuts& pending, std::vector<EdgeId>& edges,
                       std::vector<grid::SkinSegment>& segments, const std::vector<EdgeId>& edges_met,
                       const std::vector<grid::SkinSegment>& segments_met) {
  if (solid.cuts.n_left_whole() == 0)
    return;
  std::vector<EdgeId> all_edges = edges;
  std::vector<grid::SkinSegment> all_segments = segments;
  all_edges.insert(all_edges.end(), edges_met.begin(), edges_met.end());
  all_segments.insert(all_segments.end(), segments_met.begin(), segments_met.end());
  sort_unique(all_edges);
  sort_unique(all_segments);
  const Meetings meetings(solid.grid, grid::touched_cells(solid.grid, all_edges, all_segments));
  if (!meetings.any())
    return;
  struct CellsAround {
    const grid::Grid& grid;
    std::array<grid::CellId, 4> operator()(const EdgeId e) const { return grid.cells(e); }
    std::array<grid::CellId, 2> operator()(const grid::SkinSegment& segment) const { return cells_of(grid, segment); }
  };
  std::map<EdgeId, grid::LaterCut> left_edges;
  std::map<grid::SkinSegment, grid::LaterCut> left_segments;
  find_left_ones(solid, meetings, CellsAround{solid.grid}, left_edges, left_segments);
  for (const auto& [e, met] : left_edges)
    if (!pending.waits(e)) {
      solid.cuts.add(solid.grid, {e, met.t, met.normal, met.label});
      edges.push_back(e);
    }
  for (const auto& [segment, met] : left_segments) {
    solid.cuts.add({segment, met.t, met.normal, met.label});
    segments.push_back(segment);
  }
}

/// Is something of a group in several copies?
bool joins_copies(const Solid& solid, const grid::CellId c, const std::vector<grid::Joined>& groups) {
  return std::ranges::any_of(groups, [&](const grid::Joined& group) {
    const grid::CopyId first = copy_of(solid, c, group.items & -group.items);
    for (grid::Items left = group.items; left != 0; left &= left - 1)
      if (copy_of(solid, c, left & -left) != first)
        return true;
    return false;
  });
}

} // namespace

Cutter::Cutter(const std::size_t n_labels, const Release release, const Fronts fronts)
  : release_(release),
    fronts_(fronts),
    passed_(n_labels),
    advance_(fronts),
    counts_{.n_cut_edges = std::vector<std::size_t>(n_labels, 0), .between = std::vector<double>(n_labels, 0)} {}

void Cutter::begin(const Solid& solid, const Points& x) {
  boxes_.emplace(solid);
  x_before_.reserve(with_slack(x.size()));
  stand(x);
}

CutChange Cutter::step(Solid& solid, const std::span<const Blade> blades, const double t0, const double t1,
                       const Points& x) {
  fit_boxes(!blades.empty(), x);
  std::vector<Stroke> strokes;
  for (const Blade& blade : blades) {
    if (!boxes_->may_be_in(reach_of_paths(blade, t0, t1)))
      continue;
    strokes.push_back(stroke(solid, blade, t0, t1, x));
    if (fronts_ != Fronts::at_faces)
      for (const BladePath& path : paths(blade, t0, t1))
        advance_.sweep(path, solid, x_before_, x, *boxes_, blade.label);
  }
  edges_.resize(blades.size());
  for (std::size_t i = 0; i < blades.size(); ++i) {
    auto& [label, line, before] = edges_[i];
    label = blades[i].label;
    std::swap(line, before);
    put_world_points(blades[i], t1, line);
  }
  return take(solid, strokes, x);
}

CutChange Cutter::step(Solid& solid, const std::span<const Stroke> strokes, const Points& x) {
  fit_boxes(!strokes.empty(), x);
  return take(solid, strokes, x);
}

void Cutter::fit_boxes(const bool is_asked, const Points& x) {
  if (is_asked && boxes_stand_there_)
    boxes_->move_on(x_before_, x);
  else if (is_asked)
    boxes_->fit(x_before_, x);
  boxes_stand_there_ = is_asked;
}

/// `boxes_` are fitted.
CutChange Cutter::take(Solid& solid, const std::span<const Stroke> strokes, const Points& x) {
  std::set<grid::CutLabel> coming = labels_that_meet(solid, strokes);
  SweepCuts cuts = queue(solid, strokes, x);
  if (release_ == Release::queued)
    cuts.cuts = pending_.release(solid);
  if (strokes.empty() || boxes_->moves())
    x_before_ = x; // not after the cut: where corners jump then, the blade meets them on their way
  places_before_.clear();
  Added added = add(solid, cuts, x);
  coming.merge(pending_.labels());
  added.coming = std::move(coming);
  return part(solid, added, advance_.take(solid, pending_), x);
}

CutChange Cutter::at_once(Solid& solid, const CutSurface& surface, const Points& x) {
  boxes_->fit(x);
  boxes_stand_there_ = false;
  const SweepCuts found = cut_edges(surface, solid, x, &*boxes_);
  counts_.n_double_crossings += found.n_double_crossings;
  Advance at_once(fronts_, Ahead::ends);
  const auto* const mesh = std::get_if<geometry::TriangleMesh>(&surface.shape);
  if (mesh && fronts_ != Fronts::at_faces && geometry::has_border(*mesh))
    at_once.sweep(*mesh, solid, x, *boxes_, surface.label);
  const Added added = add(solid, found, x);
  std::vector<grid::Front> fronts = at_once.take(solid, pending_);
  if (!mesh && fronts_ != Fronts::at_faces)
    fronts = find_fronts(surface, solid, x, fronts_);
  return part(solid, added, fronts, x);
}

CutChange Cutter::cut(Solid& solid, const SweepCuts& cuts) {
  return part(solid, add(solid, cuts, x_before_), {}, x_before_);
}

std::set<grid::CutLabel> Cutter::labels_that_meet(const Solid& solid, const std::span<const Stroke> strokes) const {
  std::set<grid::CutLabel> labels;
  for (const auto& [label, found, swept] : strokes) {
    const auto is_new = [&, label = label](const auto& segment) { return !is_known(solid, segment, label); };
    const auto waits = [&](const EdgeCut& cut) { return pending_.waits(cut.edge); };
    if (std::ranges::any_of(found.cuts, [&](const EdgeCut& cut) { return is_new(cut.edge) && !waits(cut); }) ||
        std::ranges::any_of(found.later, is_new, &EdgeCut::edge) ||
        std::ranges::any_of(found.of_skin, is_new, &grid::SkinCut::segment) ||
        std::ranges::any_of(found.later_of_skin, is_new, &grid::SkinCut::segment))
      labels.insert(label);
  }
  return labels;
}

SweepCuts Cutter::put(Solid& solid, const SweepCuts& cuts, Added& added) {
  SweepCuts by_others;
  for (const EdgeCut& cut : cuts.cuts)
    if (solid.cuts.can_be_cut(solid.grid, cut.edge)) {
      solid.cuts.add(solid.grid, cut);
      added.edges.push_back(cut.edge);
      passed_[cut.label - 1].remove(solid.grid.cells(cut.edge));
    } else
      by_others.cuts.push_back(cut);
  for (const grid::SkinCut& cut : cuts.of_skin)
    if (!solid.cuts.is_cut(cut.segment)) {
      solid.cuts.add(cut);
      added.segments.push_back(cut.segment);
      passed_[cut.label - 1].remove(cells_of(solid.grid, cut.segment));
    } else
      by_others.of_skin.push_back(cut);
  return by_others;
}

Cutter::Added Cutter::add(Solid& solid, const SweepCuts& cuts, const Points& x) {
  Added added;
  auto& [edges, segments, edges_met, segments_met, coming] = added;
  const auto meet = [&](const auto& cut, const auto& segment, auto& met) {
    if (is_known(solid, segment, cut.label))
      return false;
    solid.cuts.add(segment, grid::LaterCut{cut.t, cut.normal, cut.label});
    met.push_back(segment);
    return true;
  };
  const auto meet_edge = [&](const EdgeCut& cut) {
    if (meet(cut, cut.edge, edges_met))
      counts_.between[cut.label - 1] += between(solid, cut, x);
  };
  for (const EdgeCut& cut : cuts.later)
    meet_edge(cut);
  for (const grid::SkinCut& cut : cuts.later_of_skin)
    meet(cut, cut.segment, segments_met);
  const SweepCuts by_others = put(solid, cuts, added);
  for (const EdgeCut& cut : by_others.cuts)
    meet_edge(cut);
  for (const grid::SkinCut& cut : by_others.of_skin)
    meet(cut, cut.segment, segments_met);
  take_up_left_ones(solid, pending_, edges, segments, edges_met, segments_met);
  std::sort(edges.begin(), edges.end());
  std::sort(segments.begin(), segments.end());
  leave_shreds(solid, edges, segments);
  for (const EdgeId e : edges)
    ++counts_.n_cut_edges[solid.cuts.find(e)->label - 1];
  return added;
}

std::vector<grid::CellId> Cutter::take_back_fronts(Solid& solid, Added& added, const Points& x) {
  std::vector<grid::CellId> cells, touched = grid::touched_cells(solid.grid, added.edges, added.segments);
  while (!touched.empty()) {
    Added more;
    for (const grid::CellId c : touched)
      if (const grid::Front* const front = solid.cuts.front(c); front && !is_ahead(solid, *front)) {
        put(solid, cuts_between_gaping(solid, *front, x), more);
        solid.cuts.take_back_front(c);
        cells.push_back(c);
      }
    for (const EdgeId e : more.edges)
      ++counts_.n_cut_edges[solid.cuts.find(e)->label - 1];
    touched = grid::touched_cells(solid.grid, more.edges, more.segments);
    added.edges.insert(added.edges.end(), more.edges.begin(), more.edges.end());
    added.segments.insert(added.segments.end(), more.segments.begin(), more.segments.end());
  }
  std::ranges::sort(added.edges);
  std::ranges::sort(added.segments);
  return cells;
}

CutChange Cutter::part(Solid& solid, Added added, const std::span<const grid::Front> fronts, const Points& x) {
  for (const grid::Front& front : fronts)
    solid.cuts.set(front);
  std::vector<grid::CellId> less_apart = take_back_fronts(solid, added, x), cells = less_apart;
  for (const grid::Front& front : fronts)
    cells.push_back(front.cell);
  const std::size_t n = cells.size();
  join(solid, added, x, cells);
  if (added.edges.empty() && added.segments.empty() && cells.empty())
    return {};
  less_apart.insert(less_apart.end(), cells.begin() + static_cast<std::ptrdiff_t>(n), cells.end());
  const SkinPlaces places = places_around(solid, less_apart);
  CutChange change = grid::update_complex(solid, added.edges, added.segments, cells);
  grid::inherit(change, x_before_);
  for (const auto& [c, before] : places)
    if (before != SkinNow(solid, c).places(x_before_))
      places_before_.emplace(c, before);
  return change;
}

SkinPlaces Cutter::places_around(const Solid& solid, const std::span<const grid::CellId> cells) const {
  SkinPlaces places;
  for (const grid::CellId c : cells)
    for (const grid::CellId next : cells_around(solid.grid, c))
      if (grid::material_of(solid.grid, next) != 0xff && !places.contains(next))
        places.emplace(next, SkinNow(solid, next).places(x_before_));
  return places;
}

/// Joins what lies on the same sides of all cuts. Adds to `anew` the cells whose copies join, or are parted by nothing
/// that is cut now.
void Cutter::join(Solid& solid, const Added& added, const Points& x, std::vector<grid::CellId>& anew) {
  const auto cut = grid::touched_cells(solid.grid, added.edges, added.segments);
  const auto met = grid::touched_cells(solid.grid, added.edges_met, added.segments_met);
  std::vector<grid::CellId> cells;
  std::ranges::set_union(cut, met, std::back_inserter(cells));
  cells.insert(cells.end(), unsettled_.begin(), unsettled_.end());
  if (cells.empty())
    return;
  for (const HeldSplinter& splinter : held_)
    cells.push_back(splinter.cell);
  sort_unique(cells);
  unsettled_.clear();
  const Passage passage(edges_, added.coming);
  std::map<grid::CellId, std::vector<grid::Joined>> before;
  const auto joined = [&](const grid::CellId c) {
    const std::vector<grid::Joined>* const groups = solid.cuts.joined(c);
    return groups ? *groups : std::vector<grid::Joined>();
  };
  for (const grid::CellId c : cells) {
    before.emplace(c, joined(c));
    std::vector<grid::Joined> groups;
    if (solid.cuts.front(c) == nullptr) {
      const grid::Segments unsettled = passage.cuts_in(solid, c, x, passed_.size(), left_);
      groups = near_each_other(
        solid, c, unsettled != 0 ? undivided(solid, c, without_cuts(solid, c, unsettled)) : on_same_sides(solid, c), x);
      if (unsettled != 0)
        unsettled_.insert(c);
    }
    solid.cuts.set_joined(c, std::move(groups));
  }
  held_ = held_splinters(solid, cells, held_, unsettled_, x);
  for (const HeldSplinter& splinter : held_) {
    std::vector<grid::Joined> groups = joined(splinter.cell);
    before.emplace(splinter.cell, groups);
    groups.push_back(splinter.parts);
    solid.cuts.set_joined(splinter.cell, std::move(groups));
  }
  for (const auto& [c, earlier] : before)
    if (const auto groups = joined(c);
        groups != earlier && (joins_copies(solid, c, groups) || !std::ranges::binary_search(cut, c)))
      anew.push_back(c);
}

std::size_t Cutter::n_passed_cells() const {
  std::size_t n = 0;
  for (const PassedCells& passed : passed_)
    n += passed.cells().size();
  return n;
}

Stroke Cutter::stroke(const Solid& solid, const Blade& blade, const double t0, const double t1, const Points& x) const {
  Stroke stroke{blade.label};
  for (const BladePath& path : paths(blade, t0, t1)) {
    append(stroke.found, cut_edges(path, solid, x_before_, x, blade.label, &*boxes_, &places_before_));
    const auto swept = swept_triangles(path);
    stroke.swept.insert(stroke.swept.end(), swept.begin(), swept.end());
  }
  return stroke;
}

/// Puts what blades have met to what waits, and counts what the grid cannot resolve of it. Returns all cuts that were
/// met.
SweepCuts Cutter::queue(const Solid& solid, const std::span<const Stroke> strokes, const Points& x) {
  SweepCuts met;
  for (const auto& [label, found, swept] : strokes) {
    append(met, found);
    counts_.n_double_crossings += found.n_double_crossings;
    passed_[label - 1].pass(swept, found, solid, x_before_, x, *boxes_, label);
  }
  if (release_ == Release::queued)
    for (const EdgeCut& cut : pending_.push(met.cuts))
      met.later.push_back(cut);
  return met;
}

} // namespace kerf::cut
