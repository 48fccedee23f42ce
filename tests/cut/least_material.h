#pragma once

/// The least material that a copy has where blades have cut the skin, in all and at a corner.

#include "grid/material.h"
#include "grid/parts.h"
#include "grid/shape.h"

#include <algorithm>
#include <array>
#include <ostream>

namespace kerf::cut {

constexpr double round_off = 1e-13; ///< of what is below [h^3]

struct LeastMaterial {
  std::size_t n_copies = 0;
  double of_copies = 1, at_corners = 1; ///< [h^3]

  void look_at(const grid::Solid& solid) {
    for (const grid::Copy& copy : solid.complex.copies)
      if (grid::cuts_of_copies(solid, copy.cell).is_cut_at_skin())
        look_at(solid, copy);
  }

 private:
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
    ++n_copies;
    of_copies = std::min(of_copies, sum);
    at_corners = std::min(at_corners, *std::ranges::min_element(at_corner));
  }
};

inline std::ostream& operator<<(std::ostream& out, const LeastMaterial& least) {
  return out << least.n_copies << " copies under the skin, the least with " << least.of_copies << " cubes, at a corner "
             << least.at_corners;
}

} // namespace kerf::cut
