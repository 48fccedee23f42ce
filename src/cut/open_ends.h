#pragma once

/// Faces of the skin in which a blade's cut has come in and not gone out: the cut may go on there in the next step,
/// and until then the skin holds together what lies below it. Once the blade has gone, or rests, the cut ends at the
/// skin, which is parted: where the blade passes between the edges of the grid, no bridge stays that no edge stands
/// for.

#include "grid/complex.h"

#include <span>
#include <vector>

namespace kerf::cut {

class OpenEnds {
 public:
  /// Notes such faces at edges that the blade with this label has cut.
  void note(const grid::Grid& grid, const grid::Cuts& cuts, std::span<const grid::EdgeId> edges, grid::CutLabel label);

  /// Parts the skin of the faces that are more than a cell away from what the blade sweeps in this step (triangles
  /// [m], world frame), when the corners are at `x`; forgets those where the cut has gone on. Returns cut edges at the
  /// parted faces.
  std::vector<grid::EdgeId> close(std::span<const std::array<Vec3, 3>> strip, const grid::Grid& grid, grid::Cuts& cuts,
                                  const grid::CellComplex& complex, const Points& x, grid::CutLabel label);

  std::size_t size() const { return faces_.size(); }

 private:
  struct Face {
    grid::CellId cell;
    int face;
    auto operator<=>(const Face&) const = default;
  };
  std::vector<Face> faces_; // ascending
};

} // namespace kerf::cut
