#include "warp/match.h"

#include "base/error.h"
#include "image/filters.h"
#include "warp/minimise.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>
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

/// Energies of the maps both ways, and how they descend, at one level.
class Level {
 public:
  Level(const Picture& a, const FeatureLevel& features, const MatchOptions& options)
    : options_(options), forwards_(features), backwards_{features.b, features.a} {
    energy_.stiffness = options.stiffness;
    energy_.border = options.global == Global::none ? Border::slides : Border::free;
    energy_.pin_unit = 0.01 * Vec2(a.colours.width - 1, a.colours.height - 1).norm();
    for (const Pin& pin : options.pins)
      pins_back_.push_back({pin.to, pin.from});
  }

  void descend(BothWays& maps) const {
    descend(maps.there, forwards_, options_.pins);
    descend(maps.back, backwards_, pins_back_);
  }

  double energy(const BothWays& maps) const {
    return energy(maps.there, forwards_, options_.pins) + energy(maps.back, backwards_, pins_back_);
  }

 private:
  Energy energy_of(const LatticeMap& map, const FeatureLevel& features, const std::vector<Pin>& pins) const {
    Energy energy(map, features.a.empty() ? nullptr : &features, pins, energy_);
    if (options_.global != Global::none)
      energy.take_out(global_motion(map, options_.global));
    return energy;
  }

  double energy(const LatticeMap& map, const FeatureLevel& features, const std::vector<Pin>& pins) const {
    Eigen::VectorXd gradient;
    return energy_of(map, features, pins)(to_unknowns(map), gradient);
  }

  void descend(LatticeMap& map, const FeatureLevel& features, const std::vector<Pin>& pins) const {
    // The global motion is estimated again as the match proceeds.
    const int n_rounds = options_.global == Global::none ? 1 : 5;
    for (int round = 0; round < n_rounds; ++round) {
      const Energy energy = energy_of(map, features, pins);
      Eigen::VectorXd x = to_unknowns(map);
      minimise(std::cref(energy), x, {.n_iterations = options_.n_iterations});
      from_unknowns(x, map);
    }
  }

  const MatchOptions& options_;
  FeatureLevel forwards_, backwards_;
  EnergyOptions energy_;
  std::vector<Pin> pins_back_;
};

LatticeMap undone(const LatticeMap& map) { return inverse(map, map.lower, map.upper, map.n_columns, map.n_rows); }

LatticeMap midway(const LatticeMap& a, const LatticeMap& b) {
  LatticeMap middle = a;
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    middle.nodes[i] = 0.5 * (a.nodes[i] + b.nodes[i]);
  return middle;
}

/// Of two maps that were found each by itself: themselves, either one with what undoes it, or what lies midway,
/// whichever costs least. One that has grasped at the wrong feature is so put right by the other.
BothWays settled(const BothWays& found, const Level& level) {
  const BothWays by_there{found.there, undone(found.there)}, by_back{undone(found.back), found.back};
  const BothWays middle{midway(by_there.there, by_back.there), midway(by_there.back, by_back.back)};
  const BothWays* best = &found;
  double least = std::numeric_limits<double>::infinity();
  for (const BothWays* const maps : {&middle, &by_there, &by_back}) {
    const double energy = level.energy(*maps);
    if (energy < least) {
      least = energy;
      best = maps;
    }
  }
  return *best;
}

/// A map at the nodes of a finer lattice. One that bends much may fold there: then it keeps the old ones.
LatticeMap finer(const LatticeMap& map, const std::array<int, 2>& n) {
  LatticeMap result = lattice_of(map, map.lower, map.upper, n[0] + 1, n[1] + 1);
  return smallest_determinant(result) > 0 ? result : map;
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

BothWays match(const Picture& a, const Picture& b, const MatchOptions& options) {
  check(a, b, options);
  const auto levels = features(a, b, options);
  const Vec2 upper(a.colours.width - 1, a.colours.height - 1);
  const LatticeMap start = lattice_of([](const Vec2& p) { return p; }, Vec2::Zero(), upper, 2, 2);
  BothWays maps{start, start};
  for (int k = options.n_levels - 1; k >= 0; --k) {
    const auto n = n_cells(a, options, k);
    const Level level(a, levels[k], options);
    const auto descended = [&](const BothWays& from) {
      BothWays result{finer(from.there, n), finer(from.back, n)};
      level.descend(result);
      return settled(result, level);
    };
    maps = descended(maps);
    if (k == 0 && !options.pins.empty())
      level.descend(maps); // what undoes a map meets its pins to the lattice only
    if (k == 0 || k + 1 == options.n_levels)
      continue;
    // The coarser level may have led astray: rings that its blur mixes, or sections that shrink.
    if (const BothWays anew = descended({start, start}); level.energy(anew) < level.energy(maps))
      maps = anew;
  }
  return maps;
}

} // namespace kerf::warp
