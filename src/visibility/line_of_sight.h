#pragma once

/// The visibility criterion (thesis §2.3.1 [BLG94]): a pair is cut off as soon as a face crosses its segment.

#include "visibility/criterion.h"

namespace kerf::visibility {

class LineOfSight : public Criterion {
 public:
  Box reach(const Pair& pair) const override;
  bool concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const override;
  void watch(PairId, std::span<const Pair>) override {}
  void look(const CutFaces& cut, const Table<PairId, Pair>& pairs, std::span<const Work> works,
            Sights& sights) override;
};

} // namespace kerf::visibility
