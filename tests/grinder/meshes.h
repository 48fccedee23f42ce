#pragma once

/// The solids that are ground: closed meshes of a folder, whatever they look like.

#include "geometry/triangle_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kerf::grinder {

struct Solid {
  std::string name; ///< of its file, without the extension
  std::filesystem::path path;
  double volume = 0; ///< in units of the file, cubed
  Box box;           ///< in units of the file
  Points skin;       ///< points on it, evenly over its area, in units of the file
};

struct Solids {
  std::vector<Solid> usable;
  std::vector<std::string> refused; ///< what the program says of each of the others
};

/// All meshes of a folder, absolute paths, sorted by name.
Solids solids_in(const std::filesystem::path& folder);

} // namespace kerf::grinder
