#include "tests/fuzz/specimens.h"

#include "base/error.h"
#include "tests/support/checkout.h"
#include "tests/support/placed.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace kerf::fuzz {

namespace {

Specimen box(const std::string& name, const Vec3& size, const double h, const Vec3& offset) {
  return {name, support::embedded(geometry::box_mesh(Vec3::Zero(), size), h, offset)};
}

Specimen sphere(const std::string& name, const double h, const Vec3& offset) {
  return {name, support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), h, offset)};
}

/// So that the mesh encloses about `n_cubes`.
Specimen specimen(const std::string& name, const geometry::TriangleMesh& mesh, const double n_cubes) {
  const double h = std::cbrt(geometry::volume(mesh) / n_cubes);
  return {name, support::embedded(mesh, h, {0.5, 0.3, 0.1})};
}

bool is_mesh(const std::filesystem::path& path) {
  const std::string kind = path.extension().string();
  return kind == ".off" || kind == ".obj" || kind == ".stl" || kind == ".ply";
}

std::vector<std::filesystem::path> meshes_in(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file() && is_mesh(entry.path()))
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end()); // a folder has no order of its own
  return paths;
}

} // namespace

void add_meshes(const std::string& folder, Specimens& specimens) {
  for (const auto& path : meshes_in(folder)) {
    const std::string name = path.filename().string();
    try {
      const auto mesh = geometry::require_solid(geometry::read_mesh(path.string(), 1), path.string());
      specimens.small.push_back(specimen(name, mesh, 150));
      specimens.large.push_back(specimen("large " + name, mesh, 3000));
    } catch (const DataError& error) {
      specimens.skipped.push_back(error.what());
    }
  }
}

Specimens own_specimens() {
  Specimens all;
  const auto liver = support::liver_mesh();
  all.small.push_back(box("box on lattice planes", {0.5, 0.4, 0.3}, 0.1, Vec3::Zero()));
  all.small.push_back(box("box midway", {0.4, 0.4, 0.3}, 0.1, Vec3::Constant(0.5)));
  all.small.push_back(box("box anywhere", {0.53, 0.37, 0.31}, 0.1, {0.31, 0.83, 0.12}));
  all.small.push_back(box("cube in binary fractions", Vec3::Ones(), 0.25, Vec3::Zero()));
  all.small.push_back(box("plate of one node", {0.6, 0.6, 0.05}, 0.1, {0.5, 0.5, 0.25}));
  all.small.push_back(box("rod", {0.9, 0.1, 0.1}, 0.1, Vec3::Constant(0.5)));
  all.small.push_back(sphere("sphere", 0.37, Vec3::Zero()));
  all.small.push_back(sphere("sphere off the lattice", 0.41, {0.2, 0.4, 0.9}));
  all.small.push_back({"liver", support::embedded(liver, 0.032, {0.5, 0.3, 0.1})});
  all.small.push_back({"coarse liver", support::embedded(liver, 0.045, Vec3::Zero())});
  all.large.push_back(box("large box", {1.4, 1.3, 1.2}, 0.1, Vec3::Zero()));
  all.large.push_back(sphere("large sphere", 0.13, Vec3::Zero()));
  all.large.push_back({"large liver", support::embedded(liver, 0.011, {0.5, 0.3, 0.1})});
  add_meshes(support::checkout() + "/params/meshes", all);
  return all;
}

Specimen fine_sphere(const double h) {
  const auto mesh = geometry::sphere_mesh(1, Vec3::Zero(), 6);
  return {"sphere, h = " + std::to_string(h) + " R", support::embedded(mesh, h, {0.2, 0.4, 0.9})};
}

} // namespace kerf::fuzz
