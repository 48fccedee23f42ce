#pragma once

/// Cuts that wait. At most two edges of a cell are cut in one step, so that its vertices can be placed one cut after
/// the other (thesis §2.4.3); the rest waits, first come first served. The input mesh and cut surfaces, cut all at
/// once, do not go through here; nor do the skin's own segments.

#include "grid/solid.h"

#include <deque>
#include <map>
#include <set>
#include <span>
#include <vector>

namespace kerf::cut {

class PendingCuts {
 public:
  static constexpr int max_per_cell = 2; ///< edges of a cell that one release may cut

  /// Puts cuts at the end of the queue, in their order; an edge that waits already keeps its first cut. Returns those
  /// of other labels that it does not keep.
  std::vector<grid::EdgeCut> push(std::span<const grid::EdgeCut> cuts);

  /// Takes out the cuts of this step, oldest first: each one that leaves no cell around its edge with more than two.
  /// Edges cut meanwhile are dropped. `cuts` is not changed.
  std::vector<grid::EdgeCut> release(const grid::Solid& solid);

  std::size_t size() const { return queue_.size(); }
  bool waits(grid::EdgeId e) const { return waiting_.contains(e); }
  std::set<grid::CutLabel> labels() const; ///< of all that wait
  void archive(Archive& a) { a(queue_, waiting_); }

 private:
  std::deque<grid::EdgeCut> queue_;
  std::map<grid::EdgeId, grid::CutLabel> waiting_;
};

} // namespace kerf::cut
