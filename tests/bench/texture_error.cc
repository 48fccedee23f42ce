/// How far painted insides are from the truth.
///
///     bench_texture_error [brain|facing|middles|onion|wood|citrus|all] [FOLDER [STIFFNESS [PIXELS LEVELS [CELLS]]]]
///
/// A brain of which one of nine sections is left out at a time and painted from the others; and solids whose colour is
/// known everywhere, painted on planes between 2 to 9 parallel exemplars. By method: PSNR [dB] and SSIM against the
/// truth, distance of the histograms of luminance, and the power of octaves (wavelengths around 4, 8, 16, 32 pixels)
/// over the truth's; then, as measures of sharpness, the distance of the histogram from that of the exemplars
/// themselves, and power over theirs. FOLDER gets pictures: truth, nearest, blend, first order, exact inverse, small
/// features.

#include "base/parallel.h"
#include "image/compare.h"
#include "image/file.h"
#include "tests/support/checkout.h"
#include "tests/texture/solids.h"

#include <cstdio>
#include <string>

namespace {

using namespace kerf;
using namespace kerf::texture;
using image::Grey;

struct Method {
  std::string name;
  Morph morph;
  bool small_features;
};
const std::vector<Method> methods = {{"nearest", Morph::nearest, false},
                                     {"blend", Morph::blend, false},
                                     {"first order", Morph::first_order, false},
                                     {"exact inverse", Morph::exact_inverse, false},
                                     {"first order + small", Morph::first_order, true}};
/// Of the warps between faces, for all subjects.
warp::MatchOptions match_options = WarpOptions().match;
int match_pixels = WarpOptions().pixels;
constexpr int n_bands = 4;

struct Score {
  double psnr = 0, ssim = 0, histogram = 0, own_histogram = 0;
  std::array<double, n_bands> power = {}, own_power = {};

  void add(const Score& other, const double share) {
    psnr += share * other.psnr;
    ssim += share * other.ssim;
    histogram += share * other.histogram;
    own_histogram += share * other.own_histogram;
    for (int k = 0; k < n_bands; ++k) {
      power[k] += share * other.power[k];
      own_power[k] += share * other.own_power[k];
    }
  }
};

/// How sharp the exemplars are: their mean histogram and power by octave.
struct Own {
  std::vector<double> histogram = std::vector<double>(64, 0);
  std::array<double, n_bands> power = {};
};

Own own_of(const Interior& interior) {
  Own own;
  const double share = 1 / static_cast<double>(interior.charts().size());
  for (const Chart& chart : interior.charts()) {
    Grey grey = chart.inside, mask = chart.inside;
    for (std::size_t i = 0; i < grey.values.size(); ++i) {
      grey.values[i] = chart.colours.values[i][3];
      mask.values[i] *= chart.shown.values[i];
    }
    const auto histogram = image::histogram(grey, mask, 64);
    const auto power = image::band_power(grey, mask, n_bands);
    for (int k = 0; k < 64; ++k)
      own.histogram[k] += share * histogram[k];
    for (int k = 0; k < n_bands; ++k)
      own.power[k] += share * power[k];
  }
  return own;
}

Score score(const image::Colours& painted, const image::Colours& truth, const Grey& mask, const Own& own) {
  const Grey a = image::luminance(painted), b = image::luminance(truth);
  Score s{image::psnr(painted, truth, mask),
          image::ssim(a, b, mask),
          image::histogram_distance(image::histogram(a, mask, 64), image::histogram(b, mask, 64)),
          image::histogram_distance(image::histogram(a, mask, 64), own.histogram),
          {},
          {}};
  const auto pa = image::band_power(a, mask, n_bands), pb = image::band_power(b, mask, n_bands);
  for (int k = 0; k < n_bands; ++k) {
    s.power[k] = pa[k] / pb[k];
    s.own_power[k] = pa[k] / own.power[k];
  }
  return s;
}

void print(const std::string& what, const std::string& method, const Score& s) {
  std::printf("%-16s %-20s %7.2f %7.3f %9.4f  ", what.c_str(), method.c_str(), s.psnr, s.ssim, s.histogram);
  for (const double ratio : s.power)
    std::printf(" %6.2f", ratio);
  std::printf("  %9.4f  ", s.own_histogram);
  for (const double ratio : s.own_power)
    std::printf(" %6.2f", ratio);
  std::printf("\n");
}

void print_head() {
  std::printf("%-16s %-20s %7s %7s %9s   %-28s %9s    %s\n", "", "", "PSNR", "SSIM", "histogram",
              "power over the truth's,", "histogram", "power over the exemplars' own,");
  std::printf("%-16s %-20s %7s %7s %9s   %-28s %9s    %s\n", "", "", "[dB]", "", "", "by octave from the finest",
              "from own", "by octave from the finest");
}

/// Of the scores: the truth comes first.
std::string name_of(const std::size_t score) { return score == 0 ? "truth" : methods[score - 1].name; }

/// Pictures side by side, what is outside of the mask in grey.
void write_strip(const std::vector<image::Colours>& pictures, const Grey& mask, const std::string& path) {
  const int w = mask.width, h = mask.height;
  image::Colours strip(static_cast<int>(pictures.size()) * (w + 4), h, image::Rgb::Constant(0.85f));
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c)
        if (mask(c, r) > 0.5f)
          strip(static_cast<int>(i) * (w + 4) + c, r) = pictures[i](c, r);
  image::write_image(strip, path);
}

/// The scores of the truth itself and of all methods on one patch.
std::vector<Score> compare(const Interior& interior, const Detail& detail, const Patch& patch,
                           const image::Colours& truth, const Grey& mask, const std::string& path) {
  std::vector<Score> scores;
  std::vector<image::Colours> pictures = {truth};
  const Own own = own_of(interior);
  scores.push_back(score(truth, truth, mask, own));
  for (const Method& method : methods) {
    Blending how = interior.options().blending;
    how.morph = method.morph;
    pictures.push_back(colours_of(paint(interior, patch, method.small_features ? &detail : nullptr, how)));
    scores.push_back(score(pictures.back(), truth, mask, own));
  }
  if (!path.empty())
    write_strip(pictures, mask, path);
  return scores;
}

struct BrainSection {
  std::string file;
  Vec3 origin, column, row; ///< [mm]
};

/// As sections.json of the data says.
std::vector<BrainSection> brain_sections() {
  std::vector<BrainSection> sections;
  const Vec3 x = 0.5 * Vec3::UnitX(), y = 0.5 * Vec3::UnitY(), z = 0.5 * Vec3::UnitZ();
  for (const int at : {35, 55, 75, 95, 115})
    sections.push_back({"axial_z" + std::to_string(at), Vec3(15, 18, at), x, y});
  for (const int at : {60, 118})
    sections.push_back({"sagittal_x" + std::to_string(at), Vec3(at, 18, 1.5), y, z});
  for (const int at : {70, 140})
    sections.push_back({"coronal_y" + std::to_string(at), Vec3(15, at, 1.5), x, z});
  return sections;
}

Exemplar brain_exemplar(const BrainSection& s) {
  constexpr double mm = 1e-3;
  return {s.file, image::read_image(support::checkout() + "/params/sections/brain/" + s.file + ".png"),
          Background::black, SectionPlane(mm * s.origin, mm * s.column, mm * s.row)};
}

InteriorOptions brain_options(const Partners partners) {
  InteriorOptions options;
  options.components = Components::together;
  options.warps.partners = partners;
  options.warps.match = match_options;
  options.warps.pixels = match_pixels;
  return options;
}

void study_brain(const std::string& folder, const Sweep::Path path, const Partners partners) {
  const auto body = geometry::read_mesh(support::checkout() + "/params/meshes/brain_40k.off", 1e-3);
  const auto sections = brain_sections();
  std::vector<Score> means(methods.size() + 1);
  print_head();
  for (std::size_t out = 0; out < sections.size(); ++out) {
    std::vector<Exemplar> others;
    for (std::size_t i = 0; i < sections.size(); ++i)
      if (i != out) {
        others.push_back(brain_exemplar(sections[i]));
        others.back().sweep.path = path;
      }
    const Interior interior(others, body, brain_options(partners));
    const Exemplar left_out = brain_exemplar(sections[out]);
    const SectionPlane& plane = left_out.plane;
    const Patch patch{plane.origin(), plane.point(plane.to_local(Vec2(1, 0))) - plane.origin(),
                      plane.point(plane.to_local(Vec2(0, 1))) - plane.origin(), left_out.picture.width(),
                      left_out.picture.height()};
    // Inside the section: of the body, and of what the picture shows.
    Grey mask = picture_of(interior, body, patch, nullptr, {.morph = Morph::nearest}).alpha;
    const Grey shown = mask_of(left_out.picture, Background::black);
    for (std::size_t i = 0; i < mask.values.size(); ++i)
      mask.values[i] *= shown.values[i];
    const auto scores = compare(interior, Detail(interior), patch, left_out.picture.colours, mask,
                                folder.empty() ? "" : folder + "/" + sections[out].file + ".png");
    for (std::size_t m = 0; m < scores.size(); ++m) {
      print(sections[out].file, name_of(m), scores[m]);
      means[m].add(scores[m], 1.0 / static_cast<double>(sections.size()));
    }
  }
  for (std::size_t m = 0; m < means.size(); ++m)
    print("mean", name_of(m), means[m]);
}

/// Planes between the exemplars: two along them, one tilted.
std::vector<Patch> test_patches() {
  constexpr int n = 200;
  constexpr double half = 0.052, pixel = 2 * half / (n - 1);
  const auto patch = [&](const Vec3& middle, const Vec3& x, const Vec3& y) {
    return Patch{middle - half * x - half * y, pixel * x, pixel * y, n, n};
  };
  const Vec3 a = Vec3(1, 0.1, 0.3).normalized(), b = Vec3(-0.1, 1, 0).normalized();
  return {patch(Vec3(0, 0, 0.0052), Vec3::UnitX(), Vec3::UnitY()),
          patch(Vec3(0, 0, -0.0137), Vec3::UnitX(), Vec3::UnitY()), patch(Vec3(0.002, 0, 0.004), a, b)};
}

/// n sections at right angles to z, evenly from -0.03 to 0.03 m.
std::vector<Exemplar> sections_along_z(const Solid& solid, const int n) {
  std::vector<Exemplar> exemplars;
  for (int i = 0; i < n; ++i)
    exemplars.push_back(exemplar_of("e" + std::to_string(i), solid, Vec3(0, 0, 0.03 * (2.0 * i / (n - 1) - 1)),
                                    Vec3::UnitX(), Vec3::UnitY()));
  return exemplars;
}

Grey ball_mask(const Patch& patch) {
  Grey mask(patch.width, patch.height, 0);
  for (int r = 0; r < patch.height; ++r)
    for (int c = 0; c < patch.width; ++c) {
      const Vec3 p = patch.point(c, r);
      mask(c, r) = p.norm() < 0.0495 && std::abs(p[2]) < 0.03 ? 1.0f : 0.0f;
    }
  return mask;
}

image::Colours truth_of(const Solid& solid, const Patch& patch) {
  image::Colours truth(patch.width, patch.height, image::Rgb::Zero());
  for (int r = 0; r < patch.height; ++r)
    for (int c = 0; c < patch.width; ++c)
      truth(c, r) = solid(patch.point(c, r));
  return truth;
}

double border_of_ball(const double z) { return std::sqrt(std::max(0.0, 0.0025 - z * z)); }

/// The radius [m] at one height of the layer of the onion that has this radius at another; 0 where it does not reach.
double layer_at(const double radius, const double from, const double to) {
  const auto height = [](const double z) { return 0.9 * (z - 0.006); };
  return std::sqrt(std::max(0.0, radius * radius + height(from) * height(from) - height(to) * height(to)));
}

/// The heights of the sections below and above [m].
std::array<double, 2> sections_around(const std::vector<Exemplar>& exemplars, const double z) {
  std::size_t i = 0;
  while (i + 2 < exemplars.size() && z > exemplars[i + 1].plane.origin()[2])
    ++i;
  return {exemplars[i].plane.origin()[2], exemplars[i + 1].plane.origin()[2]};
}

/// What (3.14) gives of the onion with the warps that its layers have: how near any warps can come. Source points are
/// those of the ball, as far from its axis as the ball's border is wider there.
image::Colours onion_by_its_layers(const std::vector<Exemplar>& exemplars, const Patch& patch) {
  image::Colours painted(patch.width, patch.height, image::Rgb::Zero());
  for (int r = 0; r < patch.height; ++r)
    for (int c = 0; c < patch.width; ++c) {
      const Vec3 p = patch.point(c, r);
      const auto [a, b] = sections_around(exemplars, p[2]);
      const double weight = (b - p[2]) / (b - a), ratio = std::hypot(p[0], p[1]) / border_of_ball(p[2]);
      const double on_a = weight * ratio * border_of_ball(a) + (1 - weight) * layer_at(ratio * border_of_ball(b), b, a);
      const double on_b = (1 - weight) * ratio * border_of_ball(b) + weight * layer_at(ratio * border_of_ball(a), a, b);
      painted(c, r) = mixed(onion(Vec3(on_b, 0, b)), onion(Vec3(on_a, 0, a)), weight);
    }
  return painted;
}

/// By how much the ring of a point's layer moves between the sections around it, once their borders match, in distances
/// of rings.
double motion_of_ring(const std::vector<Exemplar>& exemplars, const Vec3& p) {
  constexpr double apart = 0.0075;
  const auto [a, b] = sections_around(exemplars, p[2]);
  const double radius = std::hypot(p[0], p[1]), here = border_of_ball(p[2]);
  return std::abs(layer_at(radius, p[2], a) / border_of_ball(a) - layer_at(radius, p[2], b) / border_of_ball(b)) *
         here / apart;
}

/// PSNR [dB] of the blend, of (3.14), and of it with the warps that the onion's layers have: of all points, and by how
/// far their rings move.
void print_best_onion(const Interior& interior, const int n) {
  const auto exemplars = sections_along_z(onion, n);
  constexpr std::array<double, 5> bounds = {0, 0.25, 0.5, 1, 1e300};
  std::array<std::array<double, 3>, bounds.size()> errors = {}; // the last row: of all
  std::array<double, bounds.size()> counts = {};
  for (const Patch& patch : test_patches()) {
    const Grey mask = ball_mask(patch);
    const std::array<image::Colours, 3> painted = {
      colours_of(paint(interior, patch, nullptr, {.morph = Morph::blend})),
      colours_of(paint(interior, patch, nullptr, {.morph = Morph::first_order})),
      onion_by_its_layers(exemplars, patch)};
    for (int r = 0; r < patch.height; ++r)
      for (int c = 0; c < patch.width; ++c) {
        if (mask(c, r) < 0.5f)
          continue;
        const Vec3 p = patch.point(c, r);
        const double motion = motion_of_ring(exemplars, p);
        std::size_t k = 0;
        while (motion >= bounds[k + 1])
          ++k;
        for (const std::size_t row : {k, bounds.size() - 1}) {
          ++counts[row];
          for (std::size_t m = 0; m < painted.size(); ++m)
            errors[row][m] += (painted[m](c, r) - onion(p)).square().mean();
        }
      }
  }
  std::printf("%d exemplars, by motion of rings: share of points; blend, first order, its layers' own warps\n", n);
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    const bool all = k + 1 == bounds.size();
    std::printf("  %-10s %5.1f %%", all ? "all" : ("from " + std::to_string(bounds[k]).substr(0, 4)).c_str(),
                100 * counts[k] / counts.back());
    for (const double error : errors[k])
      std::printf(" %6.2f", 10 * std::log10(counts[k] / error));
    std::printf("\n");
  }
}

void study_solid(const std::string& name, const Solid& solid, const std::string& folder) {
  std::printf("\n%s\n", name.c_str());
  print_head();
  const auto patches = test_patches();
  for (int n = 2; n <= 9; ++n) {
    InteriorOptions options;
    options.warps.match = match_options;
    options.warps.pixels = match_pixels;
    const Interior interior(sections_along_z(solid, n), ball(5), options);
    const Detail detail(interior);
    std::vector<Score> means(methods.size() + 1);
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const std::string file = folder + "/" + name + "_" + std::to_string(n) + "_plane_" + std::to_string(i) + ".png";
      const auto scores = compare(interior, detail, patches[i], truth_of(solid, patches[i]), ball_mask(patches[i]),
                                  folder.empty() || (n != 3 && n != 9) ? "" : file);
      for (std::size_t m = 0; m < means.size(); ++m)
        means[m].add(scores[m], 1.0 / static_cast<double>(patches.size()));
    }
    for (std::size_t m = 0; m < means.size(); ++m)
      print(std::to_string(n) + " exemplars", name_of(m), means[m]);
    if (name == "onion")
      print_best_onion(interior, n);
  }
}

} // namespace

int main(const int argc, char** const argv) {
  const std::string subject = argc > 1 ? argv[1] : "all", folder = argc > 2 ? argv[2] : "";
  const auto is_asked = [&](const std::string& name) { return subject == "all" || subject == name; };
  match_options.stiffness = argc > 3 ? std::atof(argv[3]) : match_options.stiffness;
  match_pixels = argc > 4 ? std::atoi(argv[4]) : match_pixels;
  match_options.n_levels = argc > 5 ? std::atoi(argv[5]) : match_options.n_levels;
  match_options.n_cells = argc > 6 ? std::atoi(argv[6]) : match_options.n_cells;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (is_asked("brain")) {
    std::printf("brain, one section left out\n");
    study_brain(folder, Sweep::Path::normal, Partners::all);
  }
  if (is_asked("facing")) {
    std::printf("\nbrain, warps only between sections that face each other\n");
    study_brain(folder, Sweep::Path::normal, Partners::facing);
  }
  if (is_asked("middles")) {
    std::printf("\nthe same, planes swept through the middles of parallel sections\n");
    study_brain("", Sweep::Path::middles, Partners::facing);
  }
  const std::vector<std::pair<std::string, Solid>> solids = {{"onion", onion}, {"wood", wood}, {"citrus", citrus}};
  for (const auto& [name, solid] : solids)
    if (is_asked(name))
      study_solid(name, solid, folder);
  return 0;
}
