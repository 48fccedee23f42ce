#pragma once

/// What holds after every cut, whatever was cut, in whatever configuration (thesis §2.4, §2.5). Each check is written
/// from the definitions, not with the code under test: floods instead of union-find, gluing node by node instead of by
/// masks.
///
/// Volumes are compared as parts of the whole body's: no piece's volume can be known better than the round-off of
/// positions, which is relative to the body.

#include "base/union_find.h"
#include "tests/fuzz/subject.h"

#include <stdexcept>

namespace kerf::fuzz {

/// An invariant that does not hold.
class Violation : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Copies are the parts of their cells; each material node has one real corner; pieces are what uncut segments join;
/// corners are the slots that gluing joins, no more and no fewer.
void require_sound_complex(const grid::Solid& solid, const Items& items);

/// Every corner has one parent, whatever copy is asked, an instance of the same node, or several where copies are
/// joined; real corners have real ones. A copy comes from that which had its items, or the nodes under points of the
/// skin that are new. Returns which corners before went on together.
UnionFind require_sound_parents(const grid::CellComplex& before, const grid::CellComplex& after,
                                const Table<grid::CornerId, grid::CornerId>& parents);

/// What an update does not name as changed is as it was.
void require_sound_change(const grid::CellComplex& before, const grid::CellComplex& after,
                          const grid::CutChange& change);

/// Each directed edge is met once each way, and no triangle holds a vertex twice.
void require_closed(const surface::Surface& surface);

/// Rows of W sum to 1 and take rest positions to rest positions.
void require_sound_weights(const grid::Solid& solid, const surface::Surface& surface);

/// Volumes in a cell. The octants of all its vertices have positive tetrahedra.
CellVolumes require_sound_volumes(const grid::Solid& solid, grid::CellId cell);

/// No copy of these cells has less than nothing at a corner, where the Cutter has cut.
void require_material(const Subject& subject, std::span<const grid::CellId> cells, Tally& tally);

/// The tetrahedra of each piece enclose what its triangles enclose, and the pieces together the volume of the uncut
/// body.
void require_kept_volumes(const Subject& subject, Tally& tally);

/// The same copies and corners, whatever their names.
void require_same(const grid::CellComplex& a, const grid::CellComplex& b);

/// Lumped mass of each corner [h^3, at unit density] in the given cells.
Table<grid::CornerId, double> corner_masses(const grid::Solid& solid, std::span<const grid::CellId> cells);

/// All of it but parents and masses.
void require_sound(const Subject& subject, Tally& tally);

} // namespace kerf::fuzz
