#include "tests/grinder/meshes.h"

#include "base/error.h"
#include "geometry/solid.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::grinder {

namespace {

bool is_mesh(const std::filesystem::path& path) {
  const std::string kind = path.extension().string();
  return kind == ".off" || kind == ".obj" || kind == ".stl" || kind == ".ply";
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file() && is_mesh(entry.path()))
      paths.push_back(std::filesystem::absolute(entry.path()));
  std::sort(paths.begin(), paths.end()); // a folder has no order of its own
  return paths;
}

/// Evenly over the area, at random places of a fixed seed.
Points points_on(const geometry::TriangleMesh& mesh, const std::size_t n) {
  std::vector<double> area;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = geometry::corners(mesh, i);
    area.push_back((b - a).cross(c - a).norm());
  }
  std::mt19937 random(1);
  std::discrete_distribution<std::size_t> triangle(area.begin(), area.end());
  std::uniform_real_distribution<double> uniform(0, 1);
  Points points;
  while (points.size() < n) {
    const auto [a, b, c] = geometry::corners(mesh, triangle(random));
    const double r = std::sqrt(uniform(random)), s = uniform(random);
    points.push_back((1 - r) * a + r * (1 - s) * b + r * s * c);
  }
  return points;
}

Solid solid(const std::filesystem::path& path) {
  const auto mesh = geometry::require_solid(geometry::read_mesh(path.string(), 1), path.string());
  return {path.stem().string(), path, geometry::volume(mesh), geometry::bounding_box(mesh), points_on(mesh, 500)};
}

} // namespace

Solids solids_in(const std::filesystem::path& folder) {
  Solids solids;
  for (const auto& path : files_in(folder)) {
    try {
      solids.usable.push_back(solid(path));
    } catch (const Error& error) {
      solids.refused.push_back(error.what());
    }
  }
  return solids;
}

} // namespace kerf::grinder
