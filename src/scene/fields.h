#pragma once

/// Fields over a body for its files: displacement; of finite elements Green's strain and Cauchy's stress as
/// fem/fields.h recovers them; modes of vibration, a field each. Each is known at the corners; at a vertex of the
/// surface it is W times that.

#include "output/records.h"
#include "scene/body.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// All names, for people: "displacement, strain, ...".
std::string field_names();
bool is_field(const std::string& name);
/// Whether the field is there for the physics of a body.
bool has_field(const Body& body, const std::string& name);

/// The fields at every corner now, in the order of the names. Tensors are symmetric: xx, yy, zz, xy, yz, xz.
/// has_field() must hold.
std::vector<output::Field> fields_at_corners(const Body& body, const std::vector<std::string>& names);

/// W times fields at corners: one row a vertex.
std::vector<output::Field> at_vertices(const surface::Surface& surface, const std::vector<output::Field>& of_corners);

/// The fields without values, to announce them.
std::vector<output::Field> announced(const Body& body, const std::vector<std::string>& names);

} // namespace kerf::scene
