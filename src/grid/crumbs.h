#pragma once

/// Pieces in which no copy holds enough material to be deformed: what a blade's dust is made of, and thin parts of a
/// body that the grid takes for pieces of their own. Every physics moves them as rigid bodies (physics/crumbs.h).
///
/// A copy is *loose* when its material fills less than a quarter of its cube, or holds one node at most. A **crumb** is
/// a piece of loose copies alone; or one that a cut has left, and whose nodes are all vertices of one cube: of such a
/// piece the grid knows hardly more than one deformation gradient, and spends up to 27 copies on it. What a cut leaves
/// of a crumb stays one. A piece that a cut has left is one too where the physics knows the body by *samples*, points
/// of its own, and those of the piece span no volume: their second moment about their mean is less than h^2 / 2 along
/// some direction, that of two which stand half a cube off a plane. What they do tells no deformation gradient, or one
/// that few of them tell (a piece of seven lost 44 % of its volume with h^2 / 8). Where copies are joined (complex.h),
/// and not all of a piece comes from one crumb, it is looked at as if it had been none: crumbs become material again.
///
/// Found by walking from the copies that a cut has changed, over glued faces, for as long as it may be a crumb: what it
/// costs depends on the cut alone, but for four bytes a copy.

#include "base/archive.h"
#include "base/id.h"
#include "base/vec.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace kerf::grid {

struct Solid;
struct Copy;
struct CutChange;
using CopyId = Id<struct CopyTag>;
using CornerId = Id<struct CornerTag>;

/// Part of its cube from which on a copy holds its corners by itself [1].
constexpr double well_filled = 0.25;

struct Crumb {
  std::uint32_t name;         ///< from 1 on, of its own for as long as no cut meets it
  std::vector<CopyId> copies; ///< ascending

  void archive(Archive& a) { a(name, copies); }
};

/// None, until somebody looks for them.
struct Crumbs {
  static constexpr std::uint32_t none = 0, lapsed = 0xffffffff;
  std::vector<Crumb> all;             ///< by ascending name
  std::vector<std::uint32_t> of_copy; ///< name of its crumb; or lapsed (complex.h): no physics deforms either
  std::vector<std::uint8_t> of_corner;
  std::uint32_t n_named = 0;

  void archive(Archive& a) { a(all, of_copy, of_corner, n_named); }
  bool any() const { return !all.empty(); }
  std::uint32_t of(const CopyId c) const { return c.value < of_copy.size() ? of_copy[c.value] : none; }
  bool holds(const CopyId c) const { return of(c) != none; }
  bool holds(const CornerId c) const { return c.value < of_corner.size() && of_corner[c.value] != 0; }
  void set(const CopyId c, const std::uint32_t crumb) {
    if (crumb != of(c)) {
      of_copy.resize(std::max<std::size_t>(of_copy.size(), c.value + 1), none);
      of_copy[c.value] = crumb;
    }
  }
};

/// Looks at the whole body, before any cut.
void find_crumbs(Solid& solid);

/// Follows a cut whose vertices are placed. Copies that are in a crumb now, and were not, and the reverse, join
/// change.reshaped. `samples`: where they rest [m]; null where the physics has none.
void update_crumbs(Solid& solid, CutChange& change, const Points* samples = nullptr);

} // namespace kerf::grid
