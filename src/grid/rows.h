#pragma once

/// Sets of lattice points as runs along x, and tables that know the neighbours of each point by its number.
///
/// Notation: a row is all points with the same y and z. Points are numbered by z, then y, then x, so those of a run
/// have numbers that follow each other, and so have their neighbours of one kind (of the cells of a run, the lowest
/// nodes).
/// What is stored of a run is the first number and its neighbours' first numbers; a run ends where a neighbour begins
/// or ceases to exist. Time and memory grow with the number of runs: like the body's surface, not like its volume.

#include "base/vec.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace kerf::grid {

/// Points of a row from x = first to x = last, both included.
struct Run {
  int first = 0, last = 0;
};

/// Coordinates take so many bits, so that three fit into one number that orders points by z, y, x.
constexpr int coordinate_bits = 20;
constexpr int max_coordinate = (1 << coordinate_bits) - 1;

using Key = std::int64_t; ///< signed, for moves
constexpr Key pack(const int x, const int y, const int z) {
  return x + (Key(y) << coordinate_bits) + (Key(z) << (2 * coordinate_bits));
}
constexpr Key pack(const Index3& i) { return pack(i[0], i[1], i[2]); }

constexpr Index3 unpack(const Key key) {
  return {static_cast<int>(key & max_coordinate), static_cast<int>(key >> coordinate_bits & max_coordinate),
          static_cast<int>(key >> (2 * coordinate_bits))};
}

class RowSet {
 public:
  /// Runs come by row, then by x. One that meets or overlaps the one before it is joined to it.
  void push_back(Key row, const Run& run);
  /// Makes room for so many in all.
  void reserve(std::size_t n_rows, std::size_t n_runs);

  std::size_t n_runs() const { return runs_.size(); }
  std::size_t n_rows() const { return rows_.size(); }
  /// Packed, with x = 0.
  Key row(const std::size_t r) const { return rows_[r]; }
  /// The runs of row r: first_run(r) .. first_run(r + 1) - 1.
  std::size_t first_run(const std::size_t r) const { return r < start_.size() ? start_[r] : runs_.size(); }
  const Run& run(const std::size_t i) const { return runs_[i]; }
  /// The number of run i's first point.
  std::uint32_t number(const std::size_t i) const { return number_[i]; }
  std::uint32_t n_points() const { return n_points_; }

 private:
  std::vector<Key> rows_;
  std::vector<std::uint32_t> start_;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> number_;
  std::uint32_t n_points_ = 0;
};

/// All p + d with p in the set and lower <= d <= upper; the coordinates of lower are -1 or 0, those of upper 0 or 1,
/// upper - lower is at most 1.
RowSet dilate(const RowSet& points, const Index3& lower, const Index3& upper);

/// A kind of neighbour: of point p, the point p + move of a set.
struct Neighbour {
  const RowSet* set;
  Index3 move;
  std::uint32_t first = 0; ///< added to the number in the set
};

constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();

/// What RunTable holds, for any number of kinds.
struct Runs {
  std::vector<std::uint32_t> first = {0}; ///< the first number of each run; the last entry is where all end
  std::vector<std::uint32_t> neighbours;  ///< of each run's first point, kind by kind; no_point where there is none

  /// Appends a set, whose points are numbered on from the last.
  void append(const RowSet& points, std::span<const Neighbour> kinds);
};

/// The neighbours of points, of n kinds.
template <std::size_t n>
class RunTable {
 public:
  void append(const RowSet& points, const std::array<Neighbour, n>& kinds) { runs_.append(points, kinds); }
  /// After the last append().
  void finish() {
    runs_.first.shrink_to_fit();
    runs_.neighbours.shrink_to_fit();
    run_of_block_.reserve(size() / block + 1);
    for (std::uint32_t run = 0; run < n_runs(); ++run)
      while (run_of_block_.size() * block < end(run))
        run_of_block_.push_back(run);
  }

  std::uint32_t size() const { return runs_.first.back(); }
  std::uint32_t n_runs() const { return static_cast<std::uint32_t>(runs_.first.size() - 1); }
  std::uint32_t begin(const std::uint32_t run) const { return runs_.first[run]; }
  std::uint32_t end(const std::uint32_t run) const { return runs_.first[run + 1]; }

  /// The run of point i.
  std::uint32_t run_of(const std::uint32_t i) const {
    std::uint32_t run = run_of_block_[i / block];
    while (end(run) <= i)
      ++run;
    return run;
  }

  /// The neighbours of a point; those of a kind that some points lack through at(i, kind).
  class Neighbours {
   public:
    Neighbours(const std::uint32_t* const of_first, const std::uint32_t along) : of_first_(of_first), along_(along) {}
    std::uint32_t operator[](const std::size_t kind) const { return of_first_[kind] + along_; }

   private:
    const std::uint32_t* of_first_;
    std::uint32_t along_; // places after the run's first point
  };
  Neighbours of(const std::uint32_t i) const {
    const std::uint32_t run = run_of(i);
    return {&runs_.neighbours[n * run], i - begin(run)};
  }

  std::uint32_t at(const std::uint32_t i, const std::size_t kind) const { return at(i, kind, run_of(i)); }
  std::uint32_t at(const std::uint32_t i, const std::size_t kind, const std::uint32_t run) const {
    const std::uint32_t of_first = runs_.neighbours[n * run + kind];
    return of_first == no_point ? no_point : of_first + (i - begin(run));
  }

  std::size_t n_bytes() const {
    return sizeof(std::uint32_t) * (runs_.first.capacity() + runs_.neighbours.capacity() + run_of_block_.capacity());
  }

 private:
  static constexpr std::uint32_t block = 16;

  Runs runs_;
  std::vector<std::uint32_t> run_of_block_; // of each 16th point
};

} // namespace kerf::grid
