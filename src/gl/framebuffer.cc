#include "gl/framebuffer.h"

#include "base/error.h"
#include "gl/api.h"

#include <string>

namespace kerf::gl {

namespace {

GLint internal_format(Colour colour) {
  switch (colour) {
    case Colour::rg32f:
      return GL_RG32F;
    case Colour::rgba16f:
      return GL_RGBA16F;
    case Colour::rgba32f:
      return GL_RGBA32F;
    case Colour::rgba8:
    case Colour::none:
      break;
  }
  return GL_RGBA8;
}

void set_sampling(GLint filter) {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

GLuint colour_texture(const FramebufferFormat& format) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, internal_format(format.colour), format.width, format.height, 0, GL_RGBA, GL_FLOAT,
               nullptr);
  set_sampling(GL_LINEAR);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, id, 0);
  return id;
}

GLuint depth_texture(const FramebufferFormat& format) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, format.width, format.height, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
               nullptr);
  set_sampling(format.depth == Depth::shadow ? GL_LINEAR : GL_NEAREST);
  if (format.depth == Depth::shadow)
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, id, 0);
  return id;
}

void bind_texture(GLuint id, int unit) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, id);
}

std::string size_text(const FramebufferFormat& format) {
  return std::to_string(format.width) + " x " + std::to_string(format.height);
}

} // namespace

Framebuffer::Framebuffer(const FramebufferFormat& format) : format_(format) {
  check_size();
  // An error of an earlier call must not be taken for one of this object.
  while (glGetError() != GL_NO_ERROR) {
  }
  glGenFramebuffers(1, &id_);
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glActiveTexture(GL_TEXTURE0);
  if (format.colour != Colour::none)
    colour_ = colour_texture(format);
  else
    glDrawBuffer(GL_NONE);
  if (format.depth != Depth::none)
    depth_ = depth_texture(format);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && glGetError() == GL_NO_ERROR)
    return;
  release();
  throw DataError({.path = "OpenGL framebuffer [pixels]",
                   .value = size_text(format),
                   .rule = "there is no memory for an image of this size",
                   .remedy = "Make the image smaller"});
}

Framebuffer::~Framebuffer() { release(); }

void Framebuffer::check_size() const {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  const auto fits = [&](int n) { return n >= 1 && n <= largest; };
  if (!fits(format_.width) || !fits(format_.height))
    throw ParameterError({.path = "OpenGL framebuffer [pixels]",
                          .value = size_text(format_),
                          .rule = "width and height must be between 1 and " + std::to_string(largest),
                          .remedy = "Choose another image size"});
}

void Framebuffer::release() const {
  glDeleteFramebuffers(1, &id_);
  glDeleteTextures(1, &colour_);
  glDeleteTextures(1, &depth_);
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glViewport(0, 0, format_.width, format_.height);
}

void Framebuffer::clear(const Eigen::Vector4f& colour) const {
  bind();
  glClearColor(colour[0], colour[1], colour[2], colour[3]);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Framebuffer::bind_colour(int unit) const { bind_texture(colour_, unit); }

void Framebuffer::bind_depth(int unit) const { bind_texture(depth_, unit); }

std::vector<std::uint8_t> Framebuffer::read_rgba8() const {
  std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width()) * height());
  bind();
  glReadPixels(0, 0, width(), height(), GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  return pixels;
}

std::vector<float> Framebuffer::read_rgba32f() const {
  std::vector<float> pixels(4 * static_cast<std::size_t>(width()) * height());
  bind();
  glReadPixels(0, 0, width(), height(), GL_RGBA, GL_FLOAT, pixels.data());
  return pixels;
}

std::vector<float> Framebuffer::read_depth() const {
  std::vector<float> depths(static_cast<std::size_t>(width()) * height());
  bind();
  glReadPixels(0, 0, width(), height(), GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  return depths;
}

} // namespace kerf::gl
