#pragma once

/// Where rest points lie in the material of a cut body, and where the material is: both by its octants (grid/cuts.h),
/// so that whatever is sampled agrees with mass, volume and surface of the body.

#include "grid/complex.h"

namespace kerf::pba {

/// The copy whose material a rest point [m] lies in; invalid outside. A point where octants meet belongs to one of
/// them.
grid::CopyId copy_around(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                         const Vec3& p);

/// The copies that many points belong to which the body held before it was cut. A cut may move the skin a little past
/// a point: it then belongs to the material of its cell that it is nearest to.
std::vector<grid::CopyId> copies_around(const grid::Grid& grid, const grid::Cuts& cuts,
                                        const grid::CellComplex& complex, const Points& points);

/// A part of the material: its centroid [m] and its volume [m^3].
struct Crumb {
  Vec3 centre;
  double volume;
};

/// The material in parts no wider than `size` [m]: cubes of uncut cells, else tetrahedra of octants. Their volumes sum
/// to the body's.
std::vector<Crumb> crumbs(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
                          double size);

/// The box around the material [m].
Box bounds(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex);

} // namespace kerf::pba
