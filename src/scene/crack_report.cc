#include "scene/crack_report.h"

#include "scene/composing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace kerf::scene {

namespace {

constexpr double far = std::numeric_limits<double>::infinity();

/// A point of the front, and which way its crack grows and stands there.
struct Station {
  Vec3 point, growth, normal; ///< [m], unit, unit
};

/// The middle of a line; of a circle four points.
std::vector<Station> stations(const fem::CrackFront& front) {
  if (const auto* const line = std::get_if<fem::LineFront>(&front)) {
    const Vec3 along = (line->second - line->first).normalized();
    return {{0.5 * (line->first + line->second), line->growth, along.cross(line->growth)}};
  }
  const auto& circle = std::get<fem::CircleFront>(front);
  const Vec3 u = circle.normal.unitOrthogonal(), v = circle.normal.cross(u);
  std::vector<Station> all;
  for (const Vec3& radial : {u, v, Vec3(-u), Vec3(-v)})
    all.push_back({circle.centre + circle.radius * radial, radial, circle.normal});
  return all;
}

/// How far the skin is in a direction in the crack's plane, between the ends of the front [m].
double to_skin(const Body& body, const Station& at, const Vec3& direction, const double length) {
  const double h = body.solid.grid.h();
  const Vec3 along = at.normal.cross(at.growth);
  double least = far;
  for (const Vec3& X : body.surface.rest) {
    const Vec3 r = X - at.point;
    if (std::abs(r.dot(at.normal)) < h && std::abs(r.dot(along)) < 0.5 * length - 0.25 * h && r.dot(direction) > 0)
      least = std::min(least, r.dot(direction));
  }
  return least;
}

/// Whether a point lies on a disc or rectangle, or so near to its plane; empty for what has no outline or one unknown
/// here.
std::optional<bool> is_on(const cut::Shape& shape, const Vec3& p, const double near) {
  if (const auto* const disc = std::get_if<cut::Disc>(&shape)) {
    const double off = (p - disc->centre).dot(disc->normal);
    return std::abs(off) < near && (p - disc->centre - off * disc->normal).norm() <= disc->radius;
  }
  if (const auto* const rectangle = std::get_if<cut::Rectangle>(&shape)) {
    const Vec3 r = p - rectangle->centre, u = rectangle->first_side, v = rectangle->second_side;
    return std::abs(r.dot(u.cross(v).normalized())) < near && std::abs(r.dot(u)) <= 0.5 * u.squaredNorm() &&
           std::abs(r.dot(v)) <= 0.5 * v.squaredNorm();
  }
  return std::nullopt;
}

/// Whether a surface is there a cube behind the front, and no more a cube ahead.
bool ends_at(const cut::Shape& shape, const Station& at, const double h) {
  return is_on(shape, at.point - h * at.growth, h) == true && is_on(shape, at.point + h * at.growth, h) == false;
}

/// How far behind the front a surface that ends there reaches, in steps of a quarter of a cube [m].
double length_behind(const cut::Shape& shape, const Station& at, const double h, const double most) {
  double length = h;
  while (length < most && is_on(shape, at.point - length * at.growth, h) == true)
    length += 0.25 * h;
  return length;
}

/// What parts the body is known to its end: discs, rectangles, and skin near the front.
bool is_known(const World& world) {
  return world.blades.empty() &&
         std::all_of(world.cut_surfaces.begin(), world.cut_surfaces.end(),
                     [](const TimedSurface& one) { return is_on(one.surface.shape, Vec3::Zero(), 0).has_value(); });
}

bool is_notched(const Body& body, const Station& at) {
  const double h = body.solid.grid.h();
  return std::any_of(body.surface.rest.begin(), body.surface.rest.end(),
                     [&](const Vec3& X) { return (X - at.point).norm() < 2 * h; });
}

/// Whether a cut has revealed a face near a point at rest.
bool is_revealed(const Body& body, const Vec3& p, const double near) {
  const auto& [rest, triangles, labels, copies, weights] = body.surface;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (labels[t] != grid::skin_label && std::any_of(triangles[t].begin(), triangles[t].end(),
                                                     [&](const auto v) { return (rest[v] - p).norm() < near; }))
      return true;
  return false;
}

/// Empty where nothing is wrong.
std::string warning_of(const Body& body, const World& world, const NamedFront& front, const Station& at) {
  const double h = body.solid.grid.h(), outer = front.tubes.outer, wanted = front.tubes.outer + front.tubes.inner;
  const bool is_line = std::holds_alternative<fem::LineFront>(front.front);
  const double length = is_line ? fem::length(front.front) : 2 * h;
  const double ahead = to_skin(body, at, at.growth, length);
  const double behind = is_line ? to_skin(body, at, -at.growth, length) : far;
  if (std::min(ahead, behind) < outer * (1 - 1e-6))
    return line("the skin is ", std::min(ahead, behind), " m ", ahead < behind ? "ahead of it" : "behind it",
                ", inside of its outer tube of ", outer, " m");
  bool ends_here = false;
  for (const auto& [surface, step] : world.cut_surfaces)
    if (ends_at(surface.shape, at, h)) {
      ends_here = true;
      if (const double crack = length_behind(surface.shape, at, h, wanted); is_line && crack < wanted)
        return line("its crack is ", crack, " m long, shorter than both tubes, ", wanted, " m");
    }
  if (!ends_here && is_known(world) && !is_notched(body, at))
    return line("no cut ends within a cube of it, and its figures are those of whatever is there");
  return "";
}

} // namespace

std::vector<std::string> warn_of_fronts(const Body& body, const World& world) {
  std::vector<std::string> warnings;
  for (const NamedFront& front : body.fronts)
    for (const Station& at : stations(front.front))
      if (const std::string what = warning_of(body, world, front, at); !what.empty()) {
        warnings.push_back(line("warning: body ", body.name, ": crack front ", front.name, ": ", what,
                                ". Use smaller cubes, smaller tubes, or move it to where the crack ends"));
        break;
      }
  return warnings;
}

std::vector<std::string> fronts_that_cuts_missed(const Body& body) {
  const double h = body.solid.grid.h(), near = 1.5 * h; // a revealed face ends up to a cube before its front
  std::vector<std::string> missed;
  for (const NamedFront& front : body.fronts) {
    const std::vector<Station> all = stations(front.front);
    const auto any = [&](const double ahead) {
      return std::any_of(all.begin(), all.end(),
                         [&](const Station& at) { return is_revealed(body, at.point + ahead * at.growth, near); });
    };
    const bool is_there = std::all_of(all.begin(), all.end(), [&](const Station& at) {
      return is_revealed(body, at.point - h * at.growth, near) || is_notched(body, at);
    });
    if (!is_there)
      missed.push_back(
        line("crack front ", front.name, ": no cut has come to it: its figures are those of whatever is there"));
    else if (any(3 * h))
      missed.push_back(
        line("crack front ", front.name, ": a cut has gone beyond it: its figures are wrong since then"));
  }
  return missed;
}

} // namespace kerf::scene
