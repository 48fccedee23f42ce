#pragma once

/// The solid that stands for a blade in an image.

#include "render/tool_mesh.h"

namespace kerf::render {

/// A closed plate on the polyline `edge` [m] that reaches to `edge + spine` [m], thin beside its depth, ground to zero
/// thickness at the edge. Labels: 0 side, 1 bevel, 2 back and ends. Empty if the edge is shorter than two different
/// points or the spine is null.
ToolMesh blade_mesh(const Points& edge, const Vec3& spine);

} // namespace kerf::render
