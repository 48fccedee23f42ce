#include "study/truth_problem.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::study {

namespace {

using scene::keys_of;
using scene::Occurrence;
using scene::Section;

struct PartParameters {
  Box box;
  void describe(Parameters& p);
};

struct HeldParameters : PartParameters {
  std::string axes = "xyz";
  void describe(Parameters& p);
};

struct PinnedParameters {
  Vec3 point = Vec3::Zero();
  std::string axes = "xyz";
  void describe(Parameters& p);
};

struct PulledParameters : PartParameters {
  Vec3 traction = Vec3::Zero();
  void describe(Parameters& p);
};

struct CrackParameters : PartParameters {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();
  double radius = 0; ///< [m]; 0: as far as its box
  void describe(Parameters& p);
};

/// The unit square onto the quadrilateral.
Vec3 bilinear(const Points& corner, const Vec3& s) {
  const Vec3 low = (1 - s[0]) * corner[0] + s[0] * corner[1], high = (1 - s[0]) * corner[3] + s[0] * corner[2];
  return Vec3((1 - s[1]) * low + s[1] * high) + Vec3(0, 0, s[2]);
}

const char* const quadrilateral_shape = "quadrilateral";
const char* const disc_shape = "disc";
const char* const disc_in_square_shape = "disc in a square";

bool is_convex(const Points& corner) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 a = corner[(i + 1) % 4] - corner[i], b = corner[(i + 2) % 4] - corner[(i + 1) % 4];
    if (!(a.cross(b)[2] > 0))
      return false;
  }
  return true;
}

void require_quadrilateral(const TruthParameters& p, const Section& section) {
  if (p.corners.size() != 4 || !is_convex(p.corners))
    throw section.complaint("Corners [m]", "must be the four corners of a convex quadrilateral, counter-clockwise",
                            "Write four points: 0, 0, 0; 1, 0, 0; 1, 1, 0; 0, 1, 0");
}

void require_disc(const TruthParameters& p, const Section& section) {
  if (!(p.radius > 0))
    throw section.complaint("Radius [m]", "a disc has a radius", "Write one > 0");
}

void require_disc_in_square(const TruthParameters& p, const Section& section) {
  if (!(p.radius > 0 && p.radius < 0.8 * p.half_width))
    throw section.complaint("Radius [m]", "the disc must lie well within the square",
                            "Write a radius > 0 and below .8 of the key 'Half width [m]'");
  if (p.heights.empty() || !(p.heights[0] < 0 && p.heights[1] > 0))
    throw section.complaint("Heights [m]", "a body with a disc reaches below and above z = 0", "Write -1, 1");
  if (p.cells.empty() || p.cells[0] < 2)
    throw section.complaint("Cells [1]", "a disc in a square has two layers at its border or more", "Write 3 or 4");
}

/// How many numbers say the cells of a shape.
std::size_t n_counts(const TruthParameters& p) {
  if (has_layers(p))
    return 1;
  return (p.shape == disc_shape ? 1u : 2u) + (p.heights.empty() ? 0u : 1u);
}

void require_shape(const TruthParameters& p, const Section& section) {
  if (!p.heights.empty() && (p.heights.size() != 2 || !(p.heights[0] < p.heights[1])))
    throw section.complaint("Heights [m]", "must be two, the lower one first, or none",
                            "Write 0, 1; none: plane strain");
  if (p.shape == quadrilateral_shape)
    require_quadrilateral(p, section);
  else if (p.shape == disc_shape)
    require_disc(p, section);
  else
    require_disc_in_square(p, section);
  const std::size_t n = n_counts(p);
  if (p.cells.size() < n || std::any_of(p.cells.begin(), p.cells.end(), [](double c) { return c != std::floor(c); }))
    throw section.complaint("Cells [1]",
                            "must be whole numbers, " + std::to_string(n) + " of them for this shape and its heights",
                            n == 1   ? "Write 4"
                            : n == 2 ? "Write 4, 4"
                                     : "Write 4, 4, 2");
  if ((p.end_time > 0) != (p.time_step > 0) || p.time_step > p.end_time)
    throw section.complaint("Time step [s]", "a motion has a time step and an end, at least a step later",
                            "Write both, or leave both out");
}

int count(const TruthParameters& p, const std::size_t i) { return static_cast<int>(p.cells[i]); }

reference::Mesh quadrilateral(const TruthParameters& p) {
  reference::Mesh mesh =
    reference::rectangles(reference::equal(0, 1, count(p, 0)), reference::equal(0, 1, count(p, 1)));
  if (!p.heights.empty())
    mesh = reference::extruded(mesh, reference::equal(p.heights[0], p.heights[1], count(p, 2)));
  reference::map_vertices(mesh, [&](const Vec3& s) { return bilinear(p.corners, s); });
  return mesh;
}

reference::Mesh disc(const TruthParameters& p) {
  const int n_rings = count(p, 0);
  std::vector<double> radii; // the core, then rings as wide as half of it
  for (int i = 0; i <= n_rings; ++i)
    radii.push_back(p.radius * (2 + i) / (2 + n_rings));
  const reference::Mesh plane = reference::disc(radii);
  return p.heights.empty() ? plane
                           : reference::extruded(plane, reference::equal(p.heights[0], p.heights[1], count(p, 1)));
}

/// From `end` on outwards to `to` [m], each interval `ratio` times the one before.
void extend(std::vector<double>& at, const double to, const double ratio) {
  for (double step = ratio * (at.back() - at[at.size() - 2]); at.back() + 1.5 * step < to; step *= ratio)
    at.push_back(at.back() + step);
  at.push_back(to);
}

/// Layers on both sides of the border of the disc, and above and below it, shrink towards it.
reference::Mesh disc_in_block(const TruthParameters& p, const int n_layers) {
  constexpr double outwards = 2;
  const std::vector<double> near = reference::graded(0, 0.6 * p.radius, n_layers, layer_ratio);
  std::vector<double> radii;
  for (std::size_t i = near.size(); i-- > 0;)
    radii.push_back(p.radius - near[i]);
  for (std::size_t i = 1; i < near.size() && p.radius + near[i] < 0.9 * p.half_width; ++i)
    radii.push_back(p.radius + near[i]);
  std::vector<double> up = near, down = near, z;
  extend(up, p.heights[1], outwards);
  extend(down, -p.heights[0], outwards);
  for (std::size_t i = down.size(); i-- > 1;)
    z.push_back(-down[i]);
  z.insert(z.end(), up.begin(), up.end());
  return reference::extruded(reference::disc_in_square(radii, p.half_width), z);
}

reference::Region within(const Box& box) {
  return [box](const Vec3& X) { return box.contains(X); };
}

void crack(reference::Mesh& mesh, const Section& section) {
  const auto p = section.read<CrackParameters>();
  if (!(p.normal.norm() > 0))
    throw section.complaint("Normal [1]", "must not be zero", "Write a direction");
  const double radius = p.radius > 0 ? p.radius * (1 + 1e-9) : 1e300;
  const auto is_in = [&](const Vec3& X) { return p.box.contains(X) && (X - p.point).norm() <= radius; };
  if (reference::split(mesh, p.point, p.normal, is_in) == 0)
    throw section.complaint("no faces of the mesh lie in it",
                            "Choose cells whose faces do, or move it to where they are");
}

/// Throws where the part meets no face, at its section.
void require_met(const reference::Mesh& mesh, const Box& box, const Section& section) {
  const auto is_inside = [&](const Vec3& X) { return box.contains(X); };
  if (std::none_of(mesh.vertices.begin(), mesh.vertices.end(), is_inside))
    throw section.complaint("no vertex of the mesh lies in its box",
                            "Give it the bounds of a side of the body, with room");
}

std::array<bool, 3> held_along(const std::string& axes) {
  const auto has = [&](const char axis) { return axes.find(axis) != std::string::npos; };
  return {has('x'), has('y'), has('z')};
}

} // namespace

bool has_layers(const TruthParameters& p) { return p.shape == disc_in_square_shape; }

reference::Problem problem_of(const TruthParameters& p, const Section& section, const int fewer_layers) {
  require_shape(p, section);
  reference::Problem problem;
  problem.mesh = p.shape == quadrilateral_shape ? quadrilateral(p)
                 : p.shape == disc_shape        ? disc(p)
                                                : disc_in_block(p, count(p, 0) - fewer_layers);
  for (const Section* one : section.all("Crack"))
    crack(problem.mesh, *one);
  problem.youngs_modulus = p.youngs_modulus;
  problem.poissons_ratio = p.poissons_ratio;
  problem.density = p.density;
  for (const Section* one : section.all("Held")) {
    const auto held = one->read<HeldParameters>();
    require_met(problem.mesh, held.box, *one);
    problem.supports.push_back({within(held.box), held_along(held.axes)});
  }
  for (const Section* one : section.all("Pinned")) {
    const auto pinned = one->read<PinnedParameters>();
    problem.pins.push_back({pinned.point, held_along(pinned.axes)});
  }
  for (const Section* one : section.all("Pulled")) {
    const auto pulled = one->read<PulledParameters>();
    require_met(problem.mesh, pulled.box, *one);
    problem.tractions.push_back({within(pulled.box), [t = pulled.traction](const Vec3&, const Vec3&) { return t; }});
  }
  if (p.force.norm() > 0)
    problem.body_force = [f = p.force](const Vec3&) { return f; };
  else if (problem.tractions.empty())
    throw section.complaint("nothing pulls at the body, so that it stays as it is",
                            "Write 'set Force [N/m^3] = x, y, z' or a section 'Pulled NAME'");
  return problem;
}

void TruthParameters::describe(Parameters& p) {
  p.choice(
    "Shape", shape, {quadrilateral_shape, disc_shape, disc_in_square_shape},
    "The body in the plane z = 0. A disc lies around the origin; with heights it is a cylinder. In the square cells "
    "are fitted to a disc whose border a crack may have as its front.");
  p.points("Corners [m]", corners, "Of the quadrilateral: four, counter-clockwise.");
  p.number("Half width [m]", half_width, non_negative, "Of the square around the origin.");
  p.number("Radius [m]", radius, non_negative, "Of the disc.");
  p.numbers("Heights [m]", heights, any_number, "It reaches from the first to the second. None: plane strain.");
  p.numbers("Cells [1]", cells, positive,
            "Cells along the first side, the second, and the height, before adaptation. Of a disc: rings around its "
            "core, and the height. Of a disc in a square: layers inside and outside of its border, which shrink "
            "towards it; the answer is extrapolated from that many and one less.");
  p.number("Young's modulus [Pa]", youngs_modulus, positive, "Of the material.");
  p.require_last();
  p.number("Poisson's ratio [1]", poissons_ratio, {.min = -1, .max = 0.5, .min_excluded = true, .max_excluded = true},
           "Of the material.");
  p.number("Density [kg/m^3]", density, positive, "Of the material, where it moves.");
  p.vector("Force [N/m^3]", force, "On every volume, as gravity times the density is.");
  p.number("End time [s]", end_time, non_negative,
           "Of a motion that begins at rest, under loads that act at once and stay. 0: equilibrium.");
  p.number("Time step [s]", time_step, non_negative,
           "Of that motion: generalised alpha, of order 2, which keeps the energy.");
  p.number("Mass damping [1/s]", mass_damping, non_negative, "Of that motion.");
}

void TruthAnswerParameters::describe(Parameters& p) {
  p.vector("Point [m]", point, "Its displacement, at small strain, is the reference.");
  p.require_last();
  p.vector("Minus point [m]", minus_point, "Written: the displacement of this point is subtracted.");
  p.choice("Axis", axis, {"x", "y", "z"}, "The component that is asked for.");
  p.choice("Take", take, {"end", "maximum", "minimum"}, "The number that stands for a motion.");
  p.choice("Axes of the scene", axes, {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"},
           "Those that x, y and z of this section stand for at the study's points.");
  p.number("Energy factor [1]", energy_factor, positive,
           "Of the scene's body over this one: in plane strain its thickness in metres.");
  p.integer("Degree [1]", degree, {.min = 2, .max = 4}, "Of the elements.");
  p.integer("Adaptations [1]", n_adaptations, {.min = 0, .max = 40},
            "How often a tenth of the cells, with the largest estimate of the error, are refined.");
  p.number("Tolerance [1]", tolerance, positive,
           "By how much the same with a degree less, and twice the time step, may differ.");
}

void PartParameters::describe(Parameters& p) {
  p.vector("Lower [m]", box.lower, "Of the box that it lies in.");
  p.vector("Upper [m]", box.upper, "Of the box that it lies in.");
}

void HeldParameters::describe(Parameters& p) {
  PartParameters::describe(p);
  p.choice("Hold", axes, {"xyz", "xy", "xz", "yz", "x", "y", "z"}, "The directions that are held.");
}

void PinnedParameters::describe(Parameters& p) {
  p.vector("Point [m]", point, "The nearest vertex of the mesh is held.");
  p.require_last();
  p.choice("Hold", axes, {"xyz", "xy", "xz", "yz", "x", "y", "z"}, "The directions that are held.");
}

void PulledParameters::describe(Parameters& p) {
  PartParameters::describe(p);
  p.vector("Traction [N/m^2]", traction, "Force per area; it keeps its direction.");
  p.require_last();
}

void CrackParameters::describe(Parameters& p) {
  PartParameters::describe(p);
  p.vector("Point [m]", point, "Of the plane that it lies in, which faces of the cells must lie in too.");
  p.require_last();
  p.vector("Normal [1]", normal, "Of that plane.");
  p.number("Radius [m]", radius, non_negative, "It is a disc around its point. 0: it reaches as far as its box.");
}

std::vector<scene::SectionKind> truth_parts() {
  return {{"Held",
           Occurrence::named,
           "Sides of the body whose middles (of each cell's face) lie in a box.",
           keys_of<HeldParameters>(),
           {}},
          {"Pinned",
           Occurrence::named,
           "A vertex, held where nothing pulls at it: against motions that the sides leave free.",
           keys_of<PinnedParameters>(),
           {}},
          {"Pulled", Occurrence::named, "Sides of the body under a traction.", keys_of<PulledParameters>(), {}},
          {"Crack",
           Occurrence::named,
           "A plane cut between cells, whose front is where its box or disc ends.",
           keys_of<CrackParameters>(),
           {}}};
}

} // namespace kerf::study
