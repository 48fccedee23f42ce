#include "scene/compose_interior.h"

#include "image/file.h"
#include "scene/compose_body.h"
#include "scene/grammar_interior.h"
#include "texture/cache.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace kerf::scene {

namespace {

/// The value that stands for a word; the grammar has checked the word.
template <class Value, std::size_t N>
Value meant(const std::string& word, const std::array<std::pair<const char*, Value>, N>& words) {
  return std::find_if(words.begin(), words.end(), [&](const auto& pair) { return word == pair.first; })->second;
}

image::Image read_picture(const Section& section, const std::string& key, const std::string& path) {
  try {
    return image::read_image(resolved(path, section));
  } catch (const DataError& error) {
    throw DataError(section.complaint(key, clause(error.what()), "").complaint());
  }
}

texture::Sweep read_sweep(const Section& section, const ExemplarParameters& p) {
  using Path = texture::Sweep::Path;
  static const std::array<std::pair<const char*, Path>, 4> paths = {
    {{"normal", Path::normal}, {"middles", Path::middles}, {"arc", Path::arc}, {"axis", Path::axis}}};
  const texture::Sweep sweep{meant(p.sweep, paths), p.centre, p.axis};
  if (sweep.path == Path::axis && !(p.axis.norm() > 0))
    throw section.complaint("Axis [1]", "sweep axis must have an axis of some length",
                            "Write the direction of the line, in the plane, that the plane turns about");
  return sweep;
}

texture::Exemplar read_exemplar(const Section& section) {
  using texture::Background, texture::Fit;
  static const std::array<std::pair<const char*, Background>, 3> backgrounds = {
    {{"alpha", Background::alpha}, {"black", Background::black}, {"none", Background::none}}};
  static const std::array<std::pair<const char*, Fit>, 3> fits = {
    {{"none", Fit::none}, {"rigid", Fit::rigid}, {"harmonic", Fit::harmonic}}};
  const auto p = section.read<ExemplarParameters>();
  try {
    return {section.name(),
            read_picture(section, "Image", p.image),
            meant(p.background, backgrounds),
            texture::SectionPlane(p.origin, p.column, p.row),
            meant(p.fit, fits),
            read_sweep(section, p)};
  } catch (const ParameterError& error) { // of the plane; others carry their file already
    throw error.complaint().file.empty() ? placed(section, error.complaint().path, error) : error;
  }
}

texture::ExemplarPin read_pin(const Section& section, const Section& interior) {
  const auto p = section.read<PinParameters>();
  const auto exemplars = interior.all("Exemplar");
  for (const auto& [key, name] : {std::pair("From exemplar", p.from_exemplar), std::pair("To exemplar", p.to_exemplar)})
    if (std::none_of(exemplars.begin(), exemplars.end(), [&](const Section* e) { return e->name() == name; }))
      throw section.complaint(key, "names no exemplar of this interior", "Write the name of one");
  return {section.name(), {p.from_exemplar, p.to_exemplar}, {p.from, p.to}};
}

texture::InteriorOptions options_of(const InteriorParameters& p) {
  using texture::Components, texture::Morph, texture::Weights, warp::Global;
  static const std::array<std::pair<const char*, Morph>, 4> morphs = {{{"first order", Morph::first_order},
                                                                       {"exact inverse", Morph::exact_inverse},
                                                                       {"blend", Morph::blend},
                                                                       {"nearest", Morph::nearest}}};
  static const std::array<std::pair<const char*, Weights>, 2> weights = {
    {{"Shepard", Weights::shepard}, {"mean value", Weights::mean_value}}};
  static const std::array<std::pair<const char*, Components>, 3> components = {
    {{"one", Components::one}, {"each", Components::each}, {"together", Components::together}}};
  static const std::array<std::pair<const char*, Global>, 3> motions = {
    {{"none", Global::none}, {"rotation", Global::rotation}, {"rotation and scale", Global::rotation_and_scale}}};
  texture::InteriorOptions options;
  options.blending = {meant(p.morph, morphs), meant(p.weights, weights), p.power};
  options.components = meant(p.components, components);
  warp::MatchOptions& match = options.warps.match;
  match.n_levels = p.levels;
  match.n_cells = p.cells;
  match.edges = p.edges;
  match.brightness = p.brightness;
  match.outline = p.outline;
  match.stiffness = p.stiffness;
  match.global = meant(p.global, motions);
  options.warps.partners = p.warps == "all" ? texture::Partners::all : texture::Partners::facing;
  options.warps.pixels = p.match_pixels;
  return options;
}

/// The section that a complaint names in its value: "exemplar NAME, ...", "pin NAME".
const Section& section_of(const Section& interior, const std::string& value) {
  for (const auto& [word, kind] : {std::pair("exemplar ", "Exemplar"), std::pair("pin ", "Pin")})
    for (const Section* section : interior.all(kind))
      if (value == word + section->name() || value.starts_with(word + section->name() + ","))
        return *section;
  return interior;
}

/// A complaint at the place in the scene: its key may belong to the exemplar or to the whole.
ParameterError placed_inside(const Section& interior, const ParameterError& error) {
  const std::string& key = error.complaint().path;
  const bool of_all = key == "Components" || key == "Exemplar";
  return placed(of_all ? interior : section_of(interior, error.complaint().value), key, error);
}

double surface_area(const geometry::TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
  return area;
}

/// To two digits.
std::string rounded_up(const double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  std::ostringstream text;
  text << std::setprecision(2) << std::ceil(value / unit - 1e-9) * unit;
  return to_text(std::stod(text.str()));
}

texture::Skin read_skin(const Section& section, const InteriorParameters& p, const geometry::TriangleMesh& mesh) {
  if (!(p.skin_axis.norm() > 0))
    throw section.complaint("Skin axis [1]", "must have a length", "Give the direction of the picture's first row");
  const Box box = geometry::bounding_box(mesh);
  const Vec3 axis = p.skin_axis.normalized();
  const image::Image picture = read_picture(section, "Skin image", p.skin_image);
  const auto& alpha = picture.alpha.values;
  if (picture.has_alpha() && std::all_of(alpha.begin(), alpha.end(), [](const float a) { return a < 0.5f; }))
    throw section.complaint("Skin image", "is transparent all over: it shows no skin", "Check its alpha");
  return {picture, 0.5 * (box.lower + box.upper), axis, axis.unitOrthogonal()};
}

/// How well the pictures lie on the body's own sections.
void say_fits(const InteriorInput& input, const texture::Interior& inside, std::vector<std::string>& composition) {
  for (std::size_t i = 0; i < input.exemplars.size(); ++i) {
    const texture::Chart& chart = inside.charts()[i];
    std::string said = line("exemplar ", input.exemplars[i].name, ": shows ", std::lround(100 * chart.shown_share),
                            " % of the body's section");
    if (input.exemplars[i].fit != texture::Fit::none)
      said += line(", drawn to it to ", to_text(std::round(100 * chart.fit_error.mean) / 100), " pixels on average");
    else if (chart.shown_share < 0.995)
      said += "; what lacks goes on from its border, as it is not fitted (key Fit)";
    composition.push_back(said);
  }
}

/// The interior, by maps that are known where there are some.
texture::Interior build(const Section& section, const InteriorInput& input, const geometry::TriangleMesh& mesh,
                        const std::string& name, std::vector<std::string>& composition) {
  const std::uint64_t hash = texture::input_hash(input.exemplars, mesh, input.options);
  const auto file = texture::cache_file(resolved("cache", section), hash);
  const auto known = texture::load_maps(file, hash);
  texture::Interior inside(input.exemplars, mesh, input.options, known ? &*known : nullptr);
  const bool kept = known || texture::save_maps(file, hash, inside.maps());
  composition.push_back(line("body ", name, ": interior of ", input.exemplars.size(), " exemplars in ",
                             inside.partition().cells().size(), " cells, ", inside.n_pairs(), " warps",
                             known  ? " read from " + file.string()
                             : kept ? " found, and kept in " + file.string()
                                    : " found; they cannot be kept in " + file.string()));
  say_fits(input, inside, composition);
  return inside;
}

} // namespace

InteriorInput read_interior(const Section& section) {
  const auto p = section.read<InteriorParameters>();
  InteriorInput input;
  for (const Section* exemplar : section.all("Exemplar"))
    input.exemplars.push_back(read_exemplar(*exemplar));
  input.options = options_of(p);
  for (const Section* pin : section.all("Pin"))
    input.options.warps.pins.push_back(read_pin(*pin, section));
  return input;
}

std::unique_ptr<BodyInterior> compose_interior(const Section& section, const std::string& body_name,
                                               const geometry::TriangleMesh& mesh,
                                               std::vector<std::string>& composition) {
  const auto p = section.read<InteriorParameters>();
  const InteriorInput input = read_interior(section);
  try {
    auto interior = std::unique_ptr<BodyInterior>(new BodyInterior{
      .inside = build(section, input, mesh, body_name, composition), .atlas = texture::Atlas(p.resolution)});
    if (p.small_features)
      interior->detail = std::make_unique<texture::Detail>(interior->inside);
    if (!p.skin_image.empty())
      interior->skin = read_skin(section, p, mesh);
    interior->relief = p.relief;
    return interior;
  } catch (const ParameterError& error) {
    throw error.complaint().file.empty() ? placed_inside(section, error) : error;
  }
}

void require_affordable_colours(const Section& section, const geometry::TriangleMesh& mesh, const double cube_edge) {
  constexpr double most = 1 << 30; // bytes
  const auto p = section.read<InteriorParameters>();
  const Box box = geometry::bounding_box(mesh);
  const Vec3 sides = box.upper - box.lower;
  const double area = 2 * sides.prod() / sides.minCoeff() + (p.skin_image.empty() ? 0 : surface_area(mesh));
  const double a_sample = texture::Atlas::bytes_a_sample(p.relief), side = 0.5 * cube_edge;
  const double bytes = texture::n_samples_of(area, p.resolution, cube_edge) * a_sample;
  const double parts = std::sqrt(most / a_sample / area) * side - 1.5; // (n + 1) (n + 2) < (n + 1.5)^2
  const double finest = std::max(cube_edge / texture::Atlas::max_parts, bytes > most ? side / std::max(1.0, parts) : 0);
  if (p.resolution >= finest)
    return;
  throw section.complaint(
    "Resolution [m]",
    line("a cut across the body would take ", rounded_up(bytes / most), " GiB of colours; 1 GiB, and ",
         texture::Atlas::max_parts, " of them along the edge of a cube, are allowed"),
    line("Write at least ", rounded_up(finest), ", or smaller cubes"));
}

LookedInto compose_inside(const SceneText& text, const std::string& name) {
  const Section root = parse_scene(text, grammar());
  for (const Section* body : root.all("Body"))
    if (const Section* interior = body->find("Interior"); interior && (name.empty() || body->name() == name)) {
      LookedInto result;
      result.mesh = read_body_mesh(*body, body->read<BodyParameters>());
      result.interior = compose_interior(*interior, body->name(), result.mesh, result.composition);
      return result;
    }
  throw name.empty() ? root.complaint("no body of this scene has a section 'Interior'", "Say what is inside of one")
                     : root.complaint("there is no body '" + name + "' with a section 'Interior'",
                                      "Name one that has it, or none: then it is the first");
}

} // namespace kerf::scene
