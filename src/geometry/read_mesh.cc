#include "base/error.h"
#include "geometry/mesh_fault.h"
#include "geometry/triangle_mesh.h"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>

namespace kerf::geometry {
namespace {

using FilePoint = CGAL::Simple_cartesian<double>::Point_3;
using Polygon = std::vector<std::size_t>;

struct Soup {
  std::vector<FilePoint> points;
  std::vector<Polygon> polygons;
};

[[noreturn]] void refuse(const std::string& path, const std::string& rule, const std::string& remedy) {
  throw DataError(Complaint{.file = path, .rule = rule, .remedy = remedy});
}

std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](const unsigned char c) { return std::tolower(c); });
  return text;
}

void require_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    refuse(path,
           std::filesystem::exists(path, error) ? "is not a file that holds a mesh" : "the mesh file does not exist",
           "Check the path");
  const std::array<std::string, 4> known = {".off", ".obj", ".stl", ".ply"};
  if (std::find(known.begin(), known.end(), extension(path)) == known.end())
    refuse(path, "the name must end in .off, .obj, .stl or .ply", "Convert the mesh to one of these");
}

/// " (line 12: ...)" where there is a line.
std::string in_fault(const std::string& path) {
  const auto fault = find_fault(path);
  return fault ? " (" + *fault + ")" : "";
}

Soup read_soup(const std::string& path) {
  const std::string remedy = "Open it in a mesh viewer and export it again";
  require_room_for_header(path);
  Soup soup;
  bool read = false;
  std::string reason = "its contents are not what its name promises";
  try {
    read = CGAL::IO::read_polygon_soup(path, soup.points, soup.polygons);
  } catch (const std::exception& error) {
    reason = error.what();
  }
  if (!read)
    refuse(path, "the mesh cannot be read: " + find_fault(path).value_or(reason), remedy);
  if (extension(path) == ".obj") // whose reader leaves out in silence what it does not understand
    if (const auto fault = find_fault(path))
      refuse(path, "the mesh cannot be read: " + *fault, remedy);
  if (soup.points.empty() || soup.polygons.empty())
    refuse(path,
           "the mesh is empty: " + std::to_string(soup.points.size()) + " vertices, " +
             std::to_string(soup.polygons.size()) + " faces",
           remedy);
  return soup;
}

Points scaled_points(const std::string& path, const Soup& soup, const double unit) {
  Points vertices;
  vertices.reserve(soup.points.size());
  for (const FilePoint& p : soup.points) {
    vertices.emplace_back(unit * p.x(), unit * p.y(), unit * p.z());
    if (!vertices.back().allFinite())
      refuse(path,
             "vertex " + std::to_string(vertices.size() - 1) + " has a coordinate that is not finite" + in_fault(path),
             "Repair or remove the vertex");
  }
  return vertices;
}

/// The triangles between polygon[start] and the polygon's edges; nothing when they overlap.
std::optional<std::vector<Triangle>> fan(const Points& vertices, const Polygon& polygon, const std::size_t start) {
  const auto at = [&](const std::size_t i) { return static_cast<std::uint32_t>(polygon[i % polygon.size()]); };
  Vec3 area = Vec3::Zero();
  std::vector<Triangle> triangles;
  std::vector<Vec3> normals;
  for (std::size_t i = start + 1; i + 1 < start + polygon.size(); ++i) {
    const Vec3& a = vertices[at(start)];
    normals.push_back((vertices[at(i)] - a).cross(vertices[at(i + 1)] - a));
    triangles.push_back({at(start), at(i), at(i + 1)});
    area += normals.back();
  }
  if (std::any_of(normals.begin(), normals.end(), [&](const Vec3& n) { return n.dot(area) <= 0; }))
    return std::nullopt;
  return triangles;
}

void append_triangles(const std::string& path, const Points& vertices, const Polygon& polygon,
                      std::vector<Triangle>& triangles) {
  if (polygon.size() == 3) { // without looking at its area: that is for require_solid() to judge
    triangles.push_back({static_cast<std::uint32_t>(polygon[0]), static_cast<std::uint32_t>(polygon[1]),
                         static_cast<std::uint32_t>(polygon[2])});
    return;
  }
  for (std::size_t start = 0; start < polygon.size(); ++start)
    if (const auto f = fan(vertices, polygon, start)) {
      triangles.insert(triangles.end(), f->begin(), f->end());
      return;
    }
  refuse(path, "a polygon of " + std::to_string(polygon.size()) + " corners cannot be triangulated from one of them",
         "Triangulate the mesh before");
}

/// STL stores three vertices a triangle: makes coinciding ones the same.
void merge_vertices(TriangleMesh& mesh) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::map<Vec3, std::uint32_t, decltype(less)> index(less);
  Points vertices;
  std::vector<std::uint32_t> merged;
  for (const Vec3& v : mesh.vertices) {
    const auto [position, is_new] = index.emplace(v, static_cast<std::uint32_t>(vertices.size()));
    if (is_new)
      vertices.push_back(v);
    merged.push_back(position->second);
  }
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle)
      v = merged[v];
  mesh.vertices = std::move(vertices);
}

} // namespace

TriangleMesh read_mesh(const std::string& path, const double unit) {
  require_file(path);
  const Soup soup = read_soup(path);
  TriangleMesh mesh{scaled_points(path, soup, unit), {}};
  mesh.triangles.reserve(soup.polygons.size());
  for (const Polygon& polygon : soup.polygons) {
    if (std::any_of(polygon.begin(), polygon.end(), [&](const std::size_t v) { return v >= mesh.vertices.size(); }))
      refuse(path, "a face names a vertex that does not exist" + in_fault(path), "Export the mesh again");
    append_triangles(path, mesh.vertices, polygon, mesh.triangles);
  }
  if (extension(path) == ".stl")
    merge_vertices(mesh);
  return mesh;
}

} // namespace kerf::geometry
