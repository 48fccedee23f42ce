#include "tests/grinder/meshes.h"

#include "base/error.h"
#include "geometry/solid.h"

#include <algorithm>

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

Points every_nth(const Points& points, const std::size_t n_wanted) {
  Points some;
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / n_wanted)
    some.push_back(points[i]);
  return some;
}

Solid solid(const std::filesystem::path& path) {
  const auto mesh = geometry::require_solid(geometry::read_mesh(path.string(), 1), path.string());
  return {path.stem().string(), path, geometry::volume(mesh), geometry::bounding_box(mesh),
          every_nth(mesh.vertices, 200)};
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
