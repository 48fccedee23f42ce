#include "tests/grinder/tools.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::grinder {

namespace {

constexpr double pi = std::numbers::pi;

/// From the skin towards the middle: thin parts are met as often as thick ones.
Vec3 place_in(const Target& target, Chance& chance) {
  const Vec3& on_skin = chance.one_of(target.skin);
  return target.centre + chance.between(0, 1) * (on_skin - target.centre);
}

/// Where a straight stroke begins and ends, and when.
struct Way {
  Vec3 from, to;     ///< of a body that has not moved [m]
  double begin, end; ///< [s]
};

/// A stroke takes from one step to half of the run.
Way random_way(const Target& target, const Vec3& through, const Vec3& direction, Chance& chance) {
  const int n = target.n_steps, first = chance.number(0, n / 2);
  const int n_taken = chance.happens(0.4) ? chance.number(1, 2) : chance.number(3, std::max(4, n / 2));
  const double reach = chance.happens(0.7) ? 1.3 : chance.between(-0.2, 0.6);
  return {through - 1.3 * target.radius * direction, through + reach * target.radius * direction, first * target.dt,
          (first + n_taken) * target.dt};
}

/// Key frames of a way; every step of them where the tool follows a fall.
std::vector<std::string> motion(const Target& target, const Way& way) {
  if (target.fall.isZero())
    return {"Times [s] = " + text(std::vector{way.begin, way.end}),
            "Positions [m] = " + text(Points{way.from, way.to})};
  std::vector<double> times;
  Points positions;
  for (int step = 0; step <= target.n_steps; ++step) {
    const double t = step * target.dt, s = std::clamp((t - way.begin) / (way.end - way.begin), 0.0, 1.0);
    times.push_back(t);
    positions.push_back(way.from + s * (way.to - way.from) + 0.5 * t * t * target.fall);
  }
  return {"Times [s] = " + text(times), "Positions [m] = " + text(positions)};
}

std::string blade(const Target& target, const std::string& name, const Points& edge, const Way& way) {
  std::vector<std::string> lines = {"Edge [m] = " + text(edge)};
  for (const std::string& line : motion(target, way))
    lines.push_back(line);
  return section("Blade " + name, lines);
}

Points straight_edge(const Target& target, const Vec3& along, Chance& chance) {
  const double half = target.radius * (chance.happens(0.7) ? 1.3 : chance.between(0.2, 0.8));
  return {-half * along, half * along};
}

Stroke straight(const Target& target, Chance& chance, const std::string& name) {
  const Vec3 direction = chance.direction();
  const Way way = random_way(target, place_in(target, chance), direction, chance);
  return {"straight", {blade(target, name, straight_edge(target, chance.across(direction), chance), way)}};
}

/// Two blades through one place.
Stroke crossing(const Target& target, Chance& chance, const std::string& name) {
  const Vec3 place = place_in(target, chance), direction = chance.direction(), along = chance.across(direction);
  const Vec3 second = chance.happens(0.5) ? direction : chance.across(along);
  const Way a = random_way(target, place, direction, chance), b = random_way(target, place, second, chance);
  return {"crossing",
          {blade(target, name + "-first", straight_edge(target, along, chance), a),
           blade(target, name + "-second", straight_edge(target, direction.cross(along), chance), b)}};
}

/// Up to two whole waves, in the plane across its way or any other.
Points curved_edge(const Target& target, const Vec3& direction, Chance& chance) {
  const Vec3 along = chance.across(direction), aside = (direction.cross(along) + chance.between(-1, 1) * direction);
  const double half = 1.3 * target.radius, height = chance.between(0.05, 0.5) * target.radius;
  const double waves = chance.between(0.3, 2);
  constexpr int n = 16;
  Points edge;
  for (int i = 0; i <= n; ++i) {
    const double s = 2.0 * i / n - 1;
    edge.push_back(s * half * along + height * std::sin(pi * waves * s) * aside);
  }
  return edge;
}

Stroke curved(const Target& target, Chance& chance, const std::string& name) {
  const Vec3 direction = chance.direction();
  const Way way = random_way(target, place_in(target, chance), direction, chance);
  return {"curved", {blade(target, name, curved_edge(target, direction, chance), way)}};
}

/// A blade that turns as it goes; only in bodies that do not fall, where two key frames are enough.
Stroke turning(const Target& target, Chance& chance, const std::string& name) {
  if (!target.fall.isZero())
    return curved(target, chance, name);
  const Vec3 direction = chance.direction();
  const Way way = random_way(target, place_in(target, chance), direction, chance);
  const Points edge = straight_edge(target, chance.across(direction), chance);
  const double angle = chance.between(-120, 120); // [degrees]
  auto lines = motion(target, way);
  lines.push_back("Edge [m] = " + text(edge));
  lines.push_back("Rotations [degrees] = " + text(Points{Vec3::Zero(), angle * chance.direction()}));
  return {"turning", {section("Blade " + name, lines)}};
}

Stroke scissors(const Target& target, Chance& chance, const std::string& name) {
  const Vec3 along = chance.direction(), axis = chance.across(along);
  const double length = chance.between(1, 2.6) * target.radius, opening = chance.between(20, 90);
  const Vec3 pivot = place_in(target, chance) - 1.3 * target.radius * along;
  Way way = random_way(target, Vec3::Zero(), along, chance);
  way.from = way.to = Vec3::Zero();
  auto lines = motion(target, way);
  for (const std::string& line : {"Pivot [m] = " + text(pivot), "Axis [1] = " + text(axis),
                                  "Edge [m] = " + text(Points{pivot + 0.05 * length * along, pivot + length * along}),
                                  "Opening times [s] = " + text(std::vector{way.begin, way.end}),
                                  "Openings [degrees] = " + text(std::vector{opening, 0.0})})
    lines.push_back(line);
  return {"scissors", {section("Scissors " + name, lines)}};
}

/// Blades that fly in together from all sides.
Stroke several(const Target& target, Chance& chance, const std::string& name) {
  Stroke all = straight(target, chance, name + "-first");
  for (const char* const other : {"-second", "-third", "-fourth"})
    all.sections.push_back(straight(target, chance, name + other).sections.front());
  all.tool = "several";
  return all;
}

std::vector<std::string> shape_keys(const Target& target, const Vec3& place, Chance& chance, const std::string& shape) {
  if (shape == "mesh") // the body's own mesh, a little smaller: sheets that its skin runs along
    return {"Mesh = " + target.mesh, "Mesh unit [m] = " + to_text(std::stod(target.unit) * chance.between(0.5, 0.97))};
  std::vector<std::string> lines = {"Point [m] = " + text(place)};
  if (shape == "plane" || shape == "disc")
    lines.push_back("Normal [1] = " + text(chance.direction()));
  if (shape != "plane")
    lines.push_back("Radius [m] = " + to_text(chance.between(0.1, 0.7) * target.radius));
  if (shape == "cylinder") {
    lines.push_back("Axis [1] = " + text(chance.direction()));
    lines.push_back("Height [m] = " + to_text(chance.between(0.2, 1.5) * target.radius));
  }
  return lines;
}

/// One to three surfaces, each at its time.
Stroke surfaces(const Target& target, Chance& chance, const std::string& name) {
  Stroke all{"surfaces", {}};
  const int n = chance.number(1, 3);
  for (int i = 0; i < n; ++i) {
    const double time = chance.number(0, target.n_steps * 2 / 3) * target.dt;
    const Vec3 place = place_in(target, chance) + 0.5 * time * time * target.fall;
    const std::string shape = chance.one_of<std::string>({"plane", "plane", "sphere", "cylinder", "disc", "mesh"});
    std::vector<std::string> lines = shape_keys(target, place, chance, shape);
    lines.push_back("Shape = " + shape);
    lines.push_back("Time [s] = " + to_text(time));
    all.sections.push_back(section("Cut surface " + name + "-" + std::to_string(i), lines));
  }
  return all;
}

} // namespace

Stroke dice(const Target& target, const double n_cells, const double time) {
  Stroke all{"dice", {}};
  int number = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (double s = -target.radius; s < target.radius; s += n_cells * target.cell) {
      const Vec3 place = target.centre + s * Vec3::Unit(axis) + 0.5 * time * time * target.fall;
      all.sections.push_back(section("Cut surface dice-" + std::to_string(++number),
                                     {"Shape = plane", "Point [m] = " + text(place),
                                      "Normal [1] = " + text(Vec3(Vec3::Unit(axis))), "Time [s] = " + to_text(time)}));
    }
  return all;
}

Stroke random_stroke(const Target& target, Chance& chance, const int number) {
  const std::string name = "stroke-" + std::to_string(number);
  switch (chance.number(0, 8)) {
    case 0:
      return crossing(target, chance, name);
    case 1:
    case 2:
      return curved(target, chance, name);
    case 3:
      return turning(target, chance, name);
    case 4:
      return scissors(target, chance, name);
    case 5:
      return several(target, chance, name);
    case 6:
      return surfaces(target, chance, name);
    default:
      return straight(target, chance, name);
  }
}

} // namespace kerf::grinder
