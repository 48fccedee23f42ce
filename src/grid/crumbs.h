#pragma once

/// Pieces in which no copy holds enough material to be deformed: what a blade's dust is made of, and thin parts of a
/// body that the grid takes for pieces of their own. Every physics moves them as rigid bodies (physics/crumbs.h).
///
/// A copy is *loose* when its material fills less than a quarter of its cube, or holds one node at most. A **crumb** is a
/// piece of loose copies alone; or one that a cut has left, and whose nodes are all vertices of one cube: of such a
/// piece the grid knows hardly more than one deformation gradient, and spends up to 27 copies on it. What a cut leaves
/// of a crumb stays one.
///
/// Found by walking from the copies that a cut has changed, over glued faces, for as long as it may be a crumb: what it
/// costs depends on the cut alone, but for a byte a copy.

#include "base/archive.h"
#include "base/id.h"

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
  std::uint32_t name;         ///< of its own for as long as no cut meets it
  std::vector<CopyId> copies; ///< ascending

  void archive(Archive& a) { a(name, copies); }
};

/// None, until somebody looks for them.
struct Crumbs {
  std::vector<Crumb> all;            ///< by ascending name
  std::vector<std::uint8_t> of_copy; ///< 1: in a crumb, or lapsed (complex.h): no physics deforms it
  std::vector<std::uint8_t> of_corner;
  std::uint32_t n_named = 0;

  void archive(Archive& a) { a(all, of_copy, of_corner, n_named); }
  bool any() const { return !all.empty(); }
  bool holds(const CopyId c) const { return c.value < of_copy.size() && of_copy[c.value] != 0; }
  bool holds(const CornerId c) const { return c.value < of_corner.size() && of_corner[c.value] != 0; }
};

/// Looks at the whole body, before any cut.
void find_crumbs(Solid& solid);

/// Follows a cut whose vertices are placed. Copies that are in a crumb now, and were not, join change.reshaped.
void update_crumbs(Solid& solid, CutChange& change);

} // namespace kerf::grid
