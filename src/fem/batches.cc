#include "fem/batches.h"

#include <algorithm>
#include <utility>

namespace kerf::fem {

std::vector<std::uint32_t> Batching::update(const CopiesInOrder& copies, const std::span<const std::uint8_t> is_same) {
  const std::vector<BatchOfCopies> batches_before = std::exchange(batches_, {});
  const std::vector<Chunk> chunks_before = std::exchange(chunks_, {});
  const auto n_used =
    static_cast<std::size_t>(std::ranges::count_if(copies.kind, [](const Kind kind) { return kind != Kind::unused; }));
  batches_.reserve(n_used / n_lanes + 2 * copies.chunk_ends.size());
  std::vector<std::uint8_t> is_taken(n_places_, 0);
  std::vector<std::uint32_t> full, partial, renewed;
  const auto stays = [&](const BatchOfCopies& batch, const BatchOfCopies& before) {
    return !is_same.empty() && std::equal(std::begin(batch.copies), std::end(batch.copies), before.copies) &&
           std::ranges::all_of(
             batch.copies, [&](const std::uint32_t copy) { return copy == BatchOfCopies::none || is_same[copy] != 0; });
  };
  std::uint32_t begin = 0;
  for (std::size_t k = 0; k < copies.chunk_ends.size(); begin = copies.chunk_ends[k++]) {
    full.clear();
    partial.clear();
    for (const std::uint32_t copy : copies.order.subspan(begin, copies.chunk_ends[k] - begin))
      if (const Kind kind = copies.kind[copy]; kind != Kind::unused)
        (kind == Kind::full ? full : partial).push_back(copy);
    const auto first = static_cast<std::uint32_t>(batches_.size()),
               row = static_cast<std::uint32_t>(copies.n_corners + k);
    add_batches(full, copies.corners, row);
    const auto first_partial = static_cast<std::uint32_t>(batches_.size());
    add_batches(partial, copies.corners, row);
    const auto end = static_cast<std::uint32_t>(batches_.size());
    const Chunk before = k < chunks_before.size() ? chunks_before[k] : Chunk{0, 0, 0};
    for (std::uint32_t i = first_partial, was = before.first + before.n_full; i < end; ++i, ++was)
      if (was < before.first + before.n && stays(batches_[i], batches_before[was])) {
        batches_[i].partial = batches_before[was].partial;
        is_taken[batches_[i].partial] = 1;
      } else {
        renewed.push_back(i);
      }
    chunks_.push_back({first, first_partial - first, end - first});
  }
  std::size_t place = 0;
  for (const std::uint32_t i : renewed) {
    while (place < n_places_ && is_taken[place] != 0)
      ++place;
    batches_[i].partial = static_cast<std::uint32_t>(place++);
  }
  n_places_ = std::max(n_places_, place);
  n_rows_ = copies.n_corners + chunks_.size();
  colour(copies.n_corners);
  return renewed;
}

/// As if of full cubes.
void Batching::add_batches(const std::span<const std::uint32_t> copies, const std::uint32_t* const corners,
                           const std::uint32_t row) {
  for (std::size_t begin = 0; begin < copies.size(); begin += n_lanes) {
    BatchOfCopies& batch = batches_.emplace_back();
    batch.partial = BatchOfCopies::none;
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const bool is_used = begin + lane < copies.size();
      const std::uint32_t copy = is_used ? copies[begin + lane] : BatchOfCopies::none;
      batch.copies[lane] = copy;
      for (std::size_t a = 0; a < 8; ++a)
        batch.corners[a][lane] = is_used ? corners[8 * std::size_t(copy) + a] : row;
    }
  }
}

/// Each chunk the first colour that no chunk before it has that shares a corner.
void Batching::colour(const std::size_t n_corners) {
  colours_.clear();
  std::vector<std::uint64_t> taken(n_corners, 0); // bits of the colours that hold a corner
  for (const Chunk& chunk : chunks_) {
    std::uint64_t met = 0;
    const auto for_each_corner = [&](const auto& f) {
      for (std::uint32_t i = chunk.first; i < chunk.first + chunk.n; ++i)
        for (const auto& row : batches_[i].corners)
          for (const std::uint32_t corner : row)
            if (corner < n_corners)
              f(taken[corner]);
    };
    for_each_corner([&](const std::uint64_t colours) { met |= colours; });
    // With all 64 taken, which a chunk's neighbours never do, a chunk would stand alone in a colour of its own.
    const auto colour = static_cast<std::size_t>(std::min(63, std::countr_one(met)));
    const bool is_alone = met == ~std::uint64_t(0);
    if (is_alone)
      colours_.push_back({chunk});
    else {
      colours_.resize(std::max(colours_.size(), colour + 1));
      colours_[colour].push_back(chunk);
      for_each_corner([&](std::uint64_t& colours) { colours |= std::uint64_t(1) << colour; });
    }
  }
}

namespace {

template <class T>
CubeConstants<T> constants(const double h, const material::Elastic& material, const Element& full) {
  CubeConstants<T> cube{T(h), T(material.lambda()), T(material.mu()), T(full.volume), {}};
  std::copy(full.hourglass.begin(), full.hourglass.end(), cube.hourglass);
  return cube;
}

template <class T>
void put(const Element& element, const double bound, const std::size_t lane, PartialCubes<T>& cubes,
         HourglassOfCubes& hourglass) {
  cubes.volume[lane] = T(element.volume);
  cubes.weight[lane] = T(std::max(1.0, element.bound / bound));
  for (int i = 0; i < n_hourglass; ++i)
    cubes.gradient[i][lane] = T(element.mode_gradient[i / 3][i % 3]);
  for (int i = 0; i < n_hourglass_pairs; ++i)
    hourglass.pair[i][lane] = element.hourglass[i];
}

} // namespace

template <class T>
BatchedElements<T> batched(const Batching& batching, const double h, const material::Elastic& material,
                           const Element& full, const PartialElements& partial, const SharedHourglass& hourglass) {
  BatchedElements<T> all{constants<T>(h, material, full),
                         {},
                         hourglass ? hourglass : std::make_shared<std::vector<HourglassOfCubes>>(),
                         {},
                         {}};
  std::vector<std::uint32_t> all_partial;
  for (std::uint32_t i = 0; i < batching.batches().size(); ++i)
    if (batching.batches()[i].partial != BatchOfCopies::none)
      all_partial.push_back(i);
  follow(batching, all_partial, partial, all);
  for (Lanes9<T>& rotations : all.rotations)
    for (int k = 0; k < 3; ++k)
      std::fill_n(rotations.row[4 * k], n_lanes, T(1));
  return all;
}

template <class T>
void follow(const Batching& batching, const std::span<const std::uint32_t> renewed, const PartialElements& partial,
            BatchedElements<T>& elements) {
  elements.partial.resize(batching.n_places());
  elements.hourglass->resize(batching.n_places());
  elements.rotations.resize(batching.batches().size());
  parallel_for(
    renewed.size(),
    [&](const std::size_t i) {
      const BatchOfCopies& batch = batching.batches()[renewed[i]];
      PartialCubes<T>& cubes = elements.partial[batch.partial];
      HourglassOfCubes& hourglass = (*elements.hourglass)[batch.partial];
      cubes = {};
      hourglass = {};
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        if (batch.copies[lane] != BatchOfCopies::none)
          put(partial.of(batch.copies[lane]), partial.bound, lane, cubes, hourglass);
    },
    16);
}

template <class T>
void add_product(const Batching& batching, const BatchedElements<T>& elements, const Row<T>* const p, Row<T>* const y) {
  const auto product = element_kernels<T>().product;
  batching.for_each_in_order([&](const std::size_t i) { product(elements.cube, elements.batch(batching, i), p, y); });
}

template <class T>
void add_diagonal(const Batching& batching, const BatchedElements<T>& elements, Row<T>* const blocks) {
  const auto diagonal = element_kernels<T>().diagonal;
  batching.for_each_in_order(
    [&](const std::size_t i) { diagonal(elements.cube, elements.batch(batching, i), blocks); });
}

template BatchedElements<double> batched(const Batching&, double, const material::Elastic&, const Element&,
                                         const PartialElements&, const SharedHourglass&);
template BatchedElements<float> batched(const Batching&, double, const material::Elastic&, const Element&,
                                        const PartialElements&, const SharedHourglass&);
template void follow(const Batching&, std::span<const std::uint32_t>, const PartialElements&, BatchedElements<double>&);
template void follow(const Batching&, std::span<const std::uint32_t>, const PartialElements&, BatchedElements<float>&);
template void add_product(const Batching&, const BatchedElements<double>&, const Row<double>*, Row<double>*);
template void add_product(const Batching&, const BatchedElements<float>&, const Row<float>*, Row<float>*);
template void add_diagonal(const Batching&, const BatchedElements<double>&, Row<double>*);
template void add_diagonal(const Batching&, const BatchedElements<float>&, Row<float>*);

} // namespace kerf::fem
