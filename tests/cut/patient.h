#pragma once

/// A body that is cut as scenes cut theirs, in steps, while it stands deformed; and a box to cut.

#include "cut/cutter.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <functional>
#include <numeric>

namespace kerf::cut {

using grid::EdgeCut;
using grid::EdgeId;
using support::Body;
using support::Random;
using support::random_direction;
using support::random_offset;
using support::uniform;

constexpr double h = 0.1;
inline const Box box{{0, 0, 0}, {0.73, 0.61, 0.52}};
inline const double box_volume = (box.upper - box.lower).prod(), cube = h * h * h;

inline Body box_body(Random& random) {
  return support::embedded(geometry::box_mesh(box.lower, box.upper), h, random_offset(random));
}

/// A map from where material rests to where it is now.
using Map = std::function<Vec3(const Vec3&)>;

/// A body and where its corners are, cut as scenes do.
struct Patient {
  Body body;
  Points x;

  explicit Patient(Body whole) : body(std::move(whole)) {
    body.complex = grid::build_complex(body);
    x = grid::rest_positions(body);
  }

  void deform(const Map& map) { std::transform(x.begin(), x.end(), x.begin(), map); }

  void follow(grid::CutChange&& change) { follow(change); }
  void follow(grid::CutChange& change) {
    surface::place(body, change, {});
    grid::inherit(change, x);
  }

  Cutter cutter(const grid::CutLabel label, const Release release = Release::queued) const {
    Cutter cutter(label, release, Fronts::of_elements);
    cutter.begin(body, x);
    return cutter;
  }

  void cut_through(const std::vector<EdgeCut>& cuts) { follow(cutter(1).cut(body, {cuts, {}, 0})); }
  void cut_through(const Shape& shape, const grid::CutLabel label = 1) {
    Cutter with = cutter(label);
    follow(with.at_once(body, {"", shape, label}, x));
  }

  /// The blade's whole motion, from 0 to 1 s, and a step of rest; until nothing waits.
  void pass(const Blade& blade, const int n_steps, const Release release) {
    Cutter with = cutter(blade.label, release);
    for (int k = 0; k <= n_steps || with.n_waiting() > 0; ++k)
      follow(with.step(body, std::span(&blade, 1), double(k) / n_steps, double(k + 1) / n_steps, x));
  }

  /// Is the complex, which each cut has brought up to date, the one that all cuts make?
  bool is_as_built() const { return support::renaming(body.complex, grid::build_complex(body)).has_value(); }

  /// Of each piece, ascending [m^3].
  std::vector<double> volumes() const {
    auto volumes = surface::piece_volumes(surface::build_surface(body), body.complex);
    std::sort(volumes.begin(), volumes.end());
    return volumes;
  }
};

/// A straight blade in a plane through `middle` with the directions u of its edge and v of its motion, as far as
/// `reach` either way and, along v, from -reach to `stop`.
inline Blade straight(const Vec3& middle, const Vec3& u, const Vec3& v, const double reach, const double stop,
                      const grid::CutLabel label = 1) {
  const Blade blade{.name = "straight",
                    .edge = {middle - reach * u - reach * v, middle + reach * u - reach * v},
                    .key_frames = {{0, Vec3::Zero(), Vec3::Zero()}, {1, (reach + stop) * v, Vec3::Zero()}},
                    .label = label};
  check(blade);
  return blade;
}

struct Frame {
  Vec3 u, v;
};

/// Two unit vectors across n, turned by an angle [rad].
inline Frame across(const Vec3& n, const double angle) {
  const Vec3 a = n.unitOrthogonal(), b = n.cross(a);
  return {std::cos(angle) * a + std::sin(angle) * b, std::cos(angle) * b - std::sin(angle) * a};
}

inline double total(const std::vector<double>& volumes) { return std::accumulate(volumes.begin(), volumes.end(), 0.0); }

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// In how many steps the i-th blade passes.
inline int steps(const int i) { return std::array{1, 7, 40, 150}[i % 4]; }

} // namespace kerf::cut
