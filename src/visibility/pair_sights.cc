#include "visibility/pair_sights.h"

#include "base/error.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace kerf::visibility {

namespace {

constexpr std::uint64_t not_waiting = std::numeric_limits<std::uint64_t>::max();

void require_sound(const Pair& pair, const std::size_t number) {
  if (pair.a.allFinite() && pair.b.allFinite() && positive.contains(pair.support))
    return;
  throw NumericalError("visibility: the points and the support of pair " + std::to_string(number) +
                       " must be finite, the support > 0");
}

} // namespace

void PairSights::watch(const PairId first, const std::span<const Pair> pairs) {
  assert(first.value <= pairs_.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    require_sound(pairs[i], first.value + i);
  const std::size_t n = std::max(pairs_.size(), first.value + pairs.size());
  pairs_.resize(n);
  sights_.resize(n);
  place_.resize(n, not_waiting);
  std::vector<std::pair<PairId, std::uint32_t>> found;
  criterion_->watch(first, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairId id(first.value + i);
    pairs_[id] = pairs[i];
    sights_[id] = {(pairs[i].b - pairs[i].a).norm(), 1};
    cut_.for_each(criterion_->reach(pairs[i]), [&](const std::uint32_t face) {
      if (worth_looking(id, face))
        found.emplace_back(id, face);
    });
  }
  reaches_.reset();
  add_waiting(found);
}

void PairSights::add_faces(const std::span<const Face> faces) {
  const auto first = static_cast<std::uint32_t>(cut_.all().size());
  cut_.add(faces);
  if (!reaches_) {
    std::vector<Box> boxes;
    for (const Pair& pair : pairs_)
      boxes.push_back(criterion_->reach(pair));
    reaches_.emplace(std::move(boxes));
  }
  std::vector<std::pair<PairId, std::uint32_t>> found;
  for (std::uint32_t face = first; face < cut_.all().size(); ++face)
    reaches_->for_each(geometry::box_around(cut_.all()[face]), [&](const std::uint32_t i) {
      if (worth_looking(PairId(i), face))
        found.emplace_back(PairId(i), face);
    });
  add_waiting(found);
}

bool PairSights::worth_looking(const PairId pair, const std::uint32_t face) const {
  const pba::Sight& sight = sights_[pair];
  return sight.distance > 0 && sight.factor > 0 && criterion_->concerns(pairs_[pair], sight, cut_.all()[face]);
}

void PairSights::add_waiting(std::vector<std::pair<PairId, std::uint32_t>>& found) {
  std::sort(found.begin(), found.end());
  std::vector<std::uint32_t> faces;
  for (std::size_t i = 0; i < found.size(); ++i) {
    faces.push_back(found[i].second);
    if (i + 1 < found.size() && found[i + 1].first == found[i].first)
      continue;
    wait_for(found[i].first, faces);
    faces.clear();
  }
}

void PairSights::wait_for(const PairId pair, const std::span<const std::uint32_t> faces) {
  if (place_[pair] == not_waiting) {
    place_[pair] = n_taken_ + queue_.size();
    queue_.push_back({pair, {}});
  }
  std::vector<std::uint32_t>& waiting = queue_[place_[pair] - n_taken_].faces;
  waiting.insert(waiting.end(), faces.begin(), faces.end());
}

Progress PairSights::update(const std::size_t budget) {
  Progress progress;
  progress.n_done = std::min(budget, queue_.size());
  const auto end = queue_.begin() + static_cast<std::ptrdiff_t>(progress.n_done);
  const std::vector<Work> works(std::make_move_iterator(queue_.begin()), std::make_move_iterator(end));
  queue_.erase(queue_.begin(), end);
  n_taken_ += works.size();
  std::vector<pba::Sight> before;
  for (const Work& work : works) {
    before.push_back(sights_[work.pair]);
    place_[work.pair] = not_waiting;
  }
  criterion_->look(cut_, pairs_, works, sights_);
  for (std::size_t i = 0; i < works.size(); ++i)
    if (sights_[works[i].pair] != before[i])
      progress.changed.push_back(works[i].pair);
  progress.n_waiting = queue_.size();
  return progress;
}

} // namespace kerf::visibility
