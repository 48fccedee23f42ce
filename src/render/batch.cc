#include "render/batch.h"

#include "base/error.h"
#include "render/blade.h"
#include "render/rod.h"
#include "render/shading.h"

#include <cmath>
#include <string>

namespace kerf::render {

namespace {

enum class Material { tissue, steel };

float to_linear(double srgb) {
  return static_cast<float>(srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4));
}

void check(const DrawnSurface& s, const std::string& name) {
  if (!s.labels.empty() && s.labels.size() != s.triangles.size())
    throw DataError({.path = name,
                     .value = std::to_string(s.labels.size()) + " labels",
                     .rule = "must have one label for each of its " + std::to_string(s.triangles.size()) + " triangles",
                     .remedy = "Give them all, or none for skin"});
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (const auto v : s.triangles[t])
      if (v >= s.positions.size())
        throw DataError({.path = name + ", triangle " + std::to_string(t),
                         .value = std::to_string(v),
                         .rule = "must be less than the number of vertices, " + std::to_string(s.positions.size()),
                         .remedy = "Correct the triangle"});
  for (std::size_t v = 0; v < s.positions.size(); ++v)
    if (!s.positions[v].allFinite())
      throw NumericalError(name + ", vertex " + std::to_string(v) +
                           ": the position is not finite, so the image cannot be drawn. Take a smaller time step");
}

/// What turns a mesh into vertices of a batch.
struct Appender {
  const Camera& camera;
  const Look& look;
  Batch& batch;
  Mat3 rotation; ///< world to view

  void add(const DrawnSurface& surface, Material material) {
    const ShadedMesh mesh = shade(surface.positions, surface.triangles, surface.labels);
    const auto first = static_cast<std::uint32_t>(batch.vertices.size() / Batch::n_floats);
    batch.vertices.reserve(batch.vertices.size() + Batch::n_floats * mesh.vertices.size());
    for (const ShadedVertex& v : mesh.vertices)
      add(surface.positions[v.vertex], v.normal, material == Material::steel ? look.blade : look.colour(v.label),
          material);
    for (const auto& [a, b, c] : mesh.triangles)
      batch.indices.insert(batch.indices.end(), {first + a, first + b, first + c});
  }

  void add(const Vec3& position, const Vec3& normal, const Vec3& colour, Material material) {
    // Relative to the eye before the step to floats: far from the world's origin these would be too coarse.
    const Vec3 p = rotation * (position - camera.eye);
    batch.bounds.extend(p);
    const Eigen::Vector3f q = p.cast<float>(), n = (rotation * normal).cast<float>();
    batch.vertices.insert(batch.vertices.end(),
                          {q[0], q[1], q[2], n[0], n[1], n[2], to_linear(colour[0]), to_linear(colour[1]),
                           to_linear(colour[2]), material == Material::steel ? 1.0f : 0.0f});
  }
};

} // namespace

Batch collect(const Camera& camera, const Look& look, const DrawnScene& scene) {
  Batch batch;
  Appender appender{camera, look, batch, view_matrix(camera).block<3, 3>(0, 0)};
  const auto add = [&](const DrawnSurface& surface, const std::string& name, const Material material) {
    check(surface, name);
    appender.add(surface, material);
  };
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i)
    add(scene.surfaces[i], "drawn surface " + std::to_string(i), Material::tissue);
  for (std::size_t i = 0; i < scene.blades.size(); ++i) {
    const ToolMesh mesh = blade_mesh(scene.blades[i].edge, scene.blades[i].spine);
    add({mesh.positions, mesh.triangles, mesh.labels}, "drawn blade " + std::to_string(i), Material::steel);
  }
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const ToolMesh mesh = rod_mesh(scene.rods[i].path, scene.rods[i].radius);
    add({mesh.positions, mesh.triangles, mesh.labels}, "drawn rod " + std::to_string(i), Material::steel);
  }
  return batch;
}

} // namespace kerf::render
