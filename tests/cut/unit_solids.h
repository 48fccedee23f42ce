#pragma once

/// The solids of a folder of meshes, each in the unit cube.

#include "base/error.h"
#include "geometry/box_tree.h"
#include "geometry/solid.h"
#include "tests/support/checkout.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerf::cut {

inline std::vector<std::filesystem::path> meshes(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".off")
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

/// The mesh in the unit cube; nothing where it cannot be read, or is not the skin of a solid.
inline std::optional<geometry::TriangleMesh> unit_mesh(const std::filesystem::path& path) {
  geometry::TriangleMesh mesh;
  try {
    mesh = geometry::require_solid(geometry::read_mesh(path, 1), path);
  } catch (const DataError&) {
    return std::nullopt;
  }
  const Box around = geometry::box_around(mesh.vertices);
  const double length = (around.upper - around.lower).maxCoeff();
  for (Vec3& v : mesh.vertices)
    v = (v - around.lower) / length;
  return mesh;
}

inline std::vector<std::pair<std::string, geometry::TriangleMesh>> unit_solids(const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, geometry::TriangleMesh>> solids;
  for (const auto& path : meshes(folder))
    if (auto mesh = unit_mesh(path))
      solids.emplace_back(path.stem(), std::move(*mesh));
  return solids;
}

/// The one that KERF_STROKE_MESHES names, else that of the example scenes.
inline std::filesystem::path folder_of_meshes() {
  const char* const folder = std::getenv("KERF_STROKE_MESHES");
  return folder ? folder : support::checkout() + "/params/meshes";
}

} // namespace kerf::cut
