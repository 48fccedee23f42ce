#include "base/union_find.h"
#include "reference/mesh.h"

#include <algorithm>
#include <map>
#include <set>

namespace kerf::reference {

namespace {

using Face = std::vector<std::uint32_t>; // vertices, ascending

std::vector<Face> faces_of(const Mesh& mesh, const std::size_t cell) {
  const std::vector<std::vector<std::size_t>> local =
    mesh.dimension == 2 ? std::vector<std::vector<std::size_t>>{{0, 2}, {1, 3}, {0, 1}, {2, 3}}
                        : std::vector<std::vector<std::size_t>>{{0, 2, 4, 6}, {1, 3, 5, 7}, {0, 1, 4, 5},
                                                                {2, 3, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};
  std::vector<Face> faces;
  for (const auto& vertices : local) {
    Face face;
    for (const std::size_t i : vertices)
      face.push_back(mesh.cells[cell][i]);
    std::sort(face.begin(), face.end());
    faces.push_back(face);
  }
  return faces;
}

bool contains(const Face& face, const std::uint32_t vertex) {
  return std::binary_search(face.begin(), face.end(), vertex);
}

/// Gives the cells around a vertex that do not hang together by faces that are whole a vertex each; the first group
/// keeps it.
void part_at(Mesh& mesh, const std::uint32_t vertex, const std::vector<std::size_t>& cells,
             const std::vector<std::vector<Face>>& faces, const std::set<Face>& parted) {
  UnionFind groups(cells.size());
  std::map<Face, std::uint32_t> first;
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    for (const Face& face : faces[cells[i]])
      if (contains(face, vertex) && !parted.count(face))
        groups.unite(first.emplace(face, i).first->second, i);
  std::map<std::uint32_t, std::uint32_t> vertex_of = {{groups.root(0), vertex}};
  for (std::uint32_t i = 1; i < cells.size(); ++i) {
    const auto [it, is_new] = vertex_of.emplace(groups.root(i), static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new)
      mesh.vertices.push_back(Vec3(mesh.vertices[vertex]));
    std::replace(mesh.cells[cells[i]].begin(), mesh.cells[cells[i]].end(), vertex, it->second);
  }
}

} // namespace

std::size_t split(Mesh& mesh, const Vec3& point, const Vec3& normal, const std::function<bool(const Vec3&)>& within) {
  const Vec3 n = normal.normalized();
  std::vector<std::vector<Face>> faces(mesh.cells.size());
  std::map<Face, int> n_cells;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const Face& face : faces[c] = faces_of(mesh, c))
      ++n_cells[face];
  const auto in_crack = [&](const std::uint32_t v) {
    const Vec3 X = mesh.vertices[v];
    return std::abs(n.dot(X - point)) < 1e-9 * (X - point).norm() + 1e-15 && within(X);
  };
  std::set<Face> parted;
  std::set<std::uint32_t> touched;
  for (const auto& [face, count] : n_cells)
    if (count == 2 && std::all_of(face.begin(), face.end(), in_crack)) {
      parted.insert(face);
      touched.insert(face.begin(), face.end());
    }
  std::map<std::uint32_t, std::vector<std::size_t>> around;
  const std::size_t n_corners = mesh.dimension == 2 ? 4 : 8;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; i < n_corners; ++i)
      if (touched.count(mesh.cells[c][i]))
        around[mesh.cells[c][i]].push_back(c);
  for (const auto& [vertex, cells] : around)
    part_at(mesh, vertex, cells, faces, parted);
  return parted.size();
}

} // namespace kerf::reference
