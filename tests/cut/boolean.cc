#include "tests/cut/boolean.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/clip.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

namespace kerf::cut {

namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh mesh_of(const geometry::TriangleMesh& skin) {
  Mesh mesh;
  for (const Vec3& v : skin.vertices)
    mesh.add_vertex({v[0], v[1], v[2]});
  for (const auto& [a, b, c] : skin.triangles)
    mesh.add_face(Mesh::Vertex_index(a), Mesh::Vertex_index(b), Mesh::Vertex_index(c));
  return mesh;
}

Mesh on_lower_side(Mesh mesh, const Kernel::Plane_3& plane) {
  processing::clip(mesh, plane, CGAL::parameters::clip_volume(true).throw_on_self_intersection(true));
  return mesh;
}

void add_components(const Mesh& mesh, std::vector<double>& volumes) {
  std::vector<Mesh> components;
  processing::split_connected_components(mesh, components);
  for (const Mesh& component : components)
    volumes.push_back(CGAL::to_double(processing::volume(component)));
}

std::vector<double> volumes_between(const Mesh& skin, const std::vector<support::Plane>& planes) {
  std::vector<Mesh> parts = {skin};
  for (const auto& [n, offset] : planes) {
    std::vector<Mesh> next;
    const Kernel::Plane_3 plane(n[0], n[1], n[2], -offset);
    for (const Mesh& part : parts)
      for (const auto& side : {plane, plane.opposite()})
        if (Mesh of_side = on_lower_side(part, side); !of_side.is_empty())
          next.push_back(std::move(of_side));
    parts = std::move(next);
  }
  std::vector<double> volumes;
  for (const Mesh& part : parts)
    add_components(part, volumes);
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

Mesh intersection(Mesh solid, Mesh other) {
  Mesh common;
  processing::corefine_and_compute_intersection(solid, other, common,
                                                CGAL::parameters::throw_on_self_intersection(true));
  return common;
}

} // namespace

std::optional<std::vector<double>> volumes_beside(const geometry::TriangleMesh& skin,
                                                  const geometry::TriangleMesh& closed) {
  try {
    const Mesh solid = mesh_of(skin);
    Mesh inside = mesh_of(closed), outside = inside;
    processing::reverse_face_orientations(outside);
    std::vector<double> volumes;
    add_components(intersection(solid, inside), volumes);
    add_components(intersection(solid, outside), volumes);
    std::sort(volumes.begin(), volumes.end());
    return volumes;
  } catch (const processing::Corefinement::Self_intersection_exception&) {
    return std::nullopt;
  }
}

std::optional<double> volume_below(const geometry::TriangleMesh& skin, const support::Plane& plane) {
  try {
    const auto& [n, offset] = plane;
    return CGAL::to_double(processing::volume(on_lower_side(mesh_of(skin), {n[0], n[1], n[2], -offset})));
  } catch (const processing::Corefinement::Self_intersection_exception&) {
    return std::nullopt;
  }
}

std::optional<std::vector<double>> volumes_between(const geometry::TriangleMesh& skin,
                                                   const std::vector<support::Plane>& planes) {
  try {
    return volumes_between(mesh_of(skin), planes);
  } catch (const processing::Corefinement::Self_intersection_exception&) {
    return std::nullopt;
  }
}

} // namespace kerf::cut
