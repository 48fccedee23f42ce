#include "tests/grinder/cases.h"

#include "lattice/calibration.h"
#include "material/elastic.h"
#include "tests/grinder/tools.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerf::grinder {

namespace {

constexpr double gravity = 9.81, density = 1000; // [m/s^2], [kg/m^3]

constexpr int most_explicit_steps = 1500;

/// What is drawn of a body before its strokes.
struct Drawn {
  Target target;
  Vec3 down = Vec3::Zero(); ///< unit
  double youngs_modulus = 0, poissons_ratio = 0, unit = 0, mass_damping = 0;
  bool is_free = false;
};

/// Its own weight strains the body by 1 to 15 %, were it a column as long as its box.
double random_extent(const double youngs_modulus, Chance& chance) {
  const double load = chance.log_between(0.01, 0.15);
  return std::min(load * youngs_modulus / (density * gravity), chance.log_between(0.05, 1));
}

double random_time_step(Chance& chance) { return chance.happens(0.8) ? 1.0 / 60 : chance.log_between(1e-3, 0.04); }

Drawn draw(const Solid& solid, const Size& size, Chance& chance) {
  Drawn drawn;
  drawn.youngs_modulus = chance.log_between(1e3, 1e6);
  drawn.poissons_ratio = chance.happens(0.5) ? 0.4 : chance.between(0, 0.45);
  drawn.down = chance.direction();
  drawn.is_free = chance.happens(0.3);
  drawn.mass_damping = chance.happens(0.3) ? 2 : 0;
  const Vec3 diagonal = solid.box.upper - solid.box.lower;
  drawn.unit = std::stod(to_text(random_extent(drawn.youngs_modulus, chance) / diagonal.norm()));
  Target& target = drawn.target;
  for (const Vec3& p : solid.skin)
    target.skin.push_back(drawn.unit * p);
  target.centre = 0.5 * drawn.unit * (solid.box.lower + solid.box.upper);
  target.radius = 0.5 * drawn.unit * diagonal.norm();
  target.cell = drawn.unit * std::cbrt(solid.volume / chance.log_between(size.least_cells, size.most_cells));
  target.dt = random_time_step(chance);
  target.n_steps = chance.number(size.least_steps, size.most_steps);
  target.fall = drawn.is_free ? Vec3(gravity * drawn.down) : Vec3(Vec3::Zero());
  target.mesh = solid.path.string();
  target.unit = to_text(drawn.unit);
  return drawn;
}

/// What lies deepest in a random direction: a tenth to a third of the skin.
std::string support(const Target& target, Chance& chance) {
  const Vec3 normal = chance.direction();
  std::vector<double> depth;
  for (const Vec3& p : target.skin)
    depth.push_back(p.dot(normal));
  std::sort(depth.begin(), depth.end());
  const auto n = static_cast<double>(depth.size());
  const double level = depth[static_cast<std::size_t>(chance.between(0.1, 0.33) * n)] + 0.5 * target.cell;
  return section("Support held", {"Region = half space", "Plane normal [1] = " + text(normal),
                                  "Plane point [m] = " + text(Vec3(level * normal))});
}

std::string body(const Drawn& drawn, const Kind& kind, Chance& chance) {
  const Target& target = drawn.target;
  std::vector<std::string> lines = {
    "Mesh = " + target.mesh, "Mesh unit [m] = " + target.unit, "Cube edge [m] = " + to_text(target.cell),
    "Lattice offset [1] = " + text(Vec3(chance.between(0, 1), chance.between(0, 1), chance.between(0, 1)))};
  std::vector<std::string> material = {"Density [kg/m^3] = " + to_text(density),
                                       "Young's modulus [Pa] = " + to_text(drawn.youngs_modulus),
                                       "Poisson's ratio [1] = " + to_text(drawn.poissons_ratio)};
  for (const std::string& key : kind.keys)
    (key.starts_with("Law") ? material : lines).push_back(key);
  lines.push_back(section("Material", material));
  if (drawn.mass_damping > 0)
    lines.push_back(section("Damping", {"Mass damping [1/s] = " + to_text(drawn.mass_damping)}));
  if (!drawn.is_free)
    lines.push_back(support(target, chance));
  return section("Body solid", lines);
}

bool is_explicit(const Kind& kind) {
  return std::ranges::any_of(kind.keys, [](const std::string& key) {
    return key == "Integrator = symplectic Euler" || key == "Integrator = velocity Verlet";
  });
}

std::vector<Stroke> strokes(const Target& target, Chance& chance) {
  std::vector<Stroke> all;
  if (chance.happens(0.1))
    all.push_back(dice(target, chance.between(1.5, 6), chance.number(0, target.n_steps / 2) * target.dt));
  else if (chance.happens(0.95)) // else nothing is cut
    for (int i = chance.number(1, 3); i > 0; --i)
      all.push_back(random_stroke(target, chance, i));
  return all;
}

/// Explicit elements are stable up to some .85 of what a pressure wave takes through a cube, and up to a fifth less once
/// they are cut [s].
double explicit_step(const Drawn& drawn) {
  const material::Elastic elastic{
    .density = density, .youngs_modulus = drawn.youngs_modulus, .poissons_ratio = drawn.poissons_ratio};
  return 0.45 * drawn.target.cell / elastic.pressure_wave_speed();
}

/// Shape matching of a half width reaches the material's stiffness with time steps up to 1 / sqrt(k); about half of
/// that, since its energy swings by the step.
double time_step(const Drawn& drawn, const Kind& kind) {
  const Target& target = drawn.target;
  if (is_explicit(kind))
    return std::min(target.dt, explicit_step(drawn));
  if (kind.half_width == 0)
    return target.dt;
  const double k = lattice::stiffness_for(drawn.youngs_modulus, density, target.cell, kind.half_width);
  return std::min(target.dt, 0.45 / std::sqrt(k));
}

} // namespace

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
    {"fem-trilinear-corotational", {}},
    {"fem-trilinear-neo-Hookean", {"Law = neo-Hookean"}},
    {"fem-enhanced-corotational", {"Element = enhanced"}},
    {"fem-enhanced-neo-Hookean", {"Element = enhanced", "Law = neo-Hookean"}},
    {"fem-trilinear-Newmark", {"Integrator = Newmark"}},
    {"fem-enhanced-generalised-alpha", {"Element = enhanced", "Integrator = generalised alpha"}},
    {"fem-trilinear-BDF2", {"Integrator = BDF2"}},
    {"fem-trilinear-symplectic-Euler", {"Integrator = symplectic Euler"}},
    {"fem-enhanced-velocity-Verlet", {"Element = enhanced", "Law = neo-Hookean", "Integrator = velocity Verlet"}},
    {"pba", {"Backend = pba"}},
    {"lattice", {"Backend = lattice", section("Lattice", {"Half width [cells] = 2"})}, 2},
    {"mass-spring", {"Backend = mass-spring"}},
  };
  return all;
}

const Kind& kind_named(const std::string& name) {
  for (const Kind& kind : kinds())
    if (kind.name == name)
      return kind;
  throw std::out_of_range("no kind of physics is called " + name);
}

Scene random_scene(const Solid& solid, const Kind& kind, const unsigned seed, const Size& size) {
  Chance chance(solid.name, seed);
  Drawn drawn = draw(solid, size, chance);
  if (is_explicit(kind)) // all the sooner
    drawn.target.dt = std::min(drawn.target.dt, most_explicit_steps * explicit_step(drawn) / drawn.target.n_steps);
  const Target& target = drawn.target;
  Scene scene{.sections = {section("Time", {"Time step [s] = " + to_text(time_step(drawn, kind)),
                                            "End time [s] = " + to_text(target.n_steps * target.dt)}),
                           section("Gravity", {"Acceleration [m/s^2] = " + text(Vec3(gravity * drawn.down))}),
                           body(drawn, kind, chance)},
              .story = drawn.is_free ? "free;" : "held;"};
  for (const Stroke& stroke : strokes(target, chance)) {
    scene.sections.insert(scene.sections.end(), stroke.sections.begin(), stroke.sections.end());
    scene.story += ' ' + stroke.tool;
  }
  scene.sections.push_back(section("Observables", {"Names = missing energy, work of the cut, elastic energy, kinetic "
                                                   "energy, volume, rest volume, pieces"}));
  return scene;
}

} // namespace kerf::grinder
