#pragma once

/// The sights of many pairs while a cut grows, under a budget (thesis §2.8: disks are updated in the order in which
/// faces came near them, so many a step; the budget is a number of pairs, not a time, so that runs repeat).
///
/// Method: a box tree over the reaches of the pairs finds those that a new face may concern. Each waits once, with all
/// its faces, in the order of first come, and by number among those that came at once. A pair that sees nothing any
/// more is left alone: what is cut off stays cut off.

#include "visibility/criterion.h"

#include <deque>
#include <optional>

namespace kerf::visibility {

/// What an update did.
struct Progress {
  std::vector<PairId> changed; ///< whose sight is another one now, in the order of work
  std::size_t n_done = 0;      ///< pairs looked at
  std::size_t n_waiting = 0;   ///< pairs that wait for the next update
};

class PairSights {
 public:
  explicit PairSights(std::unique_ptr<Criterion> criterion) : criterion_(std::move(criterion)) {}

  /// Pairs first, first + 1, ... are these from now on; the table grows when it must, but leaves no gap. What is cut
  /// already comes between them with the next updates. Two points in one place always see each other. Throws
  /// NumericalError if a coordinate or a support is not finite, or a support is not > 0.
  void watch(PairId first, std::span<const Pair> pairs);

  /// The cut grows. Throws NumericalError if a coordinate is not finite.
  void add_faces(std::span<const Face> faces);

  /// Looks at no more than `budget` of the waiting pairs.
  Progress update(std::size_t budget);

  const Sights& sights() const { return sights_; }
  const Table<PairId, Pair>& pairs() const { return pairs_; }
  const CutFaces& cut() const { return cut_; }
  std::size_t n_waiting() const { return queue_.size(); }
  /// Into one with a criterion of the same kind.
  void archive(Archive& a) {
    a.name("sights");
    a(*criterion_, pairs_, sights_, cut_, queue_, n_taken_, place_);
    if (a.reads())
      reaches_.reset();
  }

 private:
  void wait_for(PairId pair, std::span<const std::uint32_t> faces);
  void add_waiting(std::vector<std::pair<PairId, std::uint32_t>>& found);
  bool worth_looking(PairId pair, std::uint32_t face) const;

  std::unique_ptr<Criterion> criterion_;
  Table<PairId, Pair> pairs_;
  Sights sights_;
  CutFaces cut_;
  std::optional<geometry::BoxTree> reaches_; // none while pairs change
  std::deque<Work> queue_;
  std::uint64_t n_taken_ = 0;          // works that have left the queue, ever
  Table<PairId, std::uint64_t> place_; // in the queue, counted from the first work ever; not_waiting if none
};

} // namespace kerf::visibility
