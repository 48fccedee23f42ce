#include "visibility/extended.h"

#include <algorithm>

namespace kerf::visibility {

ExtendedVisibility::ExtendedVisibility(const MaskShape& shape, std::unique_ptr<Rasteriser> rasteriser,
                                       const std::span<const Face> skin)
  : shape_(shape), rasteriser_(std::move(rasteriser)) {
  skin_.add(skin);
}

Box ExtendedVisibility::reach(const Pair& pair) const { return box_of_lines(pair, shape_); }

bool ExtendedVisibility::concerns(const Pair& pair, const pba::Sight&, const Face& face) const {
  const Disk disk = make_disk(pair, shape_);
  return may_occlude(disk, shape_, face, 0) || may_occlude(disk, shape_, face, 1);
}

void ExtendedVisibility::watch(const PairId first, const std::span<const Pair> pairs) {
  const std::size_t n = shape_.resolution(), end = first.value + pairs.size();
  masks_.resize(std::max(masks_.size(), end * n));
  n_inside_.resize(std::max(n_inside_.size(), end));
  std::fill_n(masks_.begin() + static_cast<std::ptrdiff_t>(first.value * n), pairs.size() * n, 0u);
  std::fill_n(n_inside_.begin() + first.value, pairs.size(), std::uint16_t(0));
}

std::span<const std::uint32_t> ExtendedVisibility::mask(const PairId pair) const {
  const std::size_t n = shape_.resolution();
  return std::span(masks_).subspan(pair.value * n, n);
}

std::uint32_t* ExtendedVisibility::words(const PairId pair) {
  return masks_.data() + std::size_t(pair.value) * shape_.resolution();
}

void ExtendedVisibility::close_outside(const Table<PairId, Pair>& pairs, const std::span<const Work> works) {
  std::vector<PairId> fresh;
  for (const Work& work : works)
    if (n_inside_[work.pair.value] == 0)
      fresh.push_back(work.pair);
  std::vector<std::vector<std::uint32_t>> near(fresh.size());
  std::vector<DiskUpdate> updates;
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    skin_.for_each(reach(pairs[fresh[i]]), [&](const std::uint32_t face) { near[i].push_back(face); });
    if (!near[i].empty())
      updates.push_back({make_disk(pairs[fresh[i]], shape_), near[i], words(fresh[i])});
  }
  rasteriser_->occlude(shape_, skin_.all(), updates);
  for (const PairId pair : fresh) {
    if (count(mask(pair)) == shape_.n_texels())
      std::fill_n(words(pair), shape_.resolution(), 0u);
    n_inside_[pair.value] = static_cast<std::uint16_t>(shape_.n_texels() - count(mask(pair)));
  }
}

void ExtendedVisibility::look(const CutFaces& cut, const Table<PairId, Pair>& pairs, const std::span<const Work> works,
                              Sights& sights) {
  close_outside(pairs, works);
  std::vector<DiskUpdate> updates;
  updates.reserve(works.size());
  for (const Work& work : works)
    updates.push_back({make_disk(pairs[work.pair], shape_), work.faces, words(work.pair)});
  rasteriser_->occlude(shape_, cut.all(), updates);
  for (const Work& work : works)
    sights[work.pair].factor = (shape_.n_texels() - count(mask(work.pair))) / double(n_inside_[work.pair.value]);
}

} // namespace kerf::visibility
