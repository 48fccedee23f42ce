#include "pba/phyxels.h"

#include "base/error.h"
#include "base/parallel.h"
#include "grid/locate.h"
#include "pba/point_grid.h"
#include "pba/region.h"

#include <cmath>
#include <numeric>

namespace kerf::pba {

namespace {

constexpr std::size_t many_parts = 256; // points from which on a second thread pays

/// Cube root of a point's share of the box around all of them; positive whatever they are.
double mean_spacing(const Points& points) {
  Vec3 lower = points[0], upper = points[0];
  for (const Vec3& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  const double size = std::max((upper - lower).maxCoeff(), 1e-12);
  return std::cbrt((upper - lower).cwiseMax(0.1 * size).prod() / static_cast<double>(points.size()));
}

double support_of(const Vec3& p, const PointGrid& grid, const PhyxelOptions& options) {
  const auto n = static_cast<std::size_t>(options.n_neighbours) + 1; // beside the point itself
  const auto distances = grid.nearest_distances(p, n + 1);
  if (options.support > 0)
    return options.support;
  return distances.size() <= n ? 1.5 * distances.back() : 0.5 * (distances[n - 1] + distances[n]);
}

void check_support(const Vec3& p, const double support, const PointGrid& grid, const PhyxelOptions& options) {
  const double nearest = grid.nearest_distances(p, 2).back();
  if (support > nearest && nearest > 0)
    return;
  const std::string spacing = "the nearest phyxel lies at a distance of " + to_text(nearest) + " m";
  throw ParameterError({.path = options.support > 0 ? "Support [m]" : "Neighbours [1]",
                        .value = options.support > 0 ? to_text(options.support) : std::to_string(options.n_neighbours),
                        .rule = "every phyxel must have others within its support, but " + spacing,
                        .remedy = "Use a larger support (0 takes the nearest phyxels), or a smaller Spacing"});
}

} // namespace

double front_lag(const Phyxels& phyxels) {
  constexpr double distances = 0.4;
  const double volume = std::accumulate(phyxels.volume.begin(), phyxels.volume.end(), 0.0);
  return distances * std::cbrt(volume / static_cast<double>(phyxels.size()));
}

std::vector<double> voronoi_volumes(const Points& points, const std::vector<Crumb>& parts) {
  const PointGrid grid(points, mean_spacing(points));
  std::vector<std::uint32_t> nearest(parts.size());
  parallel_for(
    parts.size(), [&](const std::size_t i) { nearest[i] = grid.nearest(parts[i].centre); }, many_parts);
  std::vector<double> volumes(points.size(), 0.0);
  double total = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    volumes[nearest[i]] += parts[i].volume;
    total += parts[i].volume;
  }
  constexpr double floor = 1e-3;
  for (double& volume : volumes)
    volume = std::max(volume, floor * total / static_cast<double>(points.size()));
  const double scale = total / std::accumulate(volumes.begin(), volumes.end(), 0.0);
  for (double& volume : volumes)
    volume *= scale;
  return volumes;
}

std::vector<double> make_supports(const Points& points, const PhyxelOptions& options) {
  const PointGrid grid(points, 2 * mean_spacing(points));
  std::vector<double> supports(points.size());
  parallel_for(
    points.size(), [&](const std::size_t i) { supports[i] = support_of(points[i], grid, options); }, many_parts);
  for (std::size_t i = 0; i < points.size(); ++i)
    check_support(points[i], supports[i], grid, options);
  return supports;
}

Phyxels fill(const grid::Solid& solid, const PhyxelOptions& options) {
  SamplingOptions sampling = options.sampling;
  if (sampling.spacing == 0)
    sampling.spacing = solid.grid.h();
  const auto inside = [&](const Vec3& p) { return copy_around(solid, p).valid(); };
  Phyxels phyxels;
  phyxels.rest = sample(bounds(solid), inside, sampling);
  constexpr std::size_t fewest = 4; // a gradient in space takes three neighbours
  if (phyxels.size() < fewest)
    throw ParameterError({.path = "Spacing [m]",
                          .value = to_text(sampling.spacing),
                          .rule = "the body must hold at least 4 phyxels, and holds " + std::to_string(phyxels.size()),
                          .remedy = "Use a smaller spacing"});
  phyxels.volume = voronoi_volumes(phyxels.rest, crumbs(solid, 0.5 * sampling.spacing));
  phyxels.support = make_supports(phyxels.rest, options);
  return phyxels;
}

} // namespace kerf::pba
