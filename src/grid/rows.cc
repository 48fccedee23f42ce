#include "grid/rows.h"

namespace kerf::grid {

namespace {

/// Goes up through the rows of a set that is moved.
class Cursor {
 public:
  Cursor(const RowSet& set, const Index3& move) : set_(&set), move_x_(move[0]), row_shift_(pack(0, move[1], move[2])) {}

  bool at_end() const { return row_ == set_->n_rows(); }
  Key row() const { return set_->row(row_) + row_shift_; }
  /// Enters the row; without runs when the set has none there. Rows come in ascending order.
  void enter(const Key row) {
    while (!at_end() && this->row() < row)
      ++row_;
    const bool found = !at_end() && this->row() == row;
    run_ = found ? set_->first_run(row_) : 0;
    end_ = found ? set_->first_run(row_ + 1) : 0;
  }

  bool has_run() const { return run_ != end_; }
  int first() const { return set_->run(run_).first + move_x_; }
  int last() const { return set_->run(run_).last + move_x_; }
  void next_run() { ++run_; }
  /// The number of the set's point that is at x, which lies in the run.
  std::uint32_t number_at(const int x) const { return set_->number(run_) + static_cast<std::uint32_t>(x - first()); }

 private:
  const RowSet* set_;
  int move_x_;
  Key row_shift_;
  std::size_t row_ = 0, run_ = 0, end_ = 0;
};

/// For n more, and for as many again where what is there must move.
void make_room(std::vector<std::uint32_t>& numbers, const std::size_t n) {
  if (numbers.capacity() < numbers.size() + n)
    numbers.reserve(std::max(numbers.size() + n, 2 * numbers.capacity()));
}

} // namespace

void RowSet::reserve(const std::size_t n_rows, const std::size_t n_runs) {
  rows_.reserve(n_rows);
  start_.reserve(n_rows);
  runs_.reserve(n_runs);
  number_.reserve(n_runs);
}

void RowSet::push_back(const Key row, const Run& run) {
  if (rows_.empty() || rows_.back() != row) {
    rows_.push_back(row);
    start_.push_back(static_cast<std::uint32_t>(runs_.size()));
  } else if (run.first <= runs_.back().last + 1) {
    const int last = std::max(runs_.back().last, run.last);
    n_points_ += static_cast<std::uint32_t>(last - runs_.back().last);
    runs_.back().last = last;
    return;
  }
  runs_.push_back(run);
  number_.push_back(n_points_);
  n_points_ += static_cast<std::uint32_t>(run.last - run.first + 1);
}

RowSet dilate(const RowSet& points, const Index3& lower, const Index3& upper) {
  std::vector<Cursor> cursors;
  for (int z = lower[2]; z <= upper[2]; ++z)
    for (int y = lower[1]; y <= upper[1]; ++y)
      cursors.emplace_back(points, Index3{0, y, z});
  RowSet result;
  result.reserve(points.n_rows() + points.n_rows() / 4, points.n_runs() + points.n_runs() / 4);
  constexpr Key none = std::numeric_limits<Key>::max();
  for (;;) {
    Key row = none;
    for (const Cursor& cursor : cursors)
      if (!cursor.at_end())
        row = std::min(row, cursor.row());
    if (row == none)
      return result;
    for (Cursor& cursor : cursors)
      cursor.enter(row);
    for (;;) { // all runs of the moved rows, by x
      Cursor* lowest = nullptr;
      for (Cursor& cursor : cursors)
        if (cursor.has_run() && (lowest == nullptr || cursor.first() < lowest->first()))
          lowest = &cursor;
      if (lowest == nullptr)
        break;
      result.push_back(row, {lowest->first() + lower[0], lowest->last() + upper[0]});
      lowest->next_run();
    }
    for (Cursor& cursor : cursors)
      cursor.enter(row + 1);
  }
}

void Runs::append(const RowSet& points, const std::span<const Neighbour> kinds) {
  const std::size_t n_guess = 3 * points.n_runs(); // some runs break
  make_room(first, n_guess);
  make_room(neighbours, n_guess * kinds.size());
  std::vector<Cursor> cursors;
  for (const Neighbour& kind : kinds)
    cursors.emplace_back(*kind.set, Index3{-kind.move[0], -kind.move[1], -kind.move[2]});
  for (std::size_t r = 0; r < points.n_rows(); ++r) {
    for (Cursor& cursor : cursors)
      cursor.enter(points.row(r));
    for (std::size_t i = points.first_run(r); i < points.first_run(r + 1); ++i)
      for (int x = points.run(i).first, last; x <= points.run(i).last; x = last + 1) {
        last = points.run(i).last;
        for (std::size_t k = 0; k < kinds.size(); ++k) {
          Cursor& cursor = cursors[k];
          while (cursor.has_run() && cursor.last() < x)
            cursor.next_run();
          const bool is_there = cursor.has_run() && cursor.first() <= x;
          neighbours.push_back(is_there ? kinds[k].first + cursor.number_at(x) : no_point);
          if (cursor.has_run())
            last = std::min(last, is_there ? cursor.last() : cursor.first() - 1);
        }
        first.push_back(first.back() + static_cast<std::uint32_t>(last - x + 1));
      }
  }
}

} // namespace kerf::grid
