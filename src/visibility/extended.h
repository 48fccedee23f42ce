#pragma once

/// The extended visibility criterion (thesis §2.6.2, §2.6.3, equations 2.38 and 2.39): of the visibility disk of a
/// pair, the share that no face occludes. A mask a pair remembers the occluded texels; faces only add to them, so each
/// face is drawn once into each disk it may occlude, in any order.
///
/// Departure: the texels of (i, j) and (j, i) lie differently in the same disk, so their weights differ by some texels.
/// Keep one pair for both where the weights must be the same.

#include "visibility/criterion.h"
#include "visibility/rasteriser.h"

namespace kerf::visibility {

class ExtendedVisibility : public Criterion {
 public:
  ExtendedVisibility(const MaskShape& shape, std::unique_ptr<Rasteriser> rasteriser);

  Box reach(const Pair& pair) const override;
  bool concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const override;
  void watch(PairId first, std::span<const Pair> pairs) override;
  void look(const CutFaces& cut, const Table<PairId, Pair>& pairs, std::span<const Work> works,
            Sights& sights) override;

  void archive(Archive& a) override { a(masks_); }

  /// The occluded texels of a pair: `resolution` words.
  std::span<const std::uint32_t> mask(PairId pair) const;
  const MaskShape& shape() const { return shape_; }

 private:
  MaskShape shape_;
  std::unique_ptr<Rasteriser> rasteriser_;
  std::vector<std::uint32_t> masks_;
};

} // namespace kerf::visibility
