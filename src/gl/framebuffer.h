#pragma once

/// An image to draw into: a colour and a depth texture of one size. Rows run from the bottom up, as in OpenGL.

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace kerf::gl {

enum class Colour { none, rgba8, rg32f, rgba16f, rgba32f };

/// What the depth texture is for: `texture` is read as depths, `shadow` is compared (sampler2DShadow).
enum class Depth { none, texture, shadow };

struct FramebufferFormat {
  int width = 0, height = 0; ///< [pixels]
  Colour colour = Colour::rgba8;
  Depth depth = Depth::texture;
};

class Framebuffer {
 public:
  /// Throws ParameterError if the size is not between 1 and what OpenGL can hold, DataError if there is no memory.
  explicit Framebuffer(const FramebufferFormat& format);
  ~Framebuffer();
  Framebuffer(const Framebuffer&) = delete;
  Framebuffer& operator=(const Framebuffer&) = delete;

  int width() const { return format_.width; }
  int height() const { return format_.height; }

  /// Draws into this image from now on, over all of it.
  void bind() const;

  /// Binds, then fills the colour (red, green, blue, alpha) and sets the depth to the farthest, 1.
  void clear(const Eigen::Vector4f& colour) const;

  /// Gives the colour or depth texture to the shaders as texture `unit`.
  void bind_colour(int unit) const;
  void bind_depth(int unit) const;

  /// The colours as 8-bit red, green, blue, alpha: 4 * width * height bytes.
  std::vector<std::uint8_t> read_rgba8() const;
  /// The colours as floats: 4 * width * height.
  std::vector<float> read_rgba32f() const;
  /// The depths in [0, 1]: width * height.
  std::vector<float> read_depth() const;

 private:
  void check_size() const;
  void release() const;

  FramebufferFormat format_;
  unsigned int id_ = 0, colour_ = 0, depth_ = 0;
};

} // namespace kerf::gl
