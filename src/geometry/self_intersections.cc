#include "geometry/solid.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

namespace kerf::geometry {

std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh) {
  using Surface = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
  Surface surface;
  for (const Vec3& v : mesh.vertices)
    surface.add_vertex({v[0], v[1], v[2]});
  for (const auto& [a, b, c] : mesh.triangles)
    surface.add_face(Surface::Vertex_index(a), Surface::Vertex_index(b), Surface::Vertex_index(c));

  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(found));
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const auto& [f, g] : found)
    pairs.push_back({std::min<std::uint32_t>(f, g), std::max<std::uint32_t>(f, g)});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

} // namespace kerf::geometry
