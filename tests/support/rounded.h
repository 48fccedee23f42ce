#pragma once

/// Volume and area that a curved cut surface encloses in a body, against the exact values.

#include "cut/cut_surface.h"
#include "tests/support/cut_by_plane.h"

#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace kerf::support {

/// A closed surface that cuts a part out of a body.
struct RoundCut {
  const char* name;
  cut::Shape shape;
  std::function<double(const Vec3&)> height; ///< negative inside
  double volume, area;                       ///< exact [m^3], [m^2]
};

inline RoundCut round_cut(const char* name, const cut::Cylinder& rod, const double volume, const double area) {
  const auto height = [rod](const Vec3& p) {
    const double along = (p - rod.centre).dot(rod.axis);
    return std::max((p - rod.centre - along * rod.axis).norm() - rod.radius, std::abs(along) - 0.5 * rod.height);
  };
  return {name, rod, height, volume, area};
}

/// In the unit cube, off every lattice: nothing about them is a round number. A sphere; a cylinder that is smooth
/// inside the cube, as its ends are outside above z = 1 and below z = 0; and one with its sharp rims inside.
inline std::vector<RoundCut> round_cuts() {
  constexpr double pi = std::numbers::pi;
  const cut::Sphere ball{{0.5137, 0.4871, 0.5219}, 0.311};
  const auto height = [ball](const Vec3& p) { return (p - ball.centre).norm() - ball.radius; };
  const cut::Cylinder through{ball.centre, Vec3(0.21, -0.16, 1).normalized(), 0.227, 4};
  const double r = through.radius, length = 1 / through.axis[2]; // between two parallel planes
  const cut::Cylinder capped{ball.centre, Vec3(0.37, -0.52, 0.81).normalized(), r, 0.493};
  return {{"sphere", ball, height, 4 * pi / 3 * std::pow(ball.radius, 3), 4 * pi * ball.radius * ball.radius},
          round_cut("cylinder", through, pi * r * r * length, 2 * pi * r * length),
          round_cut("with rims", capped, pi * r * r * capped.height, 2 * pi * r * (r + capped.height))};
}

struct Enclosed {
  double volume = 0; ///< of the part that is cut out [m^3]
  double area = 0;   ///< of its surface as far as the cut made it [m^2]
};

/// Cuts a unit cube of cube edge h by the surface.
inline Enclosed cut_out(const RoundCut& round, const double h, const Vec3& offset) {
  Body body = with_copies(embedded(geometry::box_mesh(Vec3::Zero(), Vec3::Ones()), h, offset));
  const auto found = cut::cut_edges(cut::CutSurface{round.name, round.shape, 1}, body, grid::rest_positions(body));
  cut_through(body, found);
  const auto surface = surface::build_surface(body);
  Enclosed result;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const grid::Copy& copy = body.complex.copies[surface.copies[i]];
    if (round.height(point_in(body, copy)) >= 0)
      continue; // of the part around it: no copy has material on both sides
    const auto& [a, b, c] = surface.triangles[i];
    const Vec3 &p = surface.rest[a], &q = surface.rest[b], &s = surface.rest[c];
    result.volume += p.dot(q.cross(s)) / 6;
    if (surface.labels[i] == 1)
      result.area += 0.5 * (q - p).cross(s - p).norm();
  }
  return result;
}

/// Relative [1].
struct CutErrors {
  double volume = 0, area = 0;
};

/// Means over lattice offsets that follow from a fixed seed.
inline CutErrors mean_errors(const RoundCut& round, const double h, const int n_offsets) {
  Random random(81);
  CutErrors mean;
  for (int i = 0; i < n_offsets; ++i) {
    const Enclosed found = cut_out(round, h, random_offset(random));
    mean.volume += std::abs(found.volume / round.volume - 1) / n_offsets;
    mean.area += std::abs(found.area / round.area - 1) / n_offsets;
  }
  return mean;
}

} // namespace kerf::support
