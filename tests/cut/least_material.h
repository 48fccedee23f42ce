#pragma once

/// The least material that a copy has where blades have cut the skin, in all and at a corner, and the least square of a
/// trilinear field over it.

#include "grid/material.h"
#include "grid/parts.h"
#include "grid/shape.h"
#include "tests/support/spectrum.h"

#include <algorithm>
#include <array>
#include <ostream>

namespace kerf::cut {

constexpr double round_off = 1e-13;    ///< of what is below [h^3]
constexpr double least_square = -1e-12; ///< that may be for it

struct LeastMaterial {
  std::size_t n_copies = 0;
  double of_copies = 1, at_corners = 1; ///< [h^3]
  double of_squares = 1;                ///< of fields whose values at the corners have squares that sum to 1 [h^3]

  void look_at(const grid::Solid& solid) {
    for (const grid::Copy& copy : solid.complex.copies)
      if (grid::cuts_of_copies(solid, copy.cell).is_cut_at_skin())
        look_at(solid, copy);
  }
  void look_at(const grid::Solid& solid, const grid::Copy& copy) {
    std::array<double, 8> at_corner{};
    double sum = 0;
    const auto add = [&](const Vec3& p, const double volume) {
      for (int v = 0; v < 8; ++v)
        at_corner[v] += volume * grid::shape(v, p);
    };
    grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) { // a rule that is exact for cubics
      const double volume = grid::volume(t);
      const Vec3 centre = 0.25 * (t[0] + t[1] + t[2] + t[3]);
      add(centre, -0.8 * volume);
      for (const Vec3& p : t)
        add(centre + (p - centre) / 3, 0.45 * volume);
      sum += volume;
    });
    Eigen::Matrix<double, 8, 8> products = Eigen::Matrix<double, 8, 8>::Zero();
    grid::for_each_tetrahedron(solid, copy,
                               [&](const grid::Tetrahedron& t, int) { grid::add_shape_products(t, products); });
    of_squares = std::min(of_squares, support::spectrum(products)[0]);
    ++n_copies;
    of_copies = std::min(of_copies, sum);
    at_corners = std::min(at_corners, *std::ranges::min_element(at_corner));
  }
};

inline std::ostream& operator<<(std::ostream& out, const LeastMaterial& least) {
  return out << least.n_copies << " copies under the skin, the least with " << least.of_copies << " cubes, at a corner "
             << least.at_corners << ", of squares " << least.of_squares;
}

} // namespace kerf::cut
