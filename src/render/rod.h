#pragma once

/// The solid that stands for a round bar in an image.

#include "render/tool_mesh.h"

namespace kerf::render {

/// A closed tube of this radius [m] around a polyline [m], with flat ends; labels: 0 side, 1 ends. Its cross-sections
/// halve the angles between segments. Empty if the path is shorter than two different points or the radius is not > 0.
/// Where the path turns back on itself the tube is flat.
ToolMesh rod_mesh(const Points& path, double radius);

} // namespace kerf::render
