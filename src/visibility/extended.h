#pragma once

/// The extended visibility criterion (thesis §2.6.2, §2.6.3, equations 2.38 and 2.39): of the part of a pair's
/// visibility disk that lies in the body, the share that no face occludes. A mask a pair remembers the closed texels:
/// those outside of the body and the occluded ones; faces only add to them, so each face is drawn once into each disk
/// it may occlude, in any order.
///
/// Departures: (2.39) divides by the texels of the whole disk. Where it reaches out of the body no cut occludes it, so
/// bonds across a cut stayed all along the skin, and an edge crack was held two thirds closed. Here a texel is outside
/// when the skin occludes it, which §2.7 takes as the first cut; that is looked up when a cut first comes near the
/// pair. A pair without a texel in the body, across a gap between two parts, keeps its whole disk.
/// The texels of (i, j) and (j, i) lie differently in the same disk, so their weights differ by some texels. Keep one
/// pair for both where the weights must be the same.

#include "visibility/criterion.h"
#include "visibility/rasteriser.h"

namespace kerf::visibility {

class ExtendedVisibility : public Criterion {
 public:
  /// `skin`: around the body, of the time of the first cut; none: bodies have no end. Throws as CutFaces::add().
  ExtendedVisibility(const MaskShape& shape, std::unique_ptr<Rasteriser> rasteriser, std::span<const Face> skin = {});

  Box reach(const Pair& pair) const override;
  bool concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const override;
  void watch(PairId first, std::span<const Pair> pairs) override;
  void look(const CutFaces& cut, const Table<PairId, Pair>& pairs, std::span<const Work> works,
            Sights& sights) override;

  void archive(Archive& a) override { a(skin_, masks_, n_inside_); }

  /// The closed texels of a pair: `resolution` words.
  std::span<const std::uint32_t> mask(PairId pair) const;
  const MaskShape& shape() const { return shape_; }

 private:
  std::uint32_t* words(PairId pair);
  /// Closes what lies outside of the body in disks that nobody has looked at.
  void close_outside(const Table<PairId, Pair>& pairs, std::span<const Work> works);

  MaskShape shape_;
  std::unique_ptr<Rasteriser> rasteriser_;
  CutFaces skin_;
  std::vector<std::uint32_t> masks_;
  std::vector<std::uint16_t> n_inside_; ///< texels of each pair that lie in the body; 0: not looked at yet
};

} // namespace kerf::visibility
