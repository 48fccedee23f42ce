#include "warp/match.h"

#include "base/error.h"
#include "image/filters.h"
#include "warp/minimise.h"

#include <Eigen/LU>

#include <cmath>
#include <string>

namespace kerf::warp {

namespace {

using image::Grey;

/// Both channels scaled so that their mean square, about their common mean, is weight^2.
void add_channel(FeatureLevel& level, Grey a, Grey b, const double weight) {
  double n = 0, sum = 0, squares = 0;
  for (const Grey* grey : {&a, &b})
    for (const float value : grey->values) {
      ++n;
      sum += value;
      squares += double(value) * value;
    }
  const double variance = squares / n - (sum / n) * (sum / n);
  if (!(variance > 1e-12) || weight == 0)
    return;
  const auto scale = static_cast<float>(weight / std::sqrt(variance));
  for (Grey* grey : {&a, &b})
    for (float& value : grey->values)
      value *= scale;
  level.a.push_back(std::move(a));
  level.b.push_back(std::move(b));
}

struct Channels {
  Grey edges, brightness, outline;
};

Channels channels(const image::Colours& blurred, const Grey& mask, const int level) {
  const int step = 1 << std::max(0, level - 1); // a blur of 2^(level - 1) pixels bears that spacing
  const int width = std::max(4, blurred.width / step), height = std::max(4, blurred.height / step);
  const double sigma = level > 0 ? std::ldexp(1.0, level - 1) : 0.5;
  return {image::resized(image::edge_strength(blurred), width, height),
          image::resized(image::luminance(blurred), width, height),
          image::resized(image::blurred(mask, sigma), width, height)};
}

void check(const Picture& a, const Picture& b, const MatchOptions& options) {
  const int width = a.colours.width, height = a.colours.height;
  if (b.colours.width != width || b.colours.height != height || std::min(width, height) < 4)
    throw ParameterError(Complaint{.path = "pictures to match",
                                   .value = std::to_string(width) + " x " + std::to_string(height),
                                   .rule = "must be of one size, at least 4 x 4 pixels",
                                   .remedy = "Sample both over the same number of pixels"});
  const auto is_inside = [&](const Vec2& p) {
    return p[0] >= 0 && p[1] >= 0 && p[0] <= width - 1 && p[1] <= height - 1;
  };
  for (const Pin& pin : options.pins)
    if (!is_inside(pin.from) || !is_inside(pin.to))
      throw ParameterError(
        Complaint{.path = "Pin", .rule = "a pinned point must lie inside both sections", .remedy = "Move it inside"});
}

/// Cells of a level's lattice along x and y.
std::array<int, 2> n_cells(const Picture& a, const MatchOptions& options, const int level) {
  const double longest = std::max(a.colours.width, a.colours.height);
  const auto along = [&](const int size) {
    const double n = options.n_cells * size / longest / std::ldexp(1.0, level);
    return std::max(2, 2 * static_cast<int>(std::lround(0.5 * n)));
  };
  return {along(a.colours.width), along(a.colours.height)};
}

/// The mean Jacobian over the lattice, and of it what is to be taken out.
Mat2 global_motion(const LatticeMap& map, const Global global) {
  Mat2 sum = Mat2::Zero();
  for (int r = 0; r + 1 < map.n_rows; ++r)
    for (int c = 0; c + 1 < map.n_columns; ++c)
      sum += map.gradient(map.source(c, r) + 0.5 * map.spacing());
  const Mat2 mean = sum / ((map.n_columns - 1) * (map.n_rows - 1));
  const Mat2 rotation = nearest_rotation(mean);
  return global == Global::rotation ? rotation : Mat2(std::sqrt(std::max(1e-6, mean.determinant())) * rotation);
}

void descend(Energy& energy, const MatchOptions& options, LatticeMap& map) {
  // The global motion is estimated again as the match proceeds.
  const int n_rounds = options.global == Global::none ? 1 : 5;
  for (int round = 0; round < n_rounds; ++round) {
    if (options.global != Global::none)
      energy.take_out(global_motion(map, options.global));
    Eigen::VectorXd x = to_unknowns(map);
    minimise(std::cref(energy), x, {.n_iterations = options.n_iterations});
    from_unknowns(x, map);
  }
}

} // namespace

std::vector<FeatureLevel> features(const Picture& a, const Picture& b, const MatchOptions& options) {
  const auto stack_a = image::gaussian_stack(a.colours, options.n_levels);
  const auto stack_b = image::gaussian_stack(b.colours, options.n_levels);
  std::vector<FeatureLevel> levels(options.n_levels);
  for (int k = 0; k < options.n_levels; ++k) {
    Channels of_a = channels(stack_a[k], a.mask, k), of_b = channels(stack_b[k], b.mask, k);
    add_channel(levels[k], std::move(of_a.edges), std::move(of_b.edges), options.edges);
    add_channel(levels[k], std::move(of_a.brightness), std::move(of_b.brightness), options.brightness);
    add_channel(levels[k], std::move(of_a.outline), std::move(of_b.outline), options.outline);
  }
  return levels;
}

LatticeMap match(const Picture& a, const Picture& b, const MatchOptions& options) {
  check(a, b, options);
  const auto levels = features(a, b, options);
  const Vec2 upper(a.colours.width - 1, a.colours.height - 1);
  EnergyOptions energy_options;
  energy_options.stiffness = options.stiffness;
  energy_options.border = options.global == Global::none ? Border::slides : Border::free;
  energy_options.pin_unit = 0.01 * upper.norm();
  LatticeMap map = lattice_of([](const Vec2& p) { return p; }, Vec2::Zero(), upper, 2, 2);
  for (int k = options.n_levels - 1; k >= 0; --k) {
    const auto [nx, ny] = n_cells(a, options, k);
    LatticeMap finer = lattice_of(map, Vec2::Zero(), upper, nx + 1, ny + 1);
    if (smallest_determinant(finer) > 0)
      map = std::move(
        finer); // sampling a map that bends much at other nodes may fold it: then the level keeps the old ones
    Energy energy(map, levels[k].a.empty() ? nullptr : &levels[k], options.pins, energy_options);
    descend(energy, options, map);
  }
  return map;
}

} // namespace kerf::warp
