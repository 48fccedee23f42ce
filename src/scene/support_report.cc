#include "scene/support_report.h"

#include "base/union_find.h"
#include "scene/composing.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace kerf::scene {

namespace {

std::string place_of(const Vec3& p) { return line("(", p[0], ", ", p[1], ", ", p[2], ")"); }

/// Held corners hang together where a copy has them both. Phyxels are not asked.
std::size_t n_pieces(const Body& body, const std::vector<std::uint32_t>& held) {
  std::vector<std::uint8_t> is_held(body.physics->rest().size(), 0);
  for (const auto i : held)
    is_held[i] = 1;
  UnionFind sets(is_held.size());
  for (const grid::Copy& copy : body.solid.complex.copies) {
    std::uint32_t first = grid::CornerId::no_value;
    for (const grid::CornerId corner : copy.corners)
      if (is_held[corner.value] != 0) {
        first = first == grid::CornerId::no_value ? corner.value : first;
        sets.unite(first, corner.value);
      }
  }
  std::set<std::uint32_t> roots;
  for (const auto i : held)
    roots.insert(sets.root(i));
  return roots.size();
}

std::string describe(const Body& body, const std::string& name, const std::vector<std::uint32_t>& held) {
  const bool of_corners = body.physics->particles_are_corners();
  const std::string what = of_corners ? " corners" : " phyxels", start = line("body ", body.name, ": support ", name);
  if (held.empty())
    return start + " holds no" + what;
  Points points;
  for (const auto i : held)
    points.push_back(body.physics->rest()[i]);
  const std::size_t n = of_corners ? n_pieces(body, held) : 0;
  return line(start, " holds ", held.size(), what, " ", extent(points)) +
         (n > 0 ? line(", in ", n, n == 1 ? " piece" : " pieces") : "");
}

/// Where the plane faces of a region are that lie across an axis; of spheres, meshes and oblique half spaces none [m].
std::vector<double> faces_across(const Region& region, const int axis) {
  if (const Box* const box = std::get_if<Box>(&region))
    return {box->lower[axis], box->upper[axis]};
  const HalfSpace* const half = std::get_if<HalfSpace>(&region);
  if (half && half->normal.cross(Vec3::Unit(axis)).norm() <= 1e-9 * half->normal.norm())
    return {half->point[axis]};
  return {};
}

/// Which faces of a region lie on a layer of nodes of the body.
std::vector<std::string> faces_on_layers(const Body& body, const Region& region) {
  constexpr double near = 1e-6;
  const grid::Lattice& lattice = body.solid.grid.lattice();
  const Points& rest = body.physics->rest();
  std::vector<std::string> faces;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] =
      std::minmax_element(rest.begin(), rest.end(), [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
    for (const double at : faces_across(region, axis)) {
      const double layers = (at - lattice.origin[axis]) / lattice.h;
      const bool is_in_body = at > (*least)[axis] - near * lattice.h && at < (*most)[axis] + near * lattice.h;
      if (is_in_body && std::abs(layers - std::round(layers)) < near)
        faces.push_back(line(std::string(1, "xyz"[axis]), " = ", at, " m"));
    }
  }
  return faces;
}

/// Whether a support holds corners, and all of them lie outside of the material, farther from it than a node may lie
/// that stands on the skin.
bool holds_no_material(const Body& body, const std::vector<std::uint32_t>& held) {
  constexpr double on_skin = 0.01; // of h
  const grid::Solid& solid = body.solid;
  std::vector<std::uint8_t> is_material(body.physics->rest().size(), 0);
  for (const grid::Copy& copy : solid.complex.copies) {
    for (int v = 0; v < 8; ++v)
      if ((copy.nodes >> v & 1) != 0)
        is_material[copy.corners[v].value] = 1;
    const auto edges = solid.grid.edges(copy.cell);
    for (int l = 0; l < 12; ++l) {
      const auto& [lower, upper] = grid::cube::line_vertices[l];
      const grid::EdgeCut* const cut = solid.cuts.find_outer(edges[l]);
      if (cut && (cut->t < on_skin || cut->t > 1 - on_skin))
        is_material[copy.corners[cut->t < 0.5 ? lower : upper].value] = 1;
    }
  }
  return !held.empty() &&
         std::none_of(held.begin(), held.end(), [&](const std::uint32_t i) { return is_material[i] != 0; });
}

} // namespace

std::string extent(const Points& points) {
  Vec3 lower = Vec3::Constant(1e300), upper = -lower;
  for (const Vec3& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  return line("from ", place_of(lower), " to ", place_of(upper), " m");
}

std::vector<std::string> warn_of_layers(const Body& body, const std::string& what, const Region& region) {
  std::vector<std::string> warnings;
  if (body.physics->particles_are_corners())
    for (const std::string& face : faces_on_layers(body, region))
      warnings.push_back(
        line("warning: body ", body.name, ": the face ", face, " of ", what,
             " lies on a layer of nodes, and round-off of the mesh decides whether it holds them. Move it by "
             "a part of a cube"));
  return warnings;
}

std::vector<std::string> describe_supports(const Body& body) {
  std::vector<std::string> lines, warnings;
  std::vector<std::uint8_t> held(body.physics->rest().size(), 0);
  for (std::size_t s = 0; s < body.regions.size(); ++s) {
    const SupportRegion& region = body.regions[s];
    const auto& corners = body.loads.supports[s].corners;
    lines.push_back(describe(body, region.name, corners));
    for (const auto i : corners)
      held[i] = 1;
    for (const std::string& warning : warn_of_layers(body, "support " + region.name, region.region))
      warnings.push_back(warning);
    if (body.physics->particles_are_corners() && holds_no_material(body, corners))
      warnings.push_back(
        line("warning: body ", body.name, ": all corners that support ", region.name,
             " holds lie outside of the material, which hangs by them too softly, as if it were up to some "
             "cubes longer. Write 'set Hold at = skin', or move a layer of nodes to the skin with Lattice "
             "offset"));
  }
  const Loan<std::uint8_t> in_all_directions = dynamics::held_corners(body.loads, held.size());
  const auto is_there = [](const auto h) { return h != 0; };
  if (std::all_of(held.begin(), held.end(), is_there) &&
      std::all_of(in_all_directions.begin(), in_all_directions.end(), is_there))
    warnings.push_back(line("warning: body ", body.name, ": its supports hold all of its ", held.size(),
                            body.physics->particles_are_corners() ? " corners" : " phyxels",
                            ", so nothing of it moves but as they do. Use smaller regions, smaller cubes, or more "
                            "phyxels"));
  lines.insert(lines.end(), warnings.begin(), warnings.end());
  return lines;
}

} // namespace kerf::scene
