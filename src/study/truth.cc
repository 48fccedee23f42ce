#include "study/truth.h"

#include "base/sha256.h"
#include "reference/solution.h"

#include <Eigen/Geometry>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>

namespace kerf::study {

namespace {

using scene::keys_of;
using scene::Occurrence;
using scene::Section;

/// Changes where the same section would give another number, so that old files of the cache do not count.
constexpr char version[] = "1\n";

std::string text_of(const char* format, const double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// The unit square onto the quadrilateral.
Vec3 bilinear(const Points& corner, const Vec3& s) {
  const Vec3 low = (1 - s[0]) * corner[0] + s[0] * corner[1], high = (1 - s[0]) * corner[3] + s[0] * corner[2];
  return Vec3((1 - s[1]) * low + s[1] * high) + Vec3(0, 0, s[2]);
}

bool is_convex(const Points& corner) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 a = corner[(i + 1) % 4] - corner[i], b = corner[(i + 2) % 4] - corner[(i + 1) % 4];
    if (!(a.cross(b)[2] > 0))
      return false;
  }
  return true;
}

void require_shape(const TruthParameters& p, const Section& section) {
  if (p.corners.size() != 4 || !is_convex(p.corners))
    throw section.complaint("Corners [m]", "must be the four corners of a convex quadrilateral, counter-clockwise",
                            "Write four points: 0, 0, 0; 1, 0, 0; 1, 1, 0; 0, 1, 0");
  if (!p.heights.empty() && (p.heights.size() != 2 || !(p.heights[0] < p.heights[1])))
    throw section.complaint("Heights [m]", "must be two, the lower one first, or none",
                            "Write 0, 1; none: plane strain");
  const std::size_t n = p.heights.empty() ? 2 : 3;
  if (p.cells.size() < n || std::any_of(p.cells.begin(), p.cells.end(), [](double c) { return c != std::floor(c); }))
    throw section.complaint("Cells [1]", "must be whole numbers, one a direction", "Write 4, 4 or 4, 4, 2");
}

reference::Mesh mesh_of(const TruthParameters& p) {
  const auto n = [&](const std::size_t i) { return static_cast<int>(p.cells[i]); };
  reference::Mesh mesh = reference::rectangles(reference::equal(0, 1, n(0)), reference::equal(0, 1, n(1)));
  if (!p.heights.empty())
    mesh = reference::extruded(mesh, reference::equal(p.heights[0], p.heights[1], n(2)));
  reference::map_vertices(mesh, [&](const Vec3& s) { return bilinear(p.corners, s); });
  return mesh;
}

reference::Region within(const Box& box) {
  return [box](const Vec3& X) { return box.contains(X); };
}

void crack(reference::Mesh& mesh, const Section& section) {
  const auto p = section.read<TruthCrackParameters>();
  if (!(p.normal.norm() > 0))
    throw section.complaint("Normal [1]", "must not be zero", "Write a direction");
  if (reference::split(mesh, p.point, p.normal, within(p.box)) == 0)
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

reference::Problem problem_of(const TruthParameters& p, const Section& section) {
  reference::Problem problem;
  problem.mesh = mesh_of(p);
  for (const Section* one : section.all("Crack"))
    crack(problem.mesh, *one);
  problem.youngs_modulus = p.youngs_modulus;
  problem.poissons_ratio = p.poissons_ratio;
  for (const Section* one : section.all("Held")) {
    const auto held = one->read<TruthHeldParameters>();
    require_met(problem.mesh, held.box, *one);
    const auto has = [&](const char axis) { return held.axes.find(axis) != std::string::npos; };
    problem.supports.push_back({within(held.box), {has('x'), has('y'), has('z')}});
  }
  for (const Section* one : section.all("Pulled")) {
    const auto pulled = one->read<TruthPulledParameters>();
    require_met(problem.mesh, pulled.box, *one);
    problem.tractions.push_back({within(pulled.box), [t = pulled.traction](const Vec3&, const Vec3&) { return t; }});
  }
  if (p.force.norm() > 0)
    problem.body_force = [f = p.force](const Vec3&) { return f; };
  return problem;
}

double asked(const reference::Solution& solution, const TruthParameters& p, const Section& section) {
  const int axis = p.axis[0] - 'x';
  const double value = solution.displacement(p.point)[axis];
  return section.writes("Minus point [m]") ? value - solution.displacement(p.minus_point)[axis] : value;
}

Reference solve(const reference::Problem& problem, const TruthParameters& p, const Section& section) {
  const auto with = [&](const int degree) { return reference::solve(problem, {degree, 0, p.n_adaptations, 0.1}); };
  const auto best = with(p.degree);
  const double value = asked(*best, p, section), other = asked(*with(p.degree - 1), p, section);
  const double difference = std::abs(other / value - 1);
  const std::string told = "degree " + std::to_string(p.degree - 1) + " differs by " + text_of("%.1e", difference);
  if (!(difference <= p.tolerance))
    throw NumericalError("the section Truth has no answer within its tolerance: " + told +
                         ". Use more adaptations or cells");
  return {value, "deal.II, degree " + std::to_string(p.degree) + ", " + std::to_string(best->n_unknowns()) +
                   " unknowns; " + told};
}

std::optional<Reference> kept(const std::filesystem::path& file) {
  std::ifstream in(file);
  Reference found;
  std::string end;
  if (in >> found.value && in.ignore() && std::getline(in, found.source) && std::getline(in, end) && end == "end" &&
      found.value != 0)
    return found;
  return std::nullopt;
}

/// Beside its name first, so that what is there is whole; what cannot be written is not kept.
void keep(const std::filesystem::path& file, const Reference& found) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  const std::filesystem::path beside = file.string() + "." + std::to_string(getpid());
  std::ofstream(beside) << text_of("%.17g", found.value) << "\n" << found.source << "\nend\n";
  std::filesystem::rename(beside, file, error);
}

} // namespace

void TruthParameters::describe(Parameters& p) {
  p.points("Corners [m]", corners, "The body in the plane z = 0: four corners, counter-clockwise.");
  p.require_last();
  p.numbers("Heights [m]", heights, any_number, "It reaches from the first to the second. None: plane strain.");
  p.numbers("Cells [1]", cells, positive, "Cells along the first side, the second, and the height, before adaptation.");
  p.number("Young's modulus [Pa]", youngs_modulus, positive, "Of the material.");
  p.require_last();
  p.number("Poisson's ratio [1]", poissons_ratio, {.min = -1, .max = 0.5, .min_excluded = true, .max_excluded = true},
           "Of the material.");
  p.vector("Force [N/m^3]", force, "On every volume, as gravity times the density is.");
  p.vector("Point [m]", point, "Its displacement in equilibrium, at small strain, is the reference.");
  p.require_last();
  p.vector("Minus point [m]", minus_point, "Written: the displacement of this point is subtracted.");
  p.choice("Axis", axis, {"x", "y", "z"}, "The component that is asked for.");
  p.integer("Degree [1]", degree, {.min = 2, .max = 4}, "Of the elements.");
  p.integer("Adaptations [1]", n_adaptations, {.min = 0, .max = 40},
            "How often a tenth of the cells, with the largest estimate of the error, are refined.");
  p.number("Tolerance [1]", tolerance, positive, "By how much the same with a degree less may differ.");
}

void TruthPartParameters::describe(Parameters& p) {
  p.vector("Lower [m]", box.lower, "Of the box that it lies in.");
  p.vector("Upper [m]", box.upper, "Of the box that it lies in.");
}

void TruthHeldParameters::describe(Parameters& p) {
  TruthPartParameters::describe(p);
  p.choice("Hold", axes, {"xyz", "xy", "xz", "yz", "x", "y", "z"}, "The directions that are held.");
}

void TruthPulledParameters::describe(Parameters& p) {
  TruthPartParameters::describe(p);
  p.vector("Traction [N/m^2]", traction, "Force per area; it keeps its direction.");
  p.require_last();
}

void TruthCrackParameters::describe(Parameters& p) {
  TruthPartParameters::describe(p);
  p.vector("Point [m]", point, "Of the plane that it lies in, which faces of the cells must lie in too.");
  p.require_last();
  p.vector("Normal [1]", normal, "Of that plane.");
}

scene::SectionKind truth_grammar() {
  return {
    "Truth",
    Occurrence::once,
    "A reference for all rows that have no other, found by deal.II on a mesh that is fitted to the body: elements of "
    "high degree, refined where their error is. It is a displacement at small strain.",
    keys_of<TruthParameters>(),
    {{"Held",
      Occurrence::named,
      "Sides of the body whose middles (of each cell's face) lie in a box.",
      keys_of<TruthHeldParameters>(),
      {}},
     {"Pulled", Occurrence::named, "Sides of the body under a traction.", keys_of<TruthPulledParameters>(), {}},
     {"Crack",
      Occurrence::named,
      "A plane cut between cells, whose front is where its box ends.",
      keys_of<TruthCrackParameters>(),
      {}}}};
}

std::filesystem::path truth_cache() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "kerf/references";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache/kerf/references";
  return {};
}

Reference find_truth(const Section& section, const std::filesystem::path& cache) {
  const auto p = section.read<TruthParameters>();
  require_shape(p, section);
  const std::string text = version + scene::effective_text(section);
  const std::filesystem::path file = cache / (sha256(std::as_bytes(std::span(text))) + ".txt");
  const reference::Problem problem = problem_of(p, section); // whatever is in the cache, so that what is wrong is told
  if (const auto found = cache.empty() ? std::nullopt : kept(file))
    return *found;
  try {
    const Reference found = solve(problem, p, section);
    if (!cache.empty())
      keep(file, found);
    return found;
  } catch (const DataError&) {
    throw section.complaint("Point [m]", "lies outside of the body", "Write a point of it");
  }
}

} // namespace kerf::study
