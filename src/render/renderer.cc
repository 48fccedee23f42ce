#include "render/renderer.h"

#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/mesh.h"
#include "gl/program.h"
#include "gl/state.h"

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

/// The pixels that the triangles may meet, and a border as wide as the mean of resolve.frag reaches; all, if a vertex
/// is nearer to the eye than what is shown.
gl::Rectangle shown(const Camera& camera, const Batch& batch, const double nearest) {
  constexpr double border = 3;
  const double per_slope = 0.5 * camera.height / std::tan(camera.field_of_view * std::numbers::pi / 360); // [pixels]
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < batch.vertices.size(); i += Batch::n_floats) {
    const double depth = -batch.vertices[i + 2];
    if (depth < nearest)
      return {0, 0, camera.width, camera.height};
    box.extend(Eigen::Vector2d(batch.vertices[i], batch.vertices[i + 1]) / depth);
  }
  const auto pixel = [&](const double slope, const double side, const int n) {
    return static_cast<int>(std::clamp(0.5 * n + per_slope * slope + side * border, 0.0, double(n)));
  };
  return {pixel(box.min().x(), -1, camera.width), pixel(box.min().y(), -1, camera.height),
          pixel(box.max().x(), 1, camera.width), pixel(box.max().y(), 1, camera.height)};
}

} // namespace

/// What OpenGL holds for one renderer. The context comes first: it must outlive the rest.
struct Renderer::Passes {
  explicit Passes(const Camera& camera)
    : samples(
        {samples_per_side * camera.width, samples_per_side * camera.height, gl::Colour::rgba16f, gl::Depth::texture}),
      occlusion({camera.width, camera.height, gl::Colour::rg32f, gl::Depth::none}),
      image({camera.width, camera.height, gl::Colour::rgba8, gl::Depth::none}),
      drawn{0, 0, camera.width, camera.height} {}
  ~Passes() = default;

  void clear();
  void draw_background(const Camera& camera, const Look& look) const;
  void draw_shadow_map(const LightFrame& light) const;
  void draw_solids(const Camera& camera, const LightFrame& light, const Eigen::Vector2d& depths) const;
  void draw_occlusion(const Camera& camera, const Eigen::Vector2d& depths) const;
  void resolve(const Camera& camera, const Look& look) const;

  gl::Context context;
  gl::Program depth_program{"depth.vert", "depth.frag"};
  gl::Program solid_program{"solid.vert", "solid.frag"};
  gl::Program occlusion_program{"screen.vert", "occlusion.frag"};
  gl::Program background_program{"screen.vert", "background.frag"};
  gl::Program resolve_program{"screen.vert", "resolve.frag"};
  gl::Framebuffer shadow_map{{shadow_map_size, shadow_map_size, gl::Colour::none, gl::Depth::shadow}};
  gl::Framebuffer samples, occlusion, image;
  gl::Mesh mesh{3, 3, 3, 1};
  gl::ScreenTriangle screen;
  gl::Rectangle drawn; ///< of the last image, which holds all that is not clear in `samples`
};

void Renderer::Passes::clear() {
  const gl::Within here(drawn.times(samples_per_side));
  samples.clear(Eigen::Vector4f::Zero());
}

void Renderer::Passes::draw_background(const Camera& camera, const Look& look) const {
  image.bind();
  background_program.set("height", static_cast<float>(camera.height));
  background_program.set("top", Eigen::Vector3f(look.background_top.cast<float>()));
  background_program.set("bottom", Eigen::Vector3f(look.background_bottom.cast<float>()));
  screen.draw();
}

void Renderer::Passes::draw_shadow_map(const LightFrame& light) const {
  shadow_map.clear(Eigen::Vector4f::Zero());
  depth_program.set("view_to_clip", Eigen::Matrix4f(light.view_to_light.cast<float>()));
  mesh.draw();
}

void Renderer::Passes::draw_solids(const Camera& camera, const LightFrame& light, const Eigen::Vector2d& depths) const {
  const Eigen::Matrix4d projection = projection_matrix(camera, depths[0], depths[1]);
  const Vec3 up = view_matrix(camera).block<3, 3>(0, 0) * camera.up.normalized();
  // Below two texels the map's own steps would show.
  const double blur = std::max(shadow_blur * view_height(camera) / light.width, 2.0 / shadow_map_size);
  samples.bind();
  { // then each sample is shaded once
    const gl::DepthsAlone first;
    depth_program.set("view_to_clip", Eigen::Matrix4f(projection.cast<float>()));
    mesh.draw();
  }
  const gl::EqualDepthsPass what_is_seen;
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

/// Makes a context the thread's own for as long as this lives.
class InUse {
 public:
  explicit InUse(const gl::Context& context) : context_(context) { context_.make_current(); }
  ~InUse() { context_.release(); }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  const gl::Context& context_;
};

} // namespace

Renderer::Renderer(const Camera& camera, const Look& look) : camera_(camera), look_(look) {
  check(camera);
  passes_ = std::make_unique<Passes>(camera);
  passes_->context.release();
}

Renderer::~Renderer() {
  // What the passes hold is deleted in the context that is current.
  passes_->context.make_current();
}

Image Renderer::draw_batch(const Batch& batch) const {
  const InUse context(passes_->context);
  passes_->clear();
  passes_->draw_background(camera_, look_);
  if (const auto depths = depth_range(batch.bounds)) {
    const LightFrame light = light_frame(batch.bounds);
    passes_->mesh.upload(batch.vertices, batch.indices);
    passes_->draw_shadow_map(light);
    passes_->drawn = shown(camera_, batch, (*depths)[0]);
    passes_->draw_solids(camera_, light, *depths);
    const gl::Within here(passes_->drawn);
    passes_->draw_occlusion(camera_, *depths);
    passes_->resolve(camera_, look_);
  }
  return to_image(passes_->image);
}

} // namespace kerf::render
