#include "cut/cutter.h"

namespace kerf::cut {

using grid::CutChange;
using grid::EdgeCut;
using grid::EdgeId;
using grid::Solid;

Cutter::Cutter(const std::size_t n_labels, const Release release)
  : release_(release), passed_(n_labels), open_ends_(n_labels), counts_{std::vector<std::size_t>(n_labels, 0)} {}

void Cutter::begin(const Solid& solid, const Points& x) {
  boxes_.emplace(solid);
  x_before_ = x;
}

CutChange Cutter::step(Solid& solid, const std::span<const Blade> blades, const double t0, const double t1,
                       const Points& x) {
  if (!blades.empty())
    boxes_->fit(x_before_, x);
  std::vector<Stroke> strokes;
  for (const Blade& blade : blades)
    strokes.push_back(stroke(solid, blade, t0, t1, x));
  return take(solid, strokes, x);
}

CutChange Cutter::step(Solid& solid, const std::span<const Stroke> strokes, const Points& x) {
  if (!strokes.empty())
    boxes_->fit(x_before_, x);
  return take(solid, strokes, x);
}

/// `boxes_` are fitted.
CutChange Cutter::take(Solid& solid, const std::span<const Stroke> strokes, const Points& x) {
  auto cuts = queue(solid, strokes, x);
  std::vector<EdgeId> ended;
  for (const Stroke& stroke : strokes)
    for (const EdgeId e : close(solid, stroke.whereabouts, x, stroke.label))
      ended.push_back(e);
  if (release_ == Release::queued)
    cuts = pending_.release(solid);
  x_before_ = x; // not after the cut: where corners jump then, the blade meets them on their way
  std::vector<EdgeId> edges = add(solid, cuts, Front::possible, x);
  edges.insert(edges.end(), ended.begin(), ended.end());
  const CutChange change = follow(solid, std::move(edges));
  for (const Stroke& stroke : strokes)
    open_ends_[stroke.label - 1].note(solid, change.cells, stroke.label);
  return change;
}

CutChange Cutter::at_once(Solid& solid, const CutSurface& surface, const Points& x) {
  boxes_->fit(x);
  const SweepCuts found = cut_edges(surface, solid, x, &*boxes_);
  counts_.n_double_crossings += found.n_double_crossings;
  const Front front = rim(surface).empty() ? Front::none : Front::possible;
  const CutChange change = cut(solid, found.cuts, front, x);
  OpenEnds& ends = open_ends_[surface.label - 1];
  ends = {};
  if (front == Front::possible)
    ends.note(solid, change.cells, surface.label);
  return change;
}

CutChange Cutter::end(Solid& solid, const CutSurface& surface, const Points& x) {
  return follow(solid, close(solid, rim(surface), x, surface.label));
}

CutChange Cutter::cut(Solid& solid, const std::span<const EdgeCut> cuts, const Front front, const Points& x) {
  return follow(solid, add(solid, cuts, front, x));
}

std::size_t Cutter::n_passed_cells() const {
  std::size_t n = 0;
  for (const PassedCells& passed : passed_)
    n += passed.cells().size();
  return n;
}

Stroke Cutter::stroke(const Solid& solid, const Blade& blade, const double t0, const double t1, const Points& x) const {
  Stroke stroke{blade.label, {}, sweep(blade, t0, t1), whereabouts(blade, t0, t1)};
  for (const BladePath& path : paths(blade, t0, t1)) {
    const auto [cuts, n_double_crossings] = cut_edges(path, solid, x_before_, x, blade.label, &*boxes_);
    stroke.found.cuts.insert(stroke.found.cuts.end(), cuts.begin(), cuts.end());
    stroke.found.n_double_crossings += n_double_crossings;
  }
  return stroke;
}

/// Puts what blades have met to what waits, and counts what the grid cannot resolve of it. Returns all cuts that were
/// met.
std::vector<EdgeCut> Cutter::queue(const Solid& solid, const std::span<const Stroke> strokes, const Points& x) {
  std::vector<EdgeCut> met;
  for (const auto& [label, found, swept, whereabouts] : strokes) {
    met.insert(met.end(), found.cuts.begin(), found.cuts.end());
    counts_.n_double_crossings += found.n_double_crossings;
    passed_[label - 1].pass(swept, found.cuts, solid, x, *boxes_, label);
  }
  if (release_ == Release::queued)
    pending_.push(met);
  return met;
}

/// Ends the cuts of a label where its blade is no more. Returns cut edges at faces whose skin is parted so.
std::vector<EdgeId> Cutter::close(Solid& solid, const std::span<const std::array<Vec3, 3>> whereabouts, const Points& x,
                                  const grid::CutLabel label) {
  return open_ends_[label - 1].close(whereabouts, pending_, solid, x, label);
}

/// Adds cuts, and counts them; returns the edges at which something has changed.
std::vector<EdgeId> Cutter::add(Solid& solid, const std::span<const EdgeCut> cuts, const Front front, const Points& x) {
  const std::size_t n_before = solid.cuts.all().size();
  AddedCuts added = add_cuts(solid, x, cuts, front);
  counts_.n_tips += added.n_tips;
  for (const EdgeCut& cut : solid.cuts.all().subspan(n_before)) {
    ++counts_.n_cut_edges[cut.label - 1];
    passed_[cut.label - 1].remove_around(solid.grid, cut.edge);
  }
  return std::move(added.edges);
}

CutChange Cutter::follow(Solid& solid, std::vector<EdgeId> edges) {
  if (edges.empty())
    return {};
  CutChange change = grid::update_complex(solid, std::move(edges));
  grid::inherit(change, x_before_);
  return change;
}

} // namespace kerf::cut
