#include "visibility/extended.h"

#include <algorithm>

namespace kerf::visibility {

ExtendedVisibility::ExtendedVisibility(const MaskShape& shape, std::unique_ptr<Rasteriser> rasteriser)
  : shape_(shape), rasteriser_(std::move(rasteriser)) {}

Box ExtendedVisibility::reach(const Pair& pair) const { return box_of_lines(pair, shape_); }

bool ExtendedVisibility::concerns(const Pair& pair, const pba::Sight&, const Face& face) const {
  const Disk disk = make_disk(pair, shape_);
  return may_occlude(disk, shape_, face, 0) || may_occlude(disk, shape_, face, 1);
}

void ExtendedVisibility::watch(const PairId first, const std::span<const Pair> pairs) {
  const std::size_t n = shape_.resolution(), begin = first.value * n, end = begin + pairs.size() * n;
  masks_.resize(std::max(masks_.size(), end));
  std::fill(masks_.begin() + static_cast<std::ptrdiff_t>(begin), masks_.begin() + static_cast<std::ptrdiff_t>(end), 0u);
}

std::span<const std::uint32_t> ExtendedVisibility::mask(const PairId pair) const {
  const std::size_t n = shape_.resolution();
  return std::span(masks_).subspan(pair.value * n, n);
}

void ExtendedVisibility::look(const CutFaces& cut, const Table<PairId, Pair>& pairs, const std::span<const Work> works,
                              Sights& sights) {
  std::vector<DiskUpdate> updates;
  updates.reserve(works.size());
  for (const Work& work : works)
    updates.push_back({make_disk(pairs[work.pair], shape_), work.faces,
                       masks_.data() + std::size_t(work.pair.value) * shape_.resolution()});
  rasteriser_->occlude(shape_, cut.all(), updates);
  const double n = shape_.n_texels();
  for (const Work& work : works)
    sights[work.pair].factor = (n - count(mask(work.pair))) / n;
}

} // namespace kerf::visibility
