#include "cut/in_plane.h"

#include "geometry/convex_hull.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf::cut {

InPlane::InPlane(const Vec3& point, const Vec3& normal, const double h)
  : origin(point), u(normal.unitOrthogonal() / h), v(normal.cross(u)), w(normal / h) {}

Polygon hull(const Points& points, const InPlane& in_plane) {
  std::vector<Eigen::Vector2d> flat;
  for (const Vec3& p : points)
    flat.push_back(in_plane(p).head<2>());
  Polygon hull;
  for (const Eigen::Vector2d& p : geometry::convex_hull(flat))
    hull.push_back(in_plane.point(p));
  return hull;
}

int draw(const Polygon& piece, const InPlane& in_plane, Raster& raster) {
  int n_new = 0;
  for (std::size_t i = 2; i < piece.size(); ++i)
    n_new += raster.draw({in_plane(piece[0]), in_plane(piece[i - 1]), in_plane(piece[i])}, off_plane);
  return n_new;
}

namespace {

using Flat = Eigen::Vector2d;

std::vector<Flat> texels(const Raster& raster) {
  std::vector<Flat> all;
  raster.for_each([&](const double x, const double y) { all.push_back({x, y}); });
  return all;
}

Flat mean_of(const std::vector<Flat>& points) {
  Flat sum = Flat::Zero();
  for (const Flat& p : points)
    sum += p;
  return sum / static_cast<double>(points.size());
}

std::optional<Flat> way(const Flat& from, const Flat& to) {
  const Flat along = to - from;
  return along.norm() > texel ? std::optional<Flat>(along.normalized()) : std::nullopt;
}

/// From the middle of a part of the section to that of all of it; none where they are the same.
std::optional<Flat> way_on(const std::vector<Flat>& section, const Raster& part) {
  const std::vector<Flat> of_part = texels(part);
  return of_part.empty() || of_part.size() == section.size() ? std::nullopt : way(mean_of(of_part), mean_of(section));
}

} // namespace

void put_end(const Raster& section, const Raster& come, const Raster& with_lag, const double h, grid::Front& front) {
  const InPlane in_plane(front.point, front.normal, h);
  const std::vector<Flat> all = texels(section);
  const Raster come_in = section & come;
  std::optional<Flat> on = way_on(all, come_in);
  if (!on && front.onward != Vec3::Zero())
    on = Flat(h * in_plane.u.dot(front.onward), h * in_plane.v.dot(front.onward));
  if (!on)
    on = way_on(all, section & with_lag);
  if (!on && come.any() && section.any())
    on = way(mean_of(texels(come)), mean_of(all));
  if (!on || all.empty())
    return;
  std::vector<double> along;
  for (const Flat& p : all)
    along.push_back(on->dot(p));
  const auto n = static_cast<std::ptrdiff_t>(come_in.count());
  if (n < std::ssize(along))
    std::ranges::nth_element(along, along.begin() + n);
  const double most_of_come = n > 0 ? *std::max_element(along.begin(), along.begin() + n) : along[0],
               least_ahead = n < std::ssize(along) ? along[static_cast<std::size_t>(n)] : most_of_come,
               end = n > 0 ? 0.5 * (most_of_come + least_ahead) : least_ahead;
  front.onward = (h * ((*on)[0] * in_plane.u + (*on)[1] * in_plane.v)).normalized();
  front.end = front.onward.dot(front.point) + h * end;
}

bool keep_farther_end(const grid::Front& earlier, const double h, grid::Front& moved) {
  constexpr double hardly = 0.1; // cubes
  if (earlier.onward == Vec3::Zero())
    return moved.onward == Vec3::Zero();
  const auto end = [](const grid::Front& front) { return front.end - front.onward.dot(front.point); };
  const bool is_farther = moved.passed >= earlier.passed && moved.onward != Vec3::Zero();
  if (is_farther && std::abs(end(moved) - end(earlier)) > hardly * h)
    return false;
  moved.onward = earlier.onward;
  moved.end = earlier.end;
  return true;
}

} // namespace kerf::cut
