#pragma once

/// Faces of the skin in which a blade's cut has come in and not gone out, and cells in which the skin joins nodes that
/// it has parted (nodes_apart.h): the cut may go on there in the next step, and until then the skin holds together what
/// lies below it. Once the blade has gone, the cut ends at the skin, which is parted: where the blade passes between
/// the edges of the grid, no bridge stays that no edge stands for.

#include "cut/pending.h"
#include "grid/solid.h"

#include <span>
#include <vector>

namespace kerf::cut {

class OpenEnds {
 public:
  /// Notes them in cells in which the blade with this label has cut.
  void note(const grid::Solid& solid, std::span<const grid::CellId> cells, grid::CutLabel label);

  /// Parts the skin of those that are more than a cell away from where the blade is in this step (whereabouts();
  /// triangles [m], world frame), when the corners are at `x`, and from cuts that wait; forgets those where the cut has
  /// gone on. Returns cut edges at the parted faces.
  std::vector<grid::EdgeId> close(std::span<const std::array<Vec3, 3>> blade, const PendingCuts& pending,
                                  grid::Solid& solid, const Points& x, grid::CutLabel label);

  std::size_t size() const { return faces_.size() + cells_.size(); }
  void archive(Archive& a) { a(faces_, cells_); }

 private:
  struct Face {
    grid::CellId cell;
    int face;
    auto operator<=>(const Face&) const = default;
    void archive(Archive& a) { a(cell, face); }
  };
  std::vector<Face> faces_;         // ascending
  std::vector<grid::CellId> cells_; // ascending
};

} // namespace kerf::cut
