#include "scene/forceps.h"

#include "scene/held.h"

namespace kerf::scene {

namespace {

dynamics::Support grip(const Body& body, const Forceps& forceps, const double t0) {
  const auto frames = forceps.key_frames;
  const cut::Pose before = cut::pose(frames, t0);
  dynamics::Support support{{},
                            {},
                            [frames](const double t) { return cut::pose(frames, t).position; },
                            [frames](const double t) { return cut::pose(frames, t).rotation; }};
  support.corners = particles_in(body, forceps.region);
  for (const auto i : support.corners)
    support.rest.push_back(before.rotation.transpose() * (body.state.x[i] - before.position));
  return support;
}

} // namespace

void hold(Body& body, const std::span<const Forceps> forceps, const int step, const double t0) {
  auto& supports = body.loads.supports;
  supports.resize(body.regions.size());
  body.grips.clear();
  for (const Forceps& one : forceps) {
    if (step > 1 && holds(one, step) != holds(one, step - 1))
      dynamics::forget_forces(body.state); // what held it, or moved it, does so no more
    if (holds(one, step)) {
      supports.push_back(grip(body, one, t0));
      body.grips.push_back(one.name);
    }
  }
}

} // namespace kerf::scene
