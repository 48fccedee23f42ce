#pragma once

/// Which mass moves with which corner, and to which node of the lattice it belongs.
///
/// A corner's mass is the integral of density N_a over the material of its copies, N_a its trilinear shape function:
/// what trilinear elements lump. Masses, and the masses' centre, are those of the material for every position of a cut.
/// The mass of a real corner belongs to its node; that of a virtual corner to the nearest nodes of its copy (fewest
/// edges away), in proportion to what their octants give to the integral; that of a copy without nodes to the node that
/// it follows (grid/followed.h), and is at least 1e-12 of a cube's. So along a line of the lattice mass sits at the
/// nodes, on the skin and along a cut as in the bulk.
///
/// The integrals are sums of positive terms: the share of a far corner in a sliver is accurate however small it is
/// (moments of a cell would cancel).

#include "grid/solid.h"

#include <vector>

namespace kerf::lattice {

struct Share {
  grid::NodeId node;
  grid::CornerId corner;
  double mass; ///< [kg]
};

/// Of all but crumbs. Sorted by node, then by corner; each pair once; each mass positive.
std::vector<Share> material_shares(const grid::Solid& solid, double density);

} // namespace kerf::lattice
