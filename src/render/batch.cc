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

void check_samples(const DrawnSurface& s, const std::string& name) {
  const DrawnSamples& samples = s.samples;
  const auto refuse = [&](const std::string& rule) {
    throw DataError({.path = name + ", samples", .rule = rule, .remedy = "Hand over arrays that fit each other"});
  };
  if (samples.first.empty())
    return;
  if (samples.first.size() != s.triangles.size() || samples.parts.size() != s.triangles.size())
    refuse("must name a first sample and a number of parts for each triangle");
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const std::size_t n = samples.parts[t], end = samples.first[t] + (n + 1) * (n + 2) / 2;
    if (samples.first[t] != DrawnSamples::none &&
        (n < 1 || end > samples.colours.size() || (!samples.slopes.empty() && end > samples.slopes.size())))
      refuse("triangle " + std::to_string(t) + " has too few");
  }
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
  check_samples(s, name);
  for (std::size_t v = 0; v < s.positions.size(); ++v)
    if (!s.positions[v].allFinite())
      throw NumericalError(name + ", vertex " + std::to_string(v) +
                           ": the position is not finite, so the image cannot be drawn. Take a smaller time step");
}

/// The normal of a relief that rises by slopes along u and v.
Vec3 bent(const Vec3& normal, const Vec3& u, const Vec3& v, const std::array<float, 2>& slopes) {
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-12 * uu * vv))
    return normal;
  const double a = (vv * slopes[0] - uv * slopes[1]) / determinant, b = (uu * slopes[1] - uv * slopes[0]) / determinant;
  return (normal - a * u - b * v).normalized();
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
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      if (!surface.samples.first.empty() && surface.samples.first[t] != DrawnSamples::none)
        add_samples(surface, mesh, t);
      else
        batch.indices.insert(batch.indices.end(), {first + a, first + b, first + c});
    }
  }

  /// The triangle in as many as its samples span.
  void add_samples(const DrawnSurface& surface, const ShadedMesh& mesh, const std::size_t t) {
    const auto first = static_cast<std::uint32_t>(batch.vertices.size() / Batch::n_floats);
    const DrawnSamples& samples = surface.samples;
    const int n = samples.parts[t];
    const std::array<Vec3, 3> x = {surface.positions[surface.triangles[t][0]],
                                   surface.positions[surface.triangles[t][1]],
                                   surface.positions[surface.triangles[t][2]]};
    const auto normal = [&](const int corner) { return mesh.vertices[mesh.triangles[t][corner]].normal; };
    const Vec3 u = x[1] - x[0], v = x[2] - x[0], du = normal(1) - normal(0), dv = normal(2) - normal(0);
    std::size_t sample = samples.first[t];
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j, ++sample) {
        const double a = double(i) / n, b = double(j) / n;
        Vec3 shaded = (normal(0) + a * du + b * dv).normalized();
        if (!samples.slopes.empty())
          shaded = bent(shaded, u, v, samples.slopes[sample]);
        const auto& [red, green, blue] = samples.colours[sample];
        add(x[0] + a * u + b * v, shaded, Vec3(red, green, blue) / 255, Material::tissue);
      }
    connect(first, n);
  }

  /// The triangles between lattice points numbered as samples are.
  void connect(const std::uint32_t first, const int n) {
    std::uint32_t row = first; // of the points with the same i
    for (int i = 0; i < n; ++i) {
      const auto length = static_cast<std::uint32_t>(n - i + 1);
      for (std::uint32_t j = 0; j + 1 < length; ++j) {
        const std::uint32_t at = row + j, across = row + length + j;
        batch.indices.insert(batch.indices.end(), {at, across, at + 1});
        if (j + 2 < length)
          batch.indices.insert(batch.indices.end(), {across, across + 1, at + 1});
      }
      row += length;
    }
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
    add({mesh.positions, mesh.triangles, mesh.labels, {}}, "drawn blade " + std::to_string(i), Material::steel);
  }
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const ToolMesh mesh = rod_mesh(scene.rods[i].path, scene.rods[i].radius);
    add({mesh.positions, mesh.triangles, mesh.labels, {}}, "drawn rod " + std::to_string(i), Material::steel);
  }
  return batch;
}

} // namespace kerf::render
