#include "render/renderer.h"

#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/mesh.h"
#include "gl/program.h"
#include "render/batch.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace kerf::render {

namespace {

constexpr int samples_per_side = 2;
constexpr int shadow_map_size = 1024; ///< [texels]

// Directions to the lights in the view frame.
const Vec3 key_light = Vec3(-0.42, 0.78, 0.62).normalized();
const Vec3 fill_light = Vec3(0.80, 0.10, 0.60).normalized();

// Lengths relative to the height of the image at the target.
constexpr double occlusion_radius = 0.06, shadow_blur = 0.012;

double view_height(const Camera& camera) {
  return 2 * std::tan(camera.field_of_view * std::numbers::pi / 360) * (camera.target - camera.eye).norm();
}

/// The light's frame as an orthographic clip space that just holds the box.
struct LightFrame {
  Eigen::Matrix4d view_to_light;
  double width; ///< of the shadow map [m]
};

LightFrame light_frame(const Eigen::AlignedBox3d& bounds) {
  const Vec3 side = Vec3::UnitY().cross(key_light).normalized();
  Mat3 rotation;
  rotation << side.transpose(), key_light.cross(side).transpose(), -key_light.transpose();
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner)
    box.extend(rotation * bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  // Square, so that the blur is round; larger by a border, so that it never samples outside.
  const double width = 1.1 * std::max(box.sizes().maxCoeff(), 1e-12);
  LightFrame frame{Eigen::Matrix4d::Identity(), width};
  frame.view_to_light.block<3, 3>(0, 0) = 2 / width * rotation;
  frame.view_to_light.block<3, 1>(0, 3) = -2 / width * box.center();
  return frame;
}

/// Depths [m] between which everything visible lies; empty if all is behind the eye.
std::optional<Eigen::Vector2d> depth_range(const Eigen::AlignedBox3d& bounds) {
  const double nearest = -bounds.max().z(), farthest = -bounds.min().z();
  if (bounds.isEmpty() || !(farthest > 0))
    return std::nullopt;
  // Depth precision falls with far / near: what is closer to the eye than a thousandth is not shown.
  return Eigen::Vector2d(std::max(0.99 * nearest, 1e-3 * farthest), 1.01 * farthest);
}

} // namespace

/// What OpenGL holds for one renderer. The context comes first: it must outlive the rest.
struct Renderer::Passes {
  explicit Passes(const Camera& camera)
    : samples(
        {samples_per_side * camera.width, samples_per_side * camera.height, gl::Colour::rgba16f, gl::Depth::texture}),
      occlusion({camera.width, camera.height, gl::Colour::rg32f, gl::Depth::none}),
      image({camera.width, camera.height, gl::Colour::rgba8, gl::Depth::none}) {}
  ~Passes() = default;

  void draw_shadow_map(const LightFrame& light) const;
  void draw_solids(const Camera& camera, const LightFrame& light, const Eigen::Vector2d& depths) const;
  void draw_occlusion(const Camera& camera, const Eigen::Vector2d& depths) const;
  void resolve(const Camera& camera, const Look& look) const;

  gl::Context context;
  gl::Program shadow_program{"shadow.vert", "shadow.frag"};
  gl::Program solid_program{"solid.vert", "solid.frag"};
  gl::Program occlusion_program{"screen.vert", "occlusion.frag"};
  gl::Program resolve_program{"screen.vert", "resolve.frag"};
  gl::Framebuffer shadow_map{{shadow_map_size, shadow_map_size, gl::Colour::none, gl::Depth::shadow}};
  gl::Framebuffer samples, occlusion, image;
  gl::Mesh mesh{3, 3, 3, 1};
  gl::ScreenTriangle screen;
};

void Renderer::Passes::draw_shadow_map(const LightFrame& light) const {
  shadow_map.clear(Eigen::Vector4f::Zero());
  shadow_program.set("view_to_light", Eigen::Matrix4f(light.view_to_light.cast<float>()));
  mesh.draw();
}

void Renderer::Passes::draw_solids(const Camera& camera, const LightFrame& light, const Eigen::Vector2d& depths) const {
  const Eigen::Matrix4d projection = projection_matrix(camera, depths[0], depths[1]);
  const Vec3 up = view_matrix(camera).block<3, 3>(0, 0) * camera.up.normalized();
  // Below two texels the map's own steps would show.
  const double blur = std::max(shadow_blur * view_height(camera) / light.width, 2.0 / shadow_map_size);
  samples.bind();
  shadow_map.bind_depth(0);
  solid_program.set("shadow_map", 0);
  solid_program.set("projection", Eigen::Matrix4f(projection.cast<float>()));
  solid_program.set("view_to_light", Eigen::Matrix4f(light.view_to_light.cast<float>()));
  solid_program.set("key", Eigen::Vector3f(key_light.cast<float>()));
  solid_program.set("fill", Eigen::Vector3f(fill_light.cast<float>()));
  solid_program.set("up", Eigen::Vector3f(up.cast<float>()));
  solid_program.set("blur_radius", static_cast<float>(blur));
  mesh.draw();
}

void Renderer::Passes::draw_occlusion(const Camera& camera, const Eigen::Vector2d& depths) const {
  const double lens = std::tan(camera.field_of_view * std::numbers::pi / 360);
  occlusion.bind();
  samples.bind_depth(0);
  occlusion_program.set("depths", 0);
  occlusion_program.set("lens", Eigen::Vector2f(lens * camera.width / camera.height, lens));
  occlusion_program.set("planes", Eigen::Vector2f(depths.cast<float>()));
  occlusion_program.set("radius", static_cast<float>(occlusion_radius * view_height(camera)));
  occlusion_program.set("size", Eigen::Vector2f(camera.width, camera.height));
  screen.draw();
}

void Renderer::Passes::resolve(const Camera& camera, const Look& look) const {
  image.bind();
  samples.bind_colour(0);
  occlusion.bind_colour(1);
  resolve_program.set("samples", 0);
  resolve_program.set("occlusion", 1);
  resolve_program.set("radius", static_cast<float>(occlusion_radius * view_height(camera)));
  resolve_program.set("size", Eigen::Vector2f(camera.width, camera.height));
  resolve_program.set("top", Eigen::Vector3f(look.background_top.cast<float>()));
  resolve_program.set("bottom", Eigen::Vector3f(look.background_bottom.cast<float>()));
  screen.draw();
}

namespace {

/// OpenGL's rows run upwards and carry an alpha.
Image to_image(const gl::Framebuffer& framebuffer) {
  const auto rgba = framebuffer.read_rgba8();
  const int width = framebuffer.width(), height = framebuffer.height();
  Image image{width, height, {}};
  image.rgb.reserve(rgba.size() / 4 * 3);
  for (int row = height - 1; row >= 0; --row)
    for (int column = 0; column < width; ++column) {
      const auto* const p = &rgba[4 * (static_cast<std::size_t>(row) * width + column)];
      image.rgb.insert(image.rgb.end(), p, p + 3);
    }
  return image;
}

} // namespace

Renderer::Renderer(const Camera& camera, const Look& look) : camera_(camera), look_(look) {
  check(camera);
  passes_ = std::make_unique<Passes>(camera);
}

Renderer::~Renderer() {
  // What the passes hold is deleted in the context that is current.
  passes_->context.make_current();
}

Image Renderer::draw(const DrawnScene& scene) const {
  const Batch batch = collect(camera_, look_, scene);
  passes_->context.make_current();
  passes_->samples.clear(Eigen::Vector4f::Zero());
  if (const auto depths = depth_range(batch.bounds)) {
    const LightFrame light = light_frame(batch.bounds);
    passes_->mesh.upload(batch.vertices, batch.indices);
    passes_->draw_shadow_map(light);
    passes_->draw_solids(camera_, light, *depths);
    passes_->draw_occlusion(camera_, *depths);
  }
  passes_->resolve(camera_, look_);
  return to_image(passes_->image);
}

} // namespace kerf::render
