#include "scene/tool_shapes.h"

#include "geometry/box_tree.h"
#include "scene/held.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace kerf::scene {

namespace {

double length_of(const Points& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i)
    length += (line[i] - line[i - 1]).norm();
  return length;
}

/// The first direction, across `along`, that the blade's frame moves in; blade frame, null if there is none.
Vec3 first_motion_across(const cut::Blade& blade, const Vec3& along) {
  for (std::size_t i = 1; i < blade.key_frames.size(); ++i) {
    const Vec3 way = blade.key_frames[i].position - blade.key_frames[i - 1].position;
    const Vec3 motion = cut::pose(blade.key_frames, blade.key_frames[i - 1].time).rotation.transpose() * way;
    const Vec3 across = motion - motion.dot(along) * along;
    if (across.norm() > 1e-6 * way.norm())
      return across.normalized();
  }
  return Vec3::Zero();
}

/// What forceps hold of the first body that they hold something of: its box, and a direction out of that body.
struct Held {
  Box box;
  Vec3 outward = Vec3::UnitZ(); ///< unit
};

Held held_by(const Forceps& forceps, const World& world) {
  for (const Body& body : world.bodies) {
    const auto particles = particles_in(body, forceps.region);
    if (particles.empty())
      continue;
    Points points, all(body.surface.rest);
    for (const auto i : particles)
      points.push_back(body.physics->rest()[i]);
    const Box box = geometry::box_around(points), around = geometry::box_around(all);
    const Vec3 out = box.lower + box.upper - around.lower - around.upper;
    return {box, out.norm() > 0 ? Vec3(out.normalized()) : Vec3(Vec3::UnitZ())};
  }
  return {};
}

} // namespace

Vec3 usual_spine(const cut::Blade& blade) {
  const Vec3 chord = blade.edge.back() - blade.edge.front();
  const Vec3 along = chord.norm() > 0 ? Vec3(chord.normalized()) : Vec3((blade.edge[1] - blade.edge[0]).normalized());
  const Vec3 motion = first_motion_across(blade, along);
  return 0.2 * length_of(blade.edge) * (motion.isZero(0) ? Vec3(along.unitOrthogonal()) : Vec3(-motion));
}

Vec3 usual_spine(const cut::Scissors& scissors) {
  const Points& edge = scissors.edges[0];
  if (edge.empty()) // cut::blades() refuses it
    return Vec3::Zero();
  const auto distance = [&](const Vec3& p) { return (p - scissors.pivot).squaredNorm(); };
  const Vec3 tip = *std::max_element(edge.begin(), edge.end(),
                                     [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
  const Vec3 side = scissors.axis.cross(tip - scissors.pivot);
  return side.norm() > 0 ? Vec3(0.1 * length_of(edge) * side.normalized()) : Vec3(Vec3::Zero());
}

void complete_shape(Forceps& forceps, const World& world, const double grip_time) {
  const Held held = held_by(forceps, world);
  const Mat3 to_tool = cut::pose(forceps.key_frames, grip_time).rotation.transpose();
  const double size = std::max((held.box.upper - held.box.lower).norm(), world.bodies[0].solid.grid.h());
  if (forceps.jaws.isZero(0))
    forceps.jaws = 0.5 * size * (to_tool * held.outward.unitOrthogonal());
  if (forceps.handle.isZero(0))
    forceps.handle = 4 * size * (to_tool * held.outward);
}

} // namespace kerf::scene
