#pragma once

/// How far moving blades have come in cells that they have not parted: the fronts that they leave (grid/fronts.h).
///
/// The first piece of a strip that a blade sweeps in a cell gives the plane in which the cell would be parted. All that it
/// sweeps there from then on is drawn onto a raster in that plane, in the frame of the cell at rest, where a point that
/// is passed twice counts once; what leaves the plane by a quarter of a cube does not count. As elements are too stiff at
/// a front, what is drawn is taken larger by the lag of fronts, and so reaches on into the next cells. The part of the
/// section of plane and material that it covers is how far the cut has come. Where it is the lag alone that reaches into
/// a cell, the blade has to be in the material of one beside it.
///
/// Cells in which cuts wait (pending.h) get no front before they are cut.
///
/// Errors: a texel is .04 cubes wide; within a cell the map of its copy is taken as affine. A blade that turns leaves
/// the fronts that it had.

#include "cut/edge_boxes.h"
#include "cut/near_sweep.h"
#include "cut/pending.h"

#include <map>
#include <optional>
#include <set>

namespace kerf::cut {

/// Bits over a square around a point of a plane.
class Raster {
 public:
  static constexpr int n = 64;
  static constexpr double side = 2.5; ///< in cubes; more than a cube's space diagonal and twice the lag

  /// Sets the texels whose middles lie in a triangle, where the third coordinate is at most `most` away from 0; of
  /// coordinates in cubes, from the middle.
  void draw(const std::array<Vec3, 3>& triangle, double most);
  /// All texels within a distance of set ones.
  Raster grown(double distance) const;
  int count() const;
  bool any() const { return count() > 0; }
  friend Raster operator&(Raster a, const Raster& b);

  void archive(Archive& a) { a(rows_); }

 private:
  std::array<std::uint64_t, n> rows_{};
};

class Advance {
 public:
  /// What a blade sweeps while the corners go from x_before to x [m], to which `boxes` are fitted.
  void sweep(const BladePath& path, const grid::Solid& solid, const Points& x_before, const Points& x,
             const EdgeBoxes& boxes, grid::CutLabel label);

  /// The fronts that have begun or moved on since it was asked last, ascending; where nothing is left to part, cells are
  /// forgotten. To be asked when what the blades have met is cut.
  std::vector<grid::Front> take(const grid::Solid& solid, const PendingCuts& pending);

  void archive(Archive& a) { a(cells_, touched_); }

 private:
  struct Cell {
    Vec3 point, normal; ///< of the plane, rest frame [m]
    Raster section, swept;
    grid::CutLabel label;

    void archive(Archive& a) { a(point, normal, section, swept, label); }
  };
  void draw(const grid::Solid& solid, grid::CellId c, const Patch& quad, grid::CutLabel label);
  static std::optional<Cell> begin(const grid::Solid& solid, grid::CellId c, const Patch& quad, grid::CutLabel label);
  std::optional<grid::Front> front_in(const grid::Solid& solid, grid::CellId c) const;
  bool is_in_material(const grid::Solid& solid, grid::CellId c) const;

  std::map<grid::CellId, Cell> cells_;
  std::set<grid::CellId> touched_; // in which blades have swept since fronts were taken
};

} // namespace kerf::cut
