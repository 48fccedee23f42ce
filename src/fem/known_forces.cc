#include "fem/known_forces.h"

#include "base/fingerprint.h"

#include <algorithm>

namespace kerf::fem {

void KnownForces::follow(ChangeOfBatches change, const Batching& batching, const Incidence& incidence,
                         const grid::CornerNumbers& numbers, const std::span<const std::uint32_t> touched) {
  const std::lock_guard lock(mutex_);
  before_ = std::nullopt;
  if (!where_)
    return;
  ForcesBeforeCut before{*std::exchange(where_, std::nullopt), of_elements_.forces.size(),
                         std::exchange(of_elements_, {}),      std::move(change),
                         {touched.begin(), touched.end()},     {}};
  // The order in which a sum is taken is that of the batches: it is another one at all corners of those that are new.
  std::vector<std::uint8_t> is_changed(numbers.size(), 0), holds_changed(incidence.n_copies(), 0);
  for (const std::uint32_t corner : touched)
    is_changed[corner] = 1;
  for (std::size_t i = 0; i < batching.batches().size(); ++i)
    if (before.change.was[i] == ChangeOfBatches::none)
      for (std::size_t lane = 0; lane < batching.batches()[i].n_used; ++lane)
        for (const auto& corners : batching.batches()[i].corners)
          if (std::exchange(is_changed[corners[lane]], 1) == 0)
            before.changed.push_back(corners[lane]);
  for (const std::uint32_t corner : before.changed)
    for (const std::uint32_t user : incidence.users(numbers.corner(corner)))
      holds_changed[user / 8] = 1;
  for (const BatchOfCopies& batch : batching.batches())
    before.is_asked.push_back(std::any_of(batch.copies, batch.copies + batch.n_used, [&](const std::uint32_t copy) {
      return holds_changed[copy] != 0;
    }));
  before_ = std::move(before);
}

std::optional<ForcesBeforeCut> KnownForces::before_cut(const Points& x) const {
  const std::lock_guard lock(mutex_);
  std::optional<ForcesBeforeCut> before = std::exchange(before_, std::nullopt);
  if (before && (x.size() < before->n_corners || fingerprint(x, before->n_corners) != before->at))
    before = std::nullopt;
  return before;
}

} // namespace kerf::fem
