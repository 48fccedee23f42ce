#pragma once

/// What the levels of multigrid.h are made of. A coarse element is the sum of its children (coarse_elements.h); after a
/// cut those whose children are what they were are taken over, so only what the cut has reached is summed anew.

#include "fem/batches.h"
#include "fem/coarsening.h"

#include <memory>

namespace kerf::fem {

struct LevelElements {
  Element full;
  std::vector<Kind> kind;           ///< of each copy
  std::vector<std::uint32_t> which; ///< of `made`, for partial copies
  std::vector<std::shared_ptr<const Element>> made; ///< some of them before the last cut
  std::vector<std::uint8_t> n_children;
  std::vector<std::uint32_t> same_as; ///< which copy had this element before the last cut; CellsOfLevel::unused: none

  const Element& operator[](const std::size_t copy) const {
    return kind[copy] == Kind::full ? full : *made[which[copy]];
  }
};

/// The elements that become children.
struct FineElements {
  std::function<const Element&(std::uint32_t copy)> element; ///< of any copy that is used
  std::span<const Kind> kind;                                ///< of each copy
  const Element& full;
};

/// What there was before the last cut.
struct CoarseBefore {
  std::span<const std::uint32_t> same_child; ///< which one each child was; CellsOfLevel::unused: it is another now
  std::span<const std::uint32_t> parent;     ///< of each child then
  const LevelElements& elements;
};

/// `h`: edge of the fine cubes; `before`: null where all is new. Either way gives the same bits.
LevelElements coarse_elements(const Coarsening& coarsening, const FineElements& fine, double h,
                              const material::Elastic& material, const CoarseBefore* before);

} // namespace kerf::fem
