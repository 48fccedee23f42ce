#pragma once

/// Where blades stand, and which cells they have left: what of a cell is settled (cutter.h).

#include "cut/near_sweep.h"
#include "grid/solid.h"

#include <set>
#include <span>
#include <vector>

namespace kerf::cut {

/// A blade's cutting edge where it stands after a step, and where it stood before, world frame [m].
struct StandingEdge {
  grid::CutLabel label = 1;
  Points line = {}, before = {};

  bool rests() const { return line == before; }
  void archive(Archive& a) { a(label, line, before); }
};

/// A cell that a blade has cut, and then left, or come to rest in.
struct LeftCell {
  grid::CellId cell;
  grid::CutLabel label = 1;

  friend bool operator<(const LeftCell& a, const LeftCell& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.label < b.label;
  }
  void archive(Archive& a) { a(cell, label); }
};

/// Of a line that stands still.
NearSweep near_sweep(const Points& line);

/// May it be in one of the cell's copies, with the corners at x, or nearer than `room` [m]?
bool is_near(const NearSweep& near, const grid::Solid& solid, grid::CellId c, const Points& x, double room);

/// Where blades are that come on: those that have moved, or are `coming`.
class Passage {
 public:
  Passage(std::span<const StandingEdge> edges, const std::set<grid::CutLabel>& coming);

  /// What blades that are in a cell or beside it, and have not left it before, have cut there, if others have cut it
  /// too. Which have left it is noted.
  grid::Segments cuts_in(const grid::Solid& solid, grid::CellId c, const Points& x, std::size_t n_labels,
                         std::set<LeftCell>& left) const;

 private:
  bool holds(grid::CutLabel label, const grid::Solid& solid, grid::CellId c, const Points& x) const;

  struct Edge {
    grid::CutLabel label;
    NearSweep near;
  };
  std::vector<Edge> edges_;
};

} // namespace kerf::cut
