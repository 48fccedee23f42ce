#include "fem/batches.h"

#include "base/loan.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace kerf::fem {

namespace {

/// Few enough of many chunks to be taken by many threads; of few, one each.
std::vector<Run> runs(const std::size_t n_chunks) {
  constexpr std::size_t least = 64, longest = 12; // runs, chunks
  const std::size_t length = std::clamp<std::size_t>(n_chunks / least, 1, longest);
  std::vector<Run> all;
  for (std::size_t first = 0; first < n_chunks; first += length)
    all.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(std::min(first + length, n_chunks))});
  return all;
}

/// The vertices of each run, 8 a cube.
struct VerticesOfRuns {
  std::span<const std::uint32_t> chunk_ends, vertices;

  std::span<const std::uint32_t> operator[](const Run& run) const {
    const std::size_t begin = run.first == 0 ? 0 : chunk_ends[run.first - 1];
    return vertices.subspan(8 * begin, 8 * (chunk_ends[run.end - 1] - begin));
  }
};

std::vector<std::uint32_t> colours(const std::span<const Run> runs, const VerticesOfRuns& vertices,
                                   const std::size_t n_vertices) {
  std::vector<std::uint64_t> taken(n_vertices, 0); // bits of the colours that hold a vertex
  std::vector<std::uint32_t> colours;
  std::uint32_t n_colours = 64;
  for (const Run& run : runs) {
    std::uint64_t met = 0;
    for (const std::uint32_t v : vertices[run])
      met |= v != no_vertex ? taken[v] : 0;
    // With all 64 taken, which a run's neighbours never do, a run would stand alone in a colour of its own.
    const bool is_alone = met == ~std::uint64_t(0);
    colours.push_back(is_alone ? n_colours++ : static_cast<std::uint32_t>(std::countr_one(met)));
    for (const std::uint32_t v : vertices[run])
      if (v != no_vertex && !is_alone)
        taken[v] |= std::uint64_t(1) << colours.back();
  }
  return colours;
}

/// Of runs in their order. At each vertex a run need only wait for the last one before it, which has waited too.
Precedence precedence(const std::span<const Run> runs, const VerticesOfRuns& vertices, const std::size_t n_vertices) {
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> last(n_vertices, none), is_named_by(runs.size(), none); // places in the order
  std::vector<std::uint32_t> of_run;
  Precedence all;
  for (std::uint32_t place = 0; place < runs.size(); ++place) {
    of_run.clear();
    for (const std::uint32_t v : vertices[runs[place]])
      if (v != no_vertex) {
        const std::uint32_t before = std::exchange(last[v], place);
        if (before != none && before != place && std::exchange(is_named_by[before], place) != place)
          of_run.push_back(before);
      }
    all.add(of_run);
  }
  return all;
}

} // namespace

OrderOfChunks order_of_chunks(const std::span<const std::uint32_t> chunk_ends,
                              const std::span<const std::uint32_t> vertices, const std::size_t n_vertices) {
  const VerticesOfRuns of_runs{chunk_ends, vertices};
  const std::vector<Run> in_memory = runs(chunk_ends.size());
  const std::vector<std::uint32_t> colour = colours(in_memory, of_runs, n_vertices);
  std::vector<std::uint32_t> places(in_memory.size());
  std::iota(places.begin(), places.end(), 0);
  std::ranges::stable_sort(places, {}, [&](const std::uint32_t k) { return colour[k]; });
  OrderOfChunks order;
  for (const std::uint32_t k : places)
    order.runs.push_back(in_memory[k]);
  order.shared = precedence(order.runs, of_runs, n_vertices);
  return order;
}

Batching::Batching(const CopiesInOrder& copies) {
  std::vector<std::uint32_t> corners;
  corners.reserve(8 * copies.order.size());
  for (const std::uint32_t copy : copies.order)
    for (std::size_t a = 0; a < 8; ++a)
      corners.push_back(copies.kind[copy] != Kind::unused ? copies.corners[8 * std::size_t(copy) + a] : no_vertex);
  order_ = order_of_chunks(copies.chunk_ends, corners, copies.n_corners);
  update(copies, {}, {});
}

ChangeOfBatches Batching::update(const CopiesInOrder& copies, const std::span<const std::uint8_t> is_same,
                                 const std::span<const std::uint8_t> is_met, const CornersOfSame corners) {
  const Before before{std::exchange(batches_, {}), std::exchange(chunks_, {})};
  const auto is_kept_chunk = [&](const std::size_t k) { return k < is_met.size() && is_met[k] == 0; };
  std::size_t most = 0;
  for (std::size_t k = 0; k < copies.chunk_ends.size(); ++k)
    most += is_kept_chunk(k) ? before.chunks[k].n
                             : (copies.chunk_ends[k] - (k > 0 ? copies.chunk_ends[k - 1] : 0)) / n_lanes + 2;
  batches_.reserve(most);
  std::vector<std::uint8_t> is_taken(n_places_, 0);
  ChangeOfBatches change;
  std::uint32_t begin = 0;
  for (std::size_t k = 0; k < copies.chunk_ends.size(); begin = copies.chunk_ends[k++]) {
    const Chunk was = k < before.chunks.size() ? before.chunks[k] : Chunk{};
    const auto row = static_cast<std::uint32_t>(copies.n_corners + k);
    const bool is_kept = is_kept_chunk(k);
    if (is_kept)
      keep_chunk(before, was, row);
    else
      add_chunk(copies, copies.order.subspan(begin, copies.chunk_ends[k] - begin), row);
    const Chunk& now = chunks_.back();
    for (std::uint32_t i = 0; i < now.n; ++i) {
      BatchOfCopies& batch = batches_[now.first + i];
      const bool is_full = i < now.n_full;
      const std::uint32_t first = was.first + (is_full ? 0 : was.n_full),
                          end = was.first + (is_full ? was.n_full : was.n);
      std::uint32_t at = is_kept ? was.first + i : first;
      while (at < end && !is_kept && before.batches[at].copies[0] != batch.copies[0])
        ++at;
      const bool stays = is_kept || (at < end && std::ranges::equal(batch.copies, before.batches[at].copies) &&
                                     std::all_of(batch.copies, batch.copies + batch.n_used,
                                                 [&](const std::uint32_t copy) { return is_same[copy] != 0; }));
      change.was.push_back(stays && corners == CornersOfSame::kept ? at : ChangeOfBatches::none);
      if (is_full)
        continue;
      if (stays) {
        batch.partial = before.batches[at].partial;
        is_taken[batch.partial] = 1;
      } else {
        change.renewed.push_back(now.first + i);
      }
    }
  }
  std::size_t place = 0;
  for (const std::uint32_t i : change.renewed) {
    while (place < n_places_ && is_taken[place] != 0)
      ++place;
    batches_[i].partial = static_cast<std::uint32_t>(place++);
  }
  n_places_ = std::max(n_places_, place);
  n_rows_ = copies.n_corners + chunks_.size();
  return change;
}

void Batching::add_chunk(const CopiesInOrder& copies, const std::span<const std::uint32_t> of_chunk,
                         const std::uint32_t row) {
  std::vector<std::uint32_t> full, partial;
  for (const std::uint32_t copy : of_chunk)
    if (const Kind kind = copies.kind[copy]; kind != Kind::unused)
      (kind == Kind::full ? full : partial).push_back(copy);
  const auto first = static_cast<std::uint32_t>(batches_.size());
  add_batches(full, copies.corners, row);
  const auto first_partial = static_cast<std::uint32_t>(batches_.size());
  add_batches(partial, copies.corners, row);
  chunks_.push_back({first, first_partial - first, static_cast<std::uint32_t>(batches_.size()) - first});
}

/// But for the row of lanes that are not used.
void Batching::keep_chunk(const Before& before, const Chunk& chunk, const std::uint32_t row) {
  const auto first = static_cast<std::uint32_t>(batches_.size());
  const auto begin = before.batches.begin() + chunk.first;
  batches_.insert(batches_.end(), begin, begin + chunk.n);
  for (std::uint32_t i = first; i < first + chunk.n; ++i)
    for (std::size_t lane = batches_[i].n_used; lane < n_lanes; ++lane)
      for (auto& corners : batches_[i].corners)
        corners[lane] = row;
  chunks_.push_back({first, chunk.n_full, chunk.n});
}

namespace {

/// Whether each cube but the first shares the corners of a face with the one before it along x.
bool are_row(const std::span<const std::uint32_t> copies, const std::uint32_t* const corners) {
  const auto corner = [&](const std::size_t i, const std::size_t a) { return corners[8 * std::size_t(copies[i]) + a]; };
  for (std::size_t i = 1; i < copies.size(); ++i)
    for (std::size_t a = 0; a < 8; a += 2)
      if (corner(i, a) != corner(i - 1, a + 1))
        return false;
  return true;
}

/// To the front what are whole batches of cubes side by side; else in the order in which they come.
void put_rows_first(std::vector<std::uint32_t>& copies, const std::uint32_t* const corners) {
  std::vector<std::uint32_t> others;
  std::size_t n_in_rows = 0;
  for (std::size_t i = 0; i < copies.size();)
    if (i + n_lanes <= copies.size() && are_row(std::span(copies).subspan(i, n_lanes), corners)) {
      std::copy_n(copies.begin() + static_cast<std::ptrdiff_t>(i), n_lanes,
                  copies.begin() + static_cast<std::ptrdiff_t>(n_in_rows));
      n_in_rows += n_lanes;
      i += n_lanes;
    } else {
      others.push_back(copies[i++]);
    }
  std::ranges::copy(others, copies.begin() + static_cast<std::ptrdiff_t>(n_in_rows));
}

} // namespace

/// As if of full cubes.
void Batching::add_batches(std::vector<std::uint32_t>& copies, const std::uint32_t* const corners,
                           const std::uint32_t row) {
  put_rows_first(copies, corners);
  for (std::size_t begin = 0; begin < copies.size(); begin += n_lanes) {
    BatchOfCopies& batch = batches_.emplace_back();
    batch.partial = BatchOfCopies::none;
    batch.n_used = static_cast<std::uint32_t>(std::min(n_lanes, copies.size() - begin));
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const bool is_used = lane < batch.n_used;
      const std::uint32_t copy = is_used ? copies[begin + lane] : BatchOfCopies::none;
      batch.copies[lane] = copy;
      for (std::size_t a = 0; a < 8; ++a)
        batch.corners[a][lane] = is_used ? corners[8 * std::size_t(copy) + a] : row;
    }
    batch.is_row = batch.n_used == n_lanes && are_row({batch.copies, n_lanes}, corners);
  }
}

namespace {

template <class T>
CubeConstants<T> constants(const double h, const material::Elastic& material, const Element& full) {
  CubeConstants<T> cube{T(h), T(material.lambda()), T(material.mu()), T(full.volume), {}};
  std::copy(full.hourglass.begin(), full.hourglass.end(), cube.hourglass);
  return cube;
}

double weight_in_diagonal(const Element& element, const PartialElements& partial) {
  const double whole = std::max(1.0, element.bound / partial.bound);
  return partial.in_diagonal == InDiagonal::all ? whole : whole - 1;
}

template <class T>
void put(const Element& element, const double weight, const std::size_t lane, PartialCubes<T>& cubes,
         HourglassOfCubes& hourglass) {
  cubes.volume[lane] = T(element.volume);
  cubes.weight[lane] = T(weight);
  for (int i = 0; i < n_hourglass; ++i)
    cubes.gradient[i][lane] = T(element.mode_gradient[i / 3][i % 3]);
  for (int i = 0; i < n_hourglass_pairs; ++i)
    hourglass.pair[i][lane] = element.hourglass[i];
}

} // namespace

template <class T>
BatchedElements<T> batched(const Batching& batching, const double h, const material::Elastic& material,
                           const Element& full, const PartialElements& partial, const SharedParts& shared) {
  BatchedElements<T> all{constants<T>(h, material, full), {}, shared, {}};
  const bool have_rotations = !shared.rotations->empty();
  std::vector<std::uint32_t> all_partial;
  for (std::uint32_t i = 0; i < batching.batches().size(); ++i)
    if (batching.batches()[i].partial != BatchOfCopies::none)
      all_partial.push_back(i);
  follow(batching, all_partial, partial, all);
  if (!have_rotations)
    for (Lanes9& rotations : *shared.rotations)
      for (int k = 0; k < 3; ++k)
        std::fill_n(rotations.row[4 * k], n_lanes, 1.0f);
  return all;
}

template <class T>
void follow(const Batching& batching, const std::span<const std::uint32_t> renewed, const PartialElements& partial,
            BatchedElements<T>& elements) {
  grow(elements.partial, batching.n_places());
  grow(*elements.shared.hourglass, batching.n_places());
  grow(*elements.shared.rotations, batching.batches().size());
  parallel_for(
    renewed.size(),
    [&](const std::size_t i) {
      const BatchOfCopies& batch = batching.batches()[renewed[i]];
      PartialCubes<T>& cubes = elements.partial[batch.partial];
      HourglassOfCubes& hourglass = (*elements.shared.hourglass)[batch.partial];
      cubes = {};
      hourglass = {};
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        if (batch.copies[lane] != BatchOfCopies::none) {
          const Element& element = partial.of(batch.copies[lane]);
          put(element, weight_in_diagonal(element, partial), lane, cubes, hourglass);
        }
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

void add_excess_diagonal(const Batching& batching, const BatchedElements<float>& elements, Row<float>* const blocks) {
  const auto diagonal = element_kernels<float>().diagonal;
  batching.for_each_in_order([&](const std::size_t i) {
    const Batch<float> batch = elements.batch(batching, i);
    if (batch.partial && std::any_of(batch.partial->weight, batch.partial->weight + batch.n_used,
                                     [](const float weight) { return weight > 0; }))
      diagonal(elements.cube, batch, blocks);
  });
}

template BatchedElements<double> batched(const Batching&, double, const material::Elastic&, const Element&,
                                         const PartialElements&, const SharedParts&);
template BatchedElements<float> batched(const Batching&, double, const material::Elastic&, const Element&,
                                        const PartialElements&, const SharedParts&);
template void follow(const Batching&, std::span<const std::uint32_t>, const PartialElements&, BatchedElements<double>&);
template void follow(const Batching&, std::span<const std::uint32_t>, const PartialElements&, BatchedElements<float>&);
template void add_product(const Batching&, const BatchedElements<double>&, const Row<double>*, Row<double>*);
template void add_product(const Batching&, const BatchedElements<float>&, const Row<float>*, Row<float>*);
template void add_diagonal(const Batching&, const BatchedElements<double>&, Row<double>*);
template void add_diagonal(const Batching&, const BatchedElements<float>&, Row<float>*);

} // namespace kerf::fem
