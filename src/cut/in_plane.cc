#include "cut/in_plane.h"

#include "geometry/convex_hull.h"

#include <Eigen/Geometry>

#include <algorithm>
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

/// From the middle of a part of the section to that of the rest; none where one of them is empty.
std::optional<Flat> way_on(const std::vector<Flat>& section, const Raster& part) {
  Flat all = Flat::Zero(), come = Flat::Zero();
  for (const Flat& p : section)
    all += p;
  const std::vector<Flat> of_part = texels(part);
  for (const Flat& p : of_part)
    come += p;
  const auto n = static_cast<double>(section.size()), n_come = static_cast<double>(of_part.size());
  if (n_come == 0 || n_come == n)
    return {};
  const Flat way = (all - come) / (n - n_come) - come / n_come;
  return way.norm() > 0 ? std::optional<Flat>(way.normalized()) : std::nullopt;
}

} // namespace

void put_end(const Raster& section, const Raster& come, const Raster& with_lag, const double h, grid::Front& front) {
  const InPlane in_plane(front.point, front.normal, h);
  const std::vector<Flat> all = texels(section);
  const Raster come_in = section & come;
  std::optional<Flat> way = way_on(all, come_in);
  if (!way && front.onward != Vec3::Zero())
    way = Flat(h * in_plane.u.dot(front.onward), h * in_plane.v.dot(front.onward));
  if (!way)
    way = way_on(all, section & with_lag);
  if (!way || all.empty())
    return;
  std::vector<double> along;
  for (const Flat& p : all)
    along.push_back(way->dot(p));
  std::ranges::sort(along);
  const auto n = static_cast<std::size_t>(come_in.count());
  const double end = n == 0              ? along.front()
                     : n == along.size() ? along.back()
                                         : 0.5 * (along[n - 1] + along[n]);
  front.onward = (h * ((*way)[0] * in_plane.u + (*way)[1] * in_plane.v)).normalized();
  front.end = front.onward.dot(front.point) + h * end;
}

} // namespace kerf::cut
