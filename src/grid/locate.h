#pragma once

/// Where rest points lie in the material of a cut body, by its octants (material.h), so that whatever is looked up
/// agrees with mass, volume and surface of the body.

#include "grid/solid.h"

namespace kerf::grid {

/// The copy whose material a rest point [m] lies in; invalid outside. A point where octants meet belongs to one of
/// them.
CopyId copy_around(const Solid& solid, const Vec3& p);

/// The copies that many points belong to which the body held before it was cut. A cut may move the skin a little past
/// a point: it then belongs to the material of its cell that it is nearest to.
std::vector<CopyId> copies_around(const Solid& solid, const Points& points);

/// The copy whose material holds a rest point [m], or has it on its skin; invalid elsewhere.
CopyId copy_at(const Solid& solid, const Vec3& p);

} // namespace kerf::grid
