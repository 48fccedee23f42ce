#include "scene/forceps.h"

namespace kerf::scene {

namespace {

dynamics::Support grip(const Body& body, const Forceps& forceps, const double t0) {
  const auto frames = forceps.key_frames;
  const cut::Pose before = cut::pose(frames, t0);
  dynamics::Support support{{},
                            {},
                            [frames](const double t) { return cut::pose(frames, t).position; },
                            [frames](const double t) { return cut::pose(frames, t).rotation; }};
  for (const auto corner : ids<grid::CornerId>(body.complex.n_corners()))
    if (contains(forceps.region, body.grid.position(body.complex.node[corner]))) {
      support.corners.push_back(corner.value);
      support.rest.push_back(before.rotation.transpose() * (body.state.x[corner.value] - before.position));
    }
  return support;
}

} // namespace

bool contains(const std::variant<Box, Ball>& region, const Vec3& p) {
  return std::visit([&](const auto& shape) { return shape.contains(p); }, region);
}

void hold(Body& body, const std::span<const Forceps> forceps, const int step, const double t0) {
  auto& supports = body.loads.supports;
  supports.resize(body.regions.size());
  for (const Forceps& one : forceps)
    if (holds(one, step))
      supports.push_back(grip(body, one, t0));
}

} // namespace kerf::scene
