#include "physics/bearers.h"

#include "grid/carriers.h"

#include <algorithm>
#include <ranges>

namespace kerf::physics {

namespace {

constexpr std::uint32_t itself = 0xffffffff;
constexpr double light = 1.0 / 64; // of a cube
constexpr int all_corners = 8;

} // namespace

std::vector<std::uint8_t> corners_of_cut_copies(const grid::Solid& solid, const surface::Surface& surface) {
  const grid::CellComplex& complex = solid.complex;
  std::vector<std::uint8_t> is_cut(complex.n_copies(), 0), all(complex.n_corners(), 1);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.labels[t] != grid::skin_label)
      is_cut[surface.copies[t].value] = 1;
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    if (is_cut[c.value] == 0)
      for (const grid::CornerId corner : complex.copies[c].corners)
        all[corner.value] = 0;
  return all;
}

Bearers::Bearers(const grid::Solid& solid, const std::span<const double> material,
                 const std::span<const std::uint8_t> may_be_light) {
  std::vector<std::uint8_t> has_enough(material.size());
  std::ranges::transform(material, has_enough.begin(), [](const double cubes) { return cubes >= light ? 1 : 0; });
  const auto is_light = [&](const std::size_t i) { return may_be_light[i] != 0 && has_enough[i] == 0; };
  if (std::ranges::none_of(std::views::iota(std::size_t(0), material.size()), is_light))
    return;
  const auto carrier = grid::nearest_carriers(solid.complex, has_enough, all_corners);
  const double h = solid.grid.h();
  const auto at_rest = [&](const grid::CornerId corner) { return solid.grid.position(solid.complex.node[corner]); };
  which_.assign(material.size(), itself);
  for (std::uint32_t i = 0; i < material.size(); ++i) {
    if (!is_light(i) || carrier[i] == grid::no_carrier)
      continue;
    const grid::Copy& copy = solid.complex.copies[grid::CopyId(carrier[i])];
    const Vec3 middle = solid.grid.origin(copy.cell) + Vec3::Constant(0.5 * h),
               slope = (at_rest(grid::CornerId(i)) - middle) / (2 * h * h);
    std::array<std::uint32_t, 8> corners;
    std::array<double, 8> weights;
    for (int v = 0; v < 8; ++v) {
      corners[v] = copy.corners[v].value;
      weights[v] = 0.125 + slope.dot(at_rest(copy.corners[v]) - middle);
    }
    which_[i] = static_cast<std::uint32_t>(rows_.n_points());
    rows_.add_row(corners, weights);
  }
}

Interpolation Bearers::carry(const Interpolation& of_corners) const {
  if (which_.empty())
    return of_corners;
  Interpolation points;
  std::vector<std::uint32_t> corners;
  std::vector<double> weights;
  for (std::size_t i = 0; i < of_corners.n_points(); ++i) {
    corners.clear();
    weights.clear();
    for (auto k = of_corners.start[i]; k < of_corners.start[i + 1]; ++k) {
      const std::uint32_t corner = of_corners.columns[k], row = which_[corner];
      if (row == itself) {
        corners.push_back(corner);
        weights.push_back(of_corners.values[k]);
        continue;
      }
      for (auto l = rows_.start[row]; l < rows_.start[row + 1]; ++l) {
        corners.push_back(rows_.columns[l]);
        weights.push_back(of_corners.values[k] * rows_.values[l]);
      }
    }
    points.add_row(corners, weights);
  }
  return points;
}

} // namespace kerf::physics
