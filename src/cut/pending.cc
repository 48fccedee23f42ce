#include "cut/pending.h"

#include <algorithm>
#include <unordered_map>

namespace kerf::cut {
namespace {

/// How many edges of each cell a release cuts.
class RoomInCells {
 public:
  /// Counts the edge in all its cells, or in none when one of them has no room left.
  bool take(const grid::Grid& grid, const grid::EdgeId edge) {
    const auto cells = grid.cells(edge);
    const auto is_full = [this](const grid::CellId c) { return c.valid() && n_[c.value] == PendingCuts::max_per_cell; };
    if (std::any_of(cells.begin(), cells.end(), is_full))
      return false;
    for (const grid::CellId c : cells)
      if (c.valid())
        ++n_[c.value];
    return true;
  }

 private:
  std::unordered_map<std::uint32_t, int> n_;
};

} // namespace

std::vector<grid::EdgeCut> PendingCuts::push(const std::span<const grid::EdgeCut> cuts) {
  std::vector<grid::EdgeCut> later;
  for (const grid::EdgeCut& cut : cuts)
    if (const auto [first, is_new] = waiting_.try_emplace(cut.edge, cut.label); is_new)
      queue_.push_back(cut);
    else if (first->second != cut.label)
      later.push_back(cut);
  return later;
}

std::set<grid::CutLabel> PendingCuts::labels() const {
  std::set<grid::CutLabel> labels;
  for (const grid::EdgeCut& cut : queue_)
    labels.insert(cut.label);
  return labels;
}

std::vector<grid::EdgeCut> PendingCuts::release(const grid::Solid& solid) {
  std::vector<grid::EdgeCut> released;
  if (queue_.empty())
    return released;
  std::deque<grid::EdgeCut> waiting;
  RoomInCells counts;
  for (const grid::EdgeCut& cut : queue_) {
    const bool can_be_cut = solid.cuts.can_be_cut(solid.grid, cut.edge),
               is_released = can_be_cut && counts.take(solid.grid, cut.edge);
    if (is_released)
      released.push_back(cut);
    if (is_released || !can_be_cut)
      waiting_.erase(cut.edge);
    else
      waiting.push_back(cut);
  }
  queue_ = std::move(waiting);
  return released;
}

} // namespace kerf::cut
