// `kerf weights`: what the criteria make of simple cuts (thesis, figures 2.9 and 2.19): images of the weight around a
// phyxel, and the weight of a pair against the growing cut.

#include "commands.h"
#include "run_info.h"
#include "scene_arguments.h"

#include "base/error.h"
#include "output/array_file.h"
#include "render/image.h"
#include "scene/parameter_file.h"
#include "visibility/field.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kerf::apps {

namespace {

using visibility::Face;
using Faces = std::vector<Face>;
using Parts = std::vector<Faces>;

/// The phyxel is the origin; cuts are strips of the plane z = height, seen from the side.
struct WeightParameters {
  double support = 1, height = -0.25, front = 0.1, gap = 0.1, half_width = 1; ///< [m]
  int pixels = 400;
  Vec3 partner = {0.1, 0.03, -0.6}; ///< [m]
  int n_parts = 160;
  visibility::CriterionChoice choice;

  void describe(Parameters& p) {
    p.number("Support [m]", support, positive, "Radius of the phyxel's kernel.");
    p.number("Cut height [m]", height, any_number, "Where the cut lies: the plane z = height.");
    p.number("Front [m]", front, any_number, "One front: the cut comes from the left and ends at this x.");
    p.number("Gap [m]", gap, non_negative, "Two fronts: another cut comes from the right and ends this far beyond.");
    p.number("Half width [m]", half_width, positive, "Of the picture, which shows |x|, |z| up to here in y = 0.");
    p.integer("Pixels [1]", pixels, {16, 4096}, "A side of the picture.");
    p.vector("Partner [m]", partner, "The other point of the pair whose weight is followed as the cut grows.");
    p.integer("Parts [1]", n_parts, {1, 100000}, "In which that cut grows.");
    p.number("Diffraction exponent [1]", choice.diffraction_exponent, {.min = 1}, "gamma of (2.34).");
    p.number("Transparency exponent [1]", choice.transparency_exponent, {.min = 2}, "gamma of (2.35).");
    p.integer("Mask resolution [texels]", choice.mask_resolution, {4, 32}, "Texels a side of a visibility disk.");
    p.number("Disk radius [1]", choice.disk_radius, positive, "Of the visibility disk in distances of its pair.");
  }
};

WeightParameters read_parameters(const SceneArguments& arguments) {
  const std::vector<scene::SectionKind> grammar = {{"Weights",
                                                    scene::Occurrence::once,
                                                    "The weight of a pair of points near simple cuts.",
                                                    scene::keys_of<WeightParameters>(),
                                                    {}}};
  const scene::Section root = scene::parse_scene(scene::read_scene_text(arguments.scene, arguments.overrides), grammar);
  const auto parameters = root.require("Weights").read<WeightParameters>();
  root.require_all_read();
  return parameters;
}

/// A cut: as it stands in the picture, and as it grows across the pair.
struct Case {
  std::string name;
  std::vector<std::array<double, 2>> strips; ///< from, to along x [m]
  Parts parts;
};

std::vector<Case> cases(const WeightParameters& p) {
  const double far = 3 * std::max(p.half_width, p.support), depth = far;
  return {{"one front",
           {{-far, p.front}},
           visibility::growing_strip(-1.5 * p.support, 1.5 * p.support, p.n_parts, depth, p.height)},
          {"two fronts",
           {{-far, p.front}, {p.front + p.gap, far}},
           visibility::merging_strips(1.5 * p.support, p.n_parts, depth, p.height)}};
}

visibility::Plane picture(const WeightParameters& p) {
  const double pixel = 2 * p.half_width / p.pixels;
  return {Vec3(-p.half_width, 0, p.half_width), pixel * Vec3::UnitX(), -pixel * Vec3::UnitZ(), p.pixels, p.pixels};
}

/// From blue at 0 over green to red at 1, as in the thesis' figure.
std::array<std::uint8_t, 3> colour(const double weight) {
  const double hue = 4 * (1 - std::clamp(weight, 0.0, 1.0)); // in sixths of the circle
  const auto channel = [&](const double from_peak) {
    return static_cast<std::uint8_t>(255 * std::clamp(2 - std::abs(from_peak), 0.0, 1.0));
  };
  return {channel(hue), channel(hue - 2), channel(hue - 4)};
}

/// Isolines at tenths, the cut in white, the phyxel as a black dot.
render::Image draw(const WeightParameters& p, const Case& of, const std::vector<double>& weights) {
  const int n = p.pixels;
  const double pixel = 2 * p.half_width / n;
  render::Image image{n, n, {}};
  const auto level = [&](const int i, const int j) { return std::floor(10 * weights[j * n + i] - 1e-9); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = -p.half_width + (i + 0.5) * pixel, z = p.half_width - (j + 0.5) * pixel;
      auto rgb = colour(weights[j * n + i]);
      if ((i > 0 && level(i, j) != level(i - 1, j)) || (j > 0 && level(i, j) != level(i, j - 1)))
        rgb = {0, 0, 0};
      for (const auto& [from, to] : of.strips)
        if (x > from && x < to && std::abs(z - p.height) < 1.5 * pixel)
          rgb = {255, 255, 255};
      if (std::hypot(x, z) < 3 * pixel)
        rgb = {0, 0, 0};
      image.rgb.insert(image.rgb.end(), rgb.begin(), rgb.end());
    }
  return image;
}

std::string underscored(std::string text) {
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
}

} // namespace

int weights(const Arguments& arguments) {
  const SceneArguments parsed = parse_scene_arguments(arguments);
  const WeightParameters p = read_parameters(parsed);
  std::filesystem::create_directories(parsed.output);
  std::vector<output::NamedArray> arrays;
  const auto n = static_cast<std::size_t>(p.pixels);
  std::printf(
    "largest jump of the weight of the pair as the cut grows in %d parts, over the weight at its start\n"
    "%-22s%12s%12s\n",
    p.n_parts, "", "one front", "two fronts");
  for (const std::string& criterion : visibility::criteria()) {
    visibility::CriterionChoice choice = p.choice;
    choice.criterion = criterion;
    std::printf("%-22s", criterion.c_str());
    for (const Case& one : cases(p)) {
      Faces cut;
      for (const auto& [from, to] : one.strips)
        for (const Face& face : visibility::strip(from, to, 3 * std::max(p.half_width, p.support), p.height))
          cut.push_back(face);
      const auto field = visibility::weight_field(choice, cut, Vec3::Zero(), p.support, picture(p));
      const auto name = underscored(one.name) + "_" + underscored(criterion);
      render::write_png(draw(p, one, field), parsed.output / (name + ".png"));
      const auto history = visibility::weight_history(choice, one.parts, {Vec3::Zero(), p.partner, p.support});
      const double jump = visibility::largest_jump(history) / history.front();
      std::printf("%12.4f", jump);
      arrays.push_back(
        {"field/" + name, "1", "weight around the phyxel, rows from above, columns along x", {n, n}, field});
      arrays.push_back({"history/" + name, "1", "weight of the pair after each part", {history.size()}, history});
      arrays.push_back({"largest_jump/" + name, "1", "of the history, over its start", {1}, {jump}});
    }
    std::printf("\n");
  }
  output::write_array_file(parsed.output / "weights.h5", "Weights near cuts, by criterion",
                           "N. Pietroni, thesis 2009, figures 2.9 and 2.19", arrays, run_info("weights", arguments));
  std::printf("images and weights.h5 in %s\n", parsed.output.c_str());
  return 0;
}

} // namespace kerf::apps
