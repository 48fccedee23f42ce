#include "scene/drawing.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::scene {

namespace {

using Rods = std::vector<render::DrawnRod>;

Points placed(const Points& points, const cut::Pose& pose) {
  Points result;
  for (const Vec3& p : points)
    result.push_back(pose(p));
  return result;
}

/// A full circle in the plane of two unit vectors at right angles.
Points circle(const Vec3& centre, const double radius, const Vec3& u, const Vec3& w) {
  constexpr int n = 32;
  Points points;
  for (int i = 0; i <= n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    points.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * w));
  }
  return points;
}

/// The shank of one blade, from its back across the pivot to a ring on the other side.
void add_handle(const ScissorsHandles& handles, const cut::Blade& blade, const cut::Pose& pose, Rods& rods) {
  const auto distance = [&](const Vec3& p) { return (p - handles.pivot).norm(); };
  const auto [nearest, farthest] = std::minmax_element(
    blade.edge.begin(), blade.edge.end(), [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
  const double length = handles.length;
  const Vec3 back = (handles.pivot - *farthest).normalized();
  const Vec3 spine = blade.spine - blade.spine.dot(back) * back;
  const Vec3 outward = spine.norm() > 0 ? Vec3(spine.normalized()) : Vec3(handles.axis.cross(back).normalized());
  const double ring = 0.17 * length;
  const Vec3 end = handles.pivot + 0.62 * length * back - 0.13 * length * outward;
  const Vec3 centre = end + ring * (back - 0.5 * outward).normalized();
  const double radius = 0.025 * length;
  rods.push_back(
    {placed({*nearest + 0.5 * blade.spine, handles.pivot, handles.pivot + 0.2 * length * back, end}, pose), radius});
  rods.push_back({placed(circle(centre, ring, back, outward), pose), radius});
}

void add_scissors(const ScissorsHandles& handles, const World& world, const double time, Rods& rods) {
  if (handles.length == 0)
    return;
  for (std::size_t i = 0; i < 2; ++i) {
    const cut::Blade& blade = world.blades[handles.first_blade + i];
    add_handle(handles, blade, cut::pose(blade, time), rods);
  }
  const Vec3 half_pin = 0.05 * handles.length * handles.axis;
  const cut::Pose pose = cut::pose(world.blades[handles.first_blade], time);
  rods.push_back({placed({handles.pivot - half_pin, handles.pivot + half_pin}, pose), 0.05 * handles.length});
}

/// Two arms from a joint to the jaws, which stand apart while nothing is held.
void add_forceps(const Forceps& forceps, const int step, const double time, Rods& rods) {
  if (forceps.handle.isZero(0))
    return;
  constexpr double opened = 2.5; // times as far apart as when they hold
  const Vec3 jaw = (holds(forceps, step) ? 1 : opened) * forceps.jaws;
  const cut::Pose pose = cut::pose(forceps.key_frames, time);
  const double length = forceps.handle.norm();
  for (const double side : {-1.0, 1.0}) {
    const Vec3 tip = side * jaw;
    const Points arm = {1.3 * forceps.handle, forceps.handle, 0.6 * forceps.handle + 1.6 * tip,
                        0.15 * forceps.handle + tip};
    rods.push_back({placed(arm, pose), 0.02 * length});
    rods.push_back({placed({0.17 * forceps.handle + tip, -0.02 * forceps.handle + tip}, pose), 0.035 * length});
  }
}

render::DrawnSamples samples_of(const Body& body) {
  if (!body.interior)
    return {};
  const texture::Atlas& atlas = body.interior->atlas;
  return {atlas.first(), atlas.parts(), atlas.colours(), atlas.slopes()};
}

} // namespace

render::DrawnScene drawing(const World& world, const int step) {
  const double time = step * world.time_step;
  render::DrawnScene scene;
  for (const Body& body : world.bodies)
    scene.surfaces.push_back({positions(body), body.surface.triangles, body.surface.labels, samples_of(body)});
  for (const cut::Blade& blade : world.blades)
    scene.blades.push_back({cut::world_points(blade, time), cut::pose(blade, time).rotation * blade.spine});
  for (const ScissorsHandles& handles : world.scissors)
    add_scissors(handles, world, time, scene.rods);
  for (const Forceps& forceps : world.forceps)
    add_forceps(forceps, step, time, scene.rods);
  return scene;
}

} // namespace kerf::scene
