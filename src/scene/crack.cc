#include "scene/crack.h"

#include "dynamics/surface_load.h"
#include "physics/on_corners.h"
#include "scene/body.h"

#include <algorithm>
#include <cmath>

namespace kerf::scene {

void CrackFormParameters::describe(Parameters& p) {
  p.choice(
    "Form", form, {"line", "circle"},
    "A line from skin to skin, or a whole circle with the crack inside. Of the keys below, those of the form must be "
    "set, and no others.");
}

void CrackFrontParameters::describe(Parameters& p) {
  const auto is = [&](const std::string& name) { return form.empty() || form == name; };
  const auto require_of_a_form = [&] {
    if (!form.empty())
      p.require_last();
  };
  if (is("line")) {
    p.vector("First [m]", first, "Line: where it leaves the skin, rest configuration.");
    require_of_a_form();
    p.vector("Second [m]", second, "Line: where it meets the skin again.");
    require_of_a_form();
    p.vector("Growth [1]", growth, "Line: the direction in which the crack would grow, of any length.");
    require_of_a_form();
  }
  if (is("circle")) {
    p.vector("Centre [m]", centre, "Circle: its centre, rest configuration.");
    require_of_a_form();
    p.vector("Normal [1]", normal, "Circle: the crack's normal, of any length.");
    require_of_a_form();
    p.number("Radius [m]", radius, positive, "Circle: its radius.");
    require_of_a_form();
  }
  p.number("Inner radius [1]", inner, positive,
           "Of the tube around the front in which nothing is summed, in cube edges: the fields are singular there.");
  p.number("Outer radius [1]", outer, positive,
           "Of the tube to which the sum goes, in cube edges: inside of it there must be neither loads nor supports.");
}

SectionKind crack_front_kind() {
  return {
    "Crack front",
    Occurrence::named,
    "The front of a crack, as it lies at rest; see the observables energy release rates and stress intensities. For "
    "statics. Discs and rectangles that cut at once end where they are cut, in cells or between them: the stress "
    "intensity is 1 % low with 4 cubes along a crack from the side. What blades and meshes cut may end up to a cube "
    "earlier.",
    keys_of<CrackFormParameters, CrackFrontParameters>(),
    {}};
}

namespace {

Vec3 direction(const Section& section, const std::string& key, const Vec3& d) {
  if (!(d.stableNorm() > 0))
    throw section.complaint(key, "must not be zero", "Write a direction, of any length");
  return d.stableNormalized();
}

fem::CrackFront front_of(const Section& section, const CrackFrontParameters& p) {
  if (p.form == "circle")
    return fem::CircleFront{p.centre, direction(section, "Normal [1]", p.normal), p.radius};
  const Vec3 along = direction(section, "Second [m]", p.second - p.first);
  const Vec3 growth = direction(section, "Growth [1]", p.growth), across = growth - growth.dot(along) * along;
  if (!(across.norm() > 1e-6))
    throw section.complaint("Growth [1]", "must not be along the front",
                            "Write the direction in which the crack grows");
  return fem::LineFront{p.first, p.second, across.normalized()};
}

void check_tubes(const Section& section, const CrackFrontParameters& p, const double cube_edge) {
  if (!(p.outer > p.inner))
    throw section.complaint("Outer radius [1]", "must be larger than Inner radius [1]",
                            "Two cube edges more are enough");
  if (p.form == "circle" && !(p.outer * cube_edge < p.radius))
    throw section.complaint("Outer radius [1]",
                            line("must be below the crack's radius, ", p.radius / cube_edge, " cubes"),
                            "Write a smaller one, or use smaller cubes");
}

} // namespace

std::vector<NamedFront> compose_crack_fronts(const Section& section, const double cube_edge,
                                             const std::string& backend) {
  std::vector<NamedFront> fronts;
  for (const Section* one : section.all("Crack front")) {
    if (backend != "fem")
      throw one->complaint("needs the stresses of finite elements, and this body has the backend '" + backend + "'",
                           "Remove it, or write 'set Backend = fem'");
    CrackFrontParameters of_form;
    of_form.form = one->read<CrackFormParameters>().form;
    const CrackFrontParameters mine = read_of_choice(*one, "the form '" + of_form.form + "'", of_form);
    check_tubes(*one, mine, cube_edge);
    fronts.push_back({one->name(), front_of(*one, mine), {mine.inner * cube_edge, mine.outer * cube_edge}});
  }
  return fronts;
}

namespace {

/// From where to where there are corners in the inner tube, along a line from its first end, or 0 for a circle [m].
struct Reach {
  double first = 1e300, last = -1e300;
};

Reach reach_of(const Body& body, const NamedFront& front) {
  const auto* const along = std::get_if<fem::LineFront>(&front.front);
  Reach reach;
  for (const Vec3& X : body.physics->rest())
    if (fem::growth_at(front.front, X).distance < front.tubes.inner) {
      const double at = along ? (X - along->first).dot((along->second - along->first).normalized()) : 0;
      reach = {std::min(reach.first, at), std::max(reach.last, at)};
    }
  return reach;
}

/// Corners reach up to a cube beyond the skin, which may be oblique to the front.
bool ends_on_skin(const Reach& reach, const NamedFront& front, const double cube_edge) {
  const double length = fem::length(front.front), near = front.tubes.inner + cube_edge;
  return std::holds_alternative<fem::CircleFront>(front.front) ||
         (std::abs(reach.first) < near && std::abs(reach.last - length) < near);
}

/// Whether a support holds something in the outer tube against what the growth of the crack shifts.
bool resists(const dynamics::Support& support, const NamedFront& front, const Points& rest) {
  return std::any_of(support.corners.begin(), support.corners.end(), [&](const std::uint32_t i) {
    const fem::Growth growth = fem::growth_at(front.front, rest[i]);
    return growth.distance < front.tubes.outer && (support.held * growth.direction).norm() > 1e-6;
  });
}

} // namespace

namespace {

/// Whether a box holds a point of the outer tube, give or take half a cube.
bool reaches(const Box& box, const NamedFront& front, const double cube_edge) {
  const Vec3 outer = Vec3::Constant(front.tubes.outer);
  const auto n = static_cast<int>(std::ceil(2 * fem::length(front.front) / cube_edge));
  for (int k = 0; k <= n; ++k)
    if (Box{box.lower - outer, box.upper + outer}.contains(fem::point_on(front.front, double(k) / n)))
      return true;
  return false;
}

/// What a load does on the faces of the crack is not in the sum.
void require_unloaded_faces(const Section& section, const Body& body) {
  const auto check = [&](const Section& load, const dynamics::PatchParameters& patch) {
    for (const NamedFront& front : body.fronts)
      if (patch.faces != "skin" && reaches({patch.lower, patch.upper}, front, body.solid.grid.h()))
        throw load.complaint("Faces",
                             "must not be faces of the crack inside of the outer tube of crack front '" + front.name +
                               "', whose energy release rate would lack what the load does there",
                             "Let the load begin outside of the tube (Lower, Upper), or pull at the skin instead: the "
                             "stress that would be where the crack is opens it as much; or remove the front");
  };
  for (const Section* load : section.all("Traction"))
    check(*load, load->read<dynamics::TractionParameters>().patch);
  for (const Section* load : section.all("Pressure"))
    check(*load, load->read<dynamics::PressureParameters>().patch);
}

} // namespace

std::vector<std::string> check_crack_fronts(const Section& section, const Body& body) {
  std::vector<std::string> warnings;
  require_unloaded_faces(section, body);
  if (!body.fronts.empty() && body.physics->motion() == dynamics::MotionKind::dynamic)
    warnings.push_back(line("warning: body ", body.name,
                            ": energy release rates are those of equilibria, and this body moves: what the motion of "
                            "the material near a front takes or gives is not in them. Write 'set Integrator = "
                            "quasi-static'"));
  for (std::size_t i = 0; i < body.fronts.size(); ++i) {
    const NamedFront& front = body.fronts[i];
    const Reach reach = reach_of(body, front);
    if (reach.first > reach.last)
      throw section.all("Crack front")[i]->complaint("no corner of the body lies in its inner tube",
                                                     "Move it into the body: it is meant in the rest configuration");
    const std::string start = line("warning: body ", body.name, ": crack front ", front.name);
    if (!ends_on_skin(reach, front, body.solid.grid.h()))
      warnings.push_back(line(
        start, " is ", fem::length(front.front), " m long, and beside it the body reaches from ", reach.first, " to ",
        reach.last, " m of it: its energy release rate is per length of the front. Put its ends on the skin"));
    for (std::size_t s = 0; s < body.regions.size(); ++s)
      if (resists(body.loads.supports[s], front, body.physics->rest()))
        warnings.push_back(
          line(start, ": support ", body.regions[s].name,
               " holds corners in its outer tube, and its work counts as energy released. Use a smaller "
               "Outer radius, or smaller cubes"));
  }
  return warnings;
}

double energy_release_rate(const Body& body, const NamedFront& front) {
  const auto& elements = dynamic_cast<const physics::Elements&>(*body.physics);
  return fem::energy_release_rate(body.solid, elements.own_model(), body.state.x, front.front, front.tubes);
}

double stress_intensity(const Body& body, const NamedFront& front) {
  const auto& elements = dynamic_cast<const physics::Elements&>(*body.physics);
  return fem::stress_intensity(energy_release_rate(body, front), elements.own_model().material());
}

} // namespace kerf::scene
