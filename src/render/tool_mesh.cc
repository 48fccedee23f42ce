#include "render/tool_mesh.h"

namespace kerf::render {

Points without_repeats(const Points& polyline) {
  Points points;
  for (const Vec3& p : polyline)
    if (points.empty() || p != points.back())
      points.push_back(p);
  return points;
}

} // namespace kerf::render
