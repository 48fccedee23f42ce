#pragma once

/// Elements in batches for the kernels: which copies go through them together, and what they are made of.
///
/// Copies go in chunks, those of some hundred cells that lie in a block each: first a chunk's full cubes, then its
/// partial ones, each in batches of 16, of which the first are rows of cubes along x. In large bodies a few chunks side
/// by side make a run, which one thread takes in a go: it finds corners between them in its cache, and goes on along
/// the rows of corners in memory. Runs that share a corner have different colours. One colour after the other, a run's
/// chunks and a chunk's batches in their order, is the order of all sums: the same for any number of threads, as it
/// depends on the copies and their corners alone. A run waits for those that come before it and share a corner with it,
/// and for no others.
///
/// A cut changes the batches of the chunks that it meets, and all others stay as they are, with what their partial
/// cubes are made of. Chunks of cells share what nodes of the grid they share, which no cut changes.

#include "base/parallel.h"
#include "fem/element.h"

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
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
  std::uint32_t n_used;          ///< lanes, the first ones
  std::uint32_t partial;         ///< the place of what its cubes are made of; `none` for full ones
  bool is_row;                   ///< Batch::is_row
};

/// All copies, side by side what is near.
struct CopiesInOrder {
  std::span<const std::uint32_t> order; ///< those of chunks that a cut has not met need not be there
  std::span<const std::uint32_t> chunk_ends; ///< in `order`, ascending
  std::span<const Kind> kind;                ///< of each copy
  const std::uint32_t* corners;              ///< 8 a copy
  std::size_t n_corners;
};

/// Chunks one after the other.
struct Run {
  std::uint32_t first, end;
};

/// An order of chunks in which runs that share a vertex are far from each other, and several can be worked on.
struct OrderOfChunks {
  std::vector<Run> runs;
  Precedence shared; ///< of places in `runs`: what comes after what it shares a vertex with
};

/// Of chunks of cubes, given by their 8 vertices: by colours of runs, of which each has the first that no run before it
/// has that shares a vertex. Cubes without use have the vertex `no_vertex`.
OrderOfChunks order_of_chunks(std::span<const std::uint32_t> chunk_ends, std::span<const std::uint32_t> vertices,
                              std::size_t n_vertices);
constexpr std::uint32_t no_vertex = 0xffffffff;

/// Do copies that are the same have the corners of the same numbers?
enum class CornersOfSame { kept, renumbered };

/// What an update has done.
struct ChangeOfBatches {
  static constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> renewed; ///< batches of partial cubes of which one is not what it was, or was elsewhere
  std::vector<std::uint32_t> was;     ///< of each batch the one that had just its copies, which are the same, and their
                                      ///< corners; `none` where there was none
};

class Batching {
 public:
  static constexpr std::size_t chunk_size = 512; ///< cells

  /// In an order by the copies' corners.
  explicit Batching(const CopiesInOrder& copies);
  /// Without copies as yet. Chunks whose copies share a corner must share a vertex of the order, after any update.
  explicit Batching(OrderOfChunks order) : order_(std::move(order)) {}
  Batching() = default;

  /// Takes over copies after a cut; is_same: of each, whether it is in the cell that it was in, with the material that
  /// it had. `is_met`: 0 for each chunk that has just the copies that it had, all of them the same, with corners of the
  /// same numbers.
  ChangeOfBatches update(const CopiesInOrder& copies, std::span<const std::uint8_t> is_same,
                         std::span<const std::uint8_t> is_met, CornersOfSame corners = CornersOfSame::kept);

  std::span<const BatchOfCopies> batches() const { return batches_; }
  /// Places for what partial cubes are made of, some of them empty.
  std::size_t n_places() const { return n_places_; }
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
    parallel_in_order(order_.shared, [&](const std::size_t place) {
      const Run& run = order_.runs[place];
      const Chunk& last = chunks_[run.end - 1];
      for (std::uint32_t i = chunks_[run.first].first; i < last.first + last.n; ++i)
        f(i);
    });
  }

 private:
  static constexpr std::size_t worth_ = 256; // batches from which on a second thread pays
  struct Chunk {
    std::uint32_t first, n_full, n; // batches: full ones come first
  };
  struct Before {
    std::vector<BatchOfCopies> batches;
    std::vector<Chunk> chunks;
  };

  void add_batches(std::vector<std::uint32_t>& copies, const std::uint32_t* corners, std::uint32_t row);
  void add_chunk(const CopiesInOrder& copies, std::span<const std::uint32_t> of_chunk, std::uint32_t row);
  void keep_chunk(const Before& before, const Chunk& chunk, std::uint32_t row);

  OrderOfChunks order_;
  std::vector<BatchOfCopies> batches_;
  std::vector<Chunk> chunks_;
  std::size_t n_places_ = 0, n_rows_ = 0;
};

struct alignas(64) Lanes9 {
  float row[9][n_lanes];
};
template <class T>
struct alignas(64) LanesOfTangent {
  T row[n_tangent_pairs][n_lanes];
};

/// What is kept once, in single precision, for elements in either: R K R^T is symmetric and positive for any R.
struct SharedParts {
  std::shared_ptr<std::vector<HourglassOfCubes>> hourglass =
    std::make_shared<std::vector<HourglassOfCubes>>(); ///< by BatchOfCopies::partial
  std::shared_ptr<std::vector<Lanes9>> rotations = std::make_shared<std::vector<Lanes9>>(); ///< by batch
};

/// What elements are made of, in numbers T.
template <class T>
struct BatchedElements {
  CubeConstants<T> cube;
  std::vector<PartialCubes<T>> partial;    // by BatchOfCopies::partial
  SharedParts shared;
  std::vector<LanesOfTangent<T>> tangents; // by batch; none where the law is Hooke's

  Batch<T> batch(const Batching& batching, const std::size_t i) const {
    const BatchOfCopies& b = batching.batches()[i];
    const bool is_full = b.partial == BatchOfCopies::none;
    return {b.corners, (*shared.rotations)[i].row, is_full ? nullptr : &partial[b.partial],
            is_full ? nullptr : &(*shared.hourglass)[b.partial], tangents.empty() ? nullptr : tangents[i].row,
            b.n_used, b.is_row};
  }
};

/// What add_diagonal() adds of an element: its diagonal, times its own bound over PartialElements::bound where that is
/// more than 1; or only what is beyond the diagonal, for those who have that already.
enum class InDiagonal { all, excess };

/// Of partial copies.
struct PartialElements {
  std::function<const Element&(std::uint32_t copy)> of;
  /// The diagonal counts elements whose own bound (jacobi_bound) is more than this by as much more [1].
  double bound = std::numeric_limits<double>::infinity();
  InDiagonal in_diagonal = InDiagonal::all;
};
/// All rotations are the identity, unless other elements have them already.
template <class T>
BatchedElements<T> batched(const Batching& batching, double h, const material::Elastic& material, const Element& full,
                           const PartialElements& partial, const SharedParts& shared = {});
/// After a cut: `renewed` is what Batching::update() says. Rotations are lost.
template <class T>
void follow(const Batching& batching, std::span<const std::uint32_t> renewed, const PartialElements& partial,
            BatchedElements<T>& elements);

/// y += K p.
template <class T>
void add_product(const Batching& batching, const BatchedElements<T>& elements, const Row<T>* p, Row<T>* y);
/// Adds diagonal blocks, two rows a corner (kernels.h).
template <class T>
void add_diagonal(const Batching& batching, const BatchedElements<T>& elements, Row<T>* blocks);
/// Of elements that were batched with InDiagonal::excess.
void add_excess_diagonal(const Batching& batching, const BatchedElements<float>& elements, Row<float>* blocks);

} // namespace kerf::fem
