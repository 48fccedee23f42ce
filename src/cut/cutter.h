#pragma once

/// Who cuts a body: the one way for blades and surfaces, in scenes as in tests. It finds what they meet, keeps what
/// waits and what may still go on, counts, and cuts the grid's edges and the copies. What it returns is all that a
/// cut has changed: placement, surface and physics follow that (scene/body.cc).
///
/// Where a blade crosses what others have cut, it parts a cell only once it has left the cell, and those beside it:
/// what its cuts free before may belong to a part from which only later ones, or those of the next cell, tell that it
/// does (sides.h). Such cells are *unsettled*. They wait as long as the blade comes on: it has moved in the step, or
/// has met something that it had not before, as where material moves through a blade that rests, or cuts of it wait. A
/// blade that has left a cell, or come to rest in it, holds it no more, so that what it has parted is not joined when
/// it comes by again.
///
/// Labels: of blades and surfaces, from 1 on.

#include "cut/advance.h"
#include "cut/cut_surface.h"
#include "cut/fronts.h"
#include "cut/passage.h"
#include "cut/passed.h"
#include "cut/pending.h"
#include "cut/splinters.h"
#include "grid/solid.h"

#include <optional>

namespace kerf::cut {

/// What a blade does in a step.
struct Stroke {
  grid::CutLabel label = 1;
  SweepCuts found = {}; ///< that it meets
  std::vector<SweptTriangle> swept = {};
};

/// All so far.
struct CutCounts {
  std::vector<std::size_t> n_cut_edges; ///< by label, from 1
  std::size_t n_double_crossings = 0; ///< edges and segments of the skin that one cut crossed an even number of times:
                                      ///< left uncut
  std::vector<double> between;        ///< by label, from 1: an estimate of the material that lies between a cut and
                                      ///< those of other labels before it on the same edges, which a neighbour has of
                                      ///< what it belongs to, as an edge is cut once [cells]

  void archive(Archive& a) { a(n_cut_edges, n_double_crossings, between); }
};

/// What blades meet in a step: two edges of a cell at most are cut in it, the rest waits (pending.h); or all are. The
/// skin is always cut at once.
enum class Release { queued, at_once };

class Cutter {
 public:
  explicit Cutter(std::size_t n_labels, Release release = Release::queued, Fronts fronts = Fronts::at_faces);

  /// Before the first cut, with the corners at x [m, world frame; so below].
  void begin(const grid::Solid& solid, const Points& x);
  /// Blades take it that the corners have been at x until now.
  void stand(const Points& x) {
    x_before_ = x;
    boxes_stand_there_ = false;
  }
  const Points& stands_at() const { return x_before_; }

  /// Cuts with what the blades sweep between two times [s] while the corners go to x from where they were in the step
  /// before. Throws NumericalError when a corner is not at a finite position.
  grid::CutChange step(grid::Solid& solid, std::span<const Blade> blades, double t0, double t1, const Points& x);
  /// The same with what blades have met.
  grid::CutChange step(grid::Solid& solid, std::span<const Stroke> strokes, const Points& x);

  /// Cuts with a surface, all of it at once.
  grid::CutChange at_once(grid::Solid& solid, const CutSurface& surface, const Points& x);
  /// Cuts edges and segments of the skin that are known.
  grid::CutChange cut(grid::Solid& solid, const SweepCuts& cuts);

  const CutCounts& counts() const { return counts_; }
  /// Cuts that wait.
  std::size_t n_waiting() const { return pending_.size(); }
  /// Cells that blades have passed without a cut (passed.h).
  std::size_t n_passed_cells() const;
  std::size_t n_passed_cells(const grid::CutLabel label) const { return passed_[label - 1].cells().size(); }
  /// All but the boxes, which are made of the body before its first cut and fitted in each step.
  void archive(Archive& a) {
    a.name("cutter");
    a(pending_, passed_, advance_, edges_, unsettled_, left_, held_, x_before_, places_before_, counts_);
  }
  /// Memory of what grows with the body [B].
  std::size_t n_bytes() const { return boxes_->n_bytes() + sizeof(Vec3) * x_before_.capacity(); }

 private:
  Stroke stroke(const grid::Solid& solid, const Blade& blade, double t0, double t1, const Points& x) const;
  grid::CutChange take(grid::Solid& solid, std::span<const Stroke> strokes, const Points& x);
  /// What is cut now.
  struct Added {
    std::vector<grid::EdgeId> edges;
    std::vector<grid::SkinSegment> segments;
    std::vector<grid::EdgeId> edges_met; // that were cut before, by others
    std::vector<grid::SkinSegment> segments_met;
    std::set<grid::CutLabel> coming; // of blades that have met something that they had not before, or whose cuts wait
  };
  /// Cuts what can be cut; returns what others of the same step have cut.
  SweepCuts put(grid::Solid& solid, const SweepCuts& cuts, Added& added);
  Added add(grid::Solid& solid, const SweepCuts& cuts, const Points& x);
  /// Of blades that meet something that they have neither cut nor met before.
  std::set<grid::CutLabel> labels_that_meet(const grid::Solid& solid, std::span<const Stroke> strokes) const;
  grid::CutChange part(grid::Solid& solid, Added added, std::span<const grid::Front> fronts, const Points& x);
  /// Takes back the fronts of cells that their blades have come through, and returns these cells; adds what keeps apart
  /// what gapes.
  std::vector<grid::CellId> take_back_fronts(grid::Solid& solid, Added& added, const Points& x);
  /// Where points of the skin are that may go over to other copies, around cells whose parts do not stay apart as they
  /// were.
  SkinPlaces places_around(const grid::Solid& solid, std::span<const grid::CellId> cells) const;
  void join(grid::Solid& solid, const Added& added, const Points& x, std::vector<grid::CellId>& anew);
  /// To the way from x_before_ to x, where that is asked for.
  void fit_boxes(bool is_asked, const Points& x);
  SweepCuts queue(const grid::Solid& solid, std::span<const Stroke> strokes, const Points& x);

  Release release_;
  Fronts fronts_;
  PendingCuts pending_;
  std::optional<EdgeBoxes> boxes_;  // around the edges; there from begin() on
  std::vector<PassedCells> passed_; // by label, from 1
  Advance advance_;
  std::vector<StandingEdge> edges_; // after the last step
  std::set<grid::CellId> unsettled_;
  std::set<LeftCell> left_; // blades hold these cells no more
  std::vector<HeldSplinter> held_;
  Points x_before_;                // where the corners were when the blades were met last [m]
  SkinPlaces places_before_;       // of points of the skin that have gone over to other copies since [m]
  bool boxes_stand_there_ = false; // fitted to them
  CutCounts counts_;
};

} // namespace kerf::cut
