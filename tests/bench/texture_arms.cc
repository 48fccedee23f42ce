/// Bodies with arms and bays between four parallel sections of a procedural solid, along each axis of the mesh: how far
/// points a pixel apart are drawn apart on their way to the sections, and PSNR [dB] against the truth.
///
///     bench_texture_arms [each] MESH...
///
/// each: components of a section one by one, not together.

#include "image/compare.h"
#include "tests/texture/solids.h"

#include <cstdio>
#include <string>

namespace {

using namespace kerf;
using namespace kerf::texture;

constexpr int n = 200;
constexpr double half = 0.045, pixel = 2 * half / (n - 1);

/// The mesh, around the origin, .08 m long.
geometry::TriangleMesh centred(const std::string& path, Vec3& extent) {
  geometry::TriangleMesh body = geometry::read_mesh(path, 1);
  Vec3 lower = Vec3::Constant(1e300), upper = -lower;
  for (const Vec3& v : body.vertices) {
    lower = lower.cwiseMin(v);
    upper = upper.cwiseMax(v);
  }
  const double scale = 0.08 / (upper - lower).maxCoeff();
  for (Vec3& v : body.vertices)
    v = scale * (v - 0.5 * (lower + upper));
  extent = 0.5 * scale * (upper - lower);
  return body;
}

/// How far source points of any weight worth it lie apart [pixels].
double apart(const Blend& a, const Blend& b) {
  constexpr float worth = 0.1f;
  double most = 0;
  for (int i = 0; i < a.n && a.cell == b.cell; ++i)
    if (a.weights[i] > worth)
      most = std::max<double>(most, std::hypot(a.x[i] - b.x[i], a.y[i] - b.y[i]));
  return most;
}

void measure(const std::string& path, const int axis, const Components components) {
  Vec3 extent;
  const geometry::TriangleMesh body = centred(path, extent);
  const Vec3 z = Vec3::Unit(axis), y = Vec3::Unit((axis + 2) % 3),
             x = (Vec3::Unit((axis + 1) % 3) + 0.1 * z).normalized();
  std::vector<Exemplar> exemplars;
  for (const double place : {-0.8, -0.8 / 3, 0.8 / 3, 0.8})
    exemplars.push_back(exemplar_of("e" + std::to_string(exemplars.size()), wood, (place * extent[axis] + 1e-5) * z,
                                    Vec3::Unit((axis + 1) % 3), y, n, half));
  InteriorOptions options;
  options.components = components;
  const Interior inside(exemplars, body, options);
  double n_points = 0, n_far = 0, most = 0, blend = 0, first_order = 0;
  for (const double place : {-0.55, -0.2, 0.15, 0.5}) {
    const Patch patch{place * extent[axis] * z - half * (x + y), pixel * x, pixel * y, n, n};
    const auto mixed = picture_of(inside, body, patch, nullptr, {.morph = Morph::blend});
    const auto warped = picture_of(inside, body, patch, nullptr, {});
    image::Colours truth = mixed.colours;
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c)
        truth(c, r) = wood(patch.point(c, r));
    blend += image::psnr(mixed.colours, truth, mixed.alpha) / 4;
    first_order += image::psnr(warped.colours, truth, mixed.alpha) / 4;
    for (int r = 0; r + 1 < n; ++r)
      for (int c = 0; c + 1 < n; ++c) {
        if (!(mixed.alpha(c, r) > 0 && mixed.alpha(c + 1, r) > 0 && mixed.alpha(c, r + 1) > 0))
          continue;
        const auto at = [&](const int column, const int row) {
          return inside.blend(patch.point(column, row), {.morph = Morph::blend});
        };
        const Blend own = at(c, r);
        const double far = std::max(apart(own, at(c + 1, r)), apart(own, at(c, r + 1)));
        ++n_points;
        n_far += far > 4 ? 1 : 0;
        most = std::max(most, far);
      }
  }
  std::printf("%-40s %c: more than 4 pixels apart %6.3f %%, at most %5.1f; PSNR of blend %.2f, first order %.2f dB\n",
              path.c_str(), "xyz"[axis], 100 * n_far / n_points, most, blend, first_order);
}

} // namespace

int main(const int argc, char** const argv) {
  const bool each = argc > 1 && argv[1] == std::string("each");
  for (int i = each ? 2 : 1; i < argc; ++i)
    for (int axis = 0; axis < 3; ++axis)
      measure(argv[i], axis, each ? Components::each : Components::together);
  return 0;
}
