#include "fem/batches.h"

#include <algorithm>

namespace kerf::fem {

Batching::Batching(const std::span<const std::uint32_t> order, const std::function<Kind(std::uint32_t)>& kind,
                   const std::uint32_t* const corners, const std::size_t n_corners) {
  constexpr std::size_t chunk_size = 512;
  std::vector<std::uint32_t> full, partial;
  std::vector<Chunk> chunks;
  for (std::size_t begin = 0; begin < order.size(); begin += chunk_size) {
    full.clear();
    partial.clear();
    for (const std::uint32_t copy : order.subspan(begin, std::min(chunk_size, order.size() - begin)))
      if (const Kind k = kind(copy); k != Kind::unused)
        (k == Kind::full ? full : partial).push_back(copy);
    const auto first = static_cast<std::uint32_t>(batches_.size()),
               row = static_cast<std::uint32_t>(n_corners + chunks.size());
    add_batches(full, Kind::full, corners, row);
    add_batches(partial, Kind::partial, corners, row);
    chunks.push_back({first, static_cast<std::uint32_t>(batches_.size()) - first});
  }
  n_rows_ = n_corners + chunks.size();
  colour(chunks, n_corners);
}

void Batching::add_batches(const std::span<const std::uint32_t> copies, const Kind kind,
                           const std::uint32_t* const corners, const std::uint32_t row) {
  for (std::size_t begin = 0; begin < copies.size(); begin += n_lanes) {
    BatchOfCopies& batch = batches_.emplace_back();
    batch.partial = kind == Kind::partial ? static_cast<std::uint32_t>(n_partial_++) : BatchOfCopies::none;
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
void Batching::colour(const std::span<const Chunk> chunks, const std::size_t n_corners) {
  std::vector<std::uint64_t> taken(n_corners, 0); // bits of the colours that hold a corner
  for (const Chunk& chunk : chunks) {
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
void put(const Element& element, const std::size_t lane, PartialCubes<T>& cubes) {
  cubes.volume[lane] = T(element.volume);
  cubes.weight[lane] = 1;
  const auto gradients = mode_gradients(element);
  for (int i = 0; i < n_hourglass; ++i)
    cubes.gradient[i][lane] = T(gradients[i]);
  for (int i = 0; i < n_hourglass_pairs; ++i)
    cubes.hourglass[i][lane] = T(element.hourglass[i]);
}

} // namespace

template <class T>
BatchedElements<T> batched(const Batching& batching, const double h, const material::Elastic& material,
                           const Element& full, const std::function<const Element&(std::uint32_t)>& element) {
  BatchedElements<T> all{constants<T>(h, material, full), {}, {}, {}};
  all.partial.resize(batching.n_partial_batches());
  all.rotations.resize(batching.batches().size());
  batching.for_each([&](const std::size_t i) {
    const BatchOfCopies& batch = batching.batches()[i];
    for (int k = 0; k < 3; ++k)
      std::fill_n(all.rotations[i].row[4 * k], n_lanes, T(1));
    if (batch.partial != BatchOfCopies::none)
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        if (batch.copies[lane] != BatchOfCopies::none)
          put(element(batch.copies[lane]), lane, all.partial[batch.partial]);
  });
  return all;
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
                                         const std::function<const Element&(std::uint32_t)>&);
template BatchedElements<float> batched(const Batching&, double, const material::Elastic&, const Element&,
                                        const std::function<const Element&(std::uint32_t)>&);
template void add_product(const Batching&, const BatchedElements<double>&, const Row<double>*, Row<double>*);
template void add_product(const Batching&, const BatchedElements<float>&, const Row<float>*, Row<float>*);
template void add_diagonal(const Batching&, const BatchedElements<double>&, Row<double>*);
template void add_diagonal(const Batching&, const BatchedElements<float>&, Row<float>*);

} // namespace kerf::fem
