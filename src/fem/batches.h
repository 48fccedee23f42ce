#pragma once

/// Elements in batches for the kernels: which copies go through them together, and what they are made of.
///
/// Copies go in the order of their cells, so that what lies side by side is read together, in chunks of some hundred:
/// first a chunk's full cubes, then its partial ones, each in batches of 16. Chunks that share a corner have different
/// colours. One colour after the other, and a chunk's batches in their order, is the order of all sums: the same for
/// any number of threads, as it depends on the copies and their corners alone.

#include "base/parallel.h"
#include "fem/element.h"

#include <functional>
#include <span>
#include <vector>

namespace kerf::fem {

/// What is made of a copy.
enum class Kind : std::uint8_t {
  unused, ///< nothing
  full,   ///< a full cube
  partial ///< a cube that material fills in part, or that several are
};

struct BatchOfCopies {
  static constexpr std::uint32_t none = 0xffffffff;
  alignas(64) std::uint32_t corners[8][n_lanes];
  std::uint32_t copies[n_lanes]; ///< `none` in lanes that are not used
  std::uint32_t partial;         ///< which of the partial batches; `none` for full cubes
};

class Batching {
 public:
  /// `order`: all copies, side by side what is near; `corners`: 8 a copy.
  Batching(std::span<const std::uint32_t> order, const std::function<Kind(std::uint32_t copy)>& kind,
           const std::uint32_t* corners, std::size_t n_corners);
  Batching() = default;

  std::span<const BatchOfCopies> batches() const { return batches_; }
  std::size_t n_partial_batches() const { return n_partial_; }
  /// Rows of corners that kernels read and write: after the corners one for each chunk, for lanes that are not used.
  std::size_t n_rows() const { return n_rows_; }

  /// Calls f(i) for each batch, several at a time; for what adds nothing to corners.
  template <class Function>
  void for_each(const Function& f) const {
    parallel_for(batches_.size(), f, worth_);
  }
  /// Calls f(i) for each batch; those that share a corner never at once, and in the order of sums.
  template <class Function>
  void for_each_in_order(const Function& f) const {
    for (const std::vector<Chunk>& chunks : colours_)
      parallel_for(chunks.size(), [&](const std::size_t c) {
        for (std::uint32_t i = chunks[c].first; i < chunks[c].first + chunks[c].n; ++i)
          f(i);
      });
  }

 private:
  static constexpr std::size_t worth_ = 32; // batches from which on a second thread pays
  struct Chunk {
    std::uint32_t first, n;
  };

  void add_batches(std::span<const std::uint32_t> copies, Kind kind, const std::uint32_t* corners, std::uint32_t row);
  void colour(std::span<const Chunk> chunks, std::size_t n_corners);

  std::vector<BatchOfCopies> batches_;
  std::vector<std::vector<Chunk>> colours_;
  std::size_t n_partial_ = 0, n_rows_ = 0;
};

template <class T>
struct alignas(64) Lanes9 {
  T row[9][n_lanes];
};
template <class T>
struct alignas(64) LanesOfTangent {
  T row[n_tangent_pairs][n_lanes];
};

/// What elements are made of, in numbers T.
template <class T>
struct BatchedElements {
  CubeConstants<T> cube;
  std::vector<PartialCubes<T>> partial;    // by BatchOfCopies::partial
  std::vector<Lanes9<T>> rotations;        // by batch
  std::vector<LanesOfTangent<T>> tangents; // by batch; none where the law is Hooke's

  Batch<T> batch(const Batching& batching, const std::size_t i) const {
    const BatchOfCopies& b = batching.batches()[i];
    return {b.corners, rotations[i].row, b.partial == BatchOfCopies::none ? nullptr : &partial[b.partial],
            tangents.empty() ? nullptr : tangents[i].row};
  }
};

/// `element(copy)`: of a partial one. All rotations are the identity.
template <class T>
BatchedElements<T> batched(const Batching& batching, double h, const material::Elastic& material, const Element& full,
                           const std::function<const Element&(std::uint32_t copy)>& element);

/// y += K p.
template <class T>
void add_product(const Batching& batching, const BatchedElements<T>& elements, const Row<T>* p, Row<T>* y);
/// Adds diagonal blocks, two rows a corner (kernels.h).
template <class T>
void add_diagonal(const Batching& batching, const BatchedElements<T>& elements, Row<T>* blocks);

} // namespace kerf::fem
