#include "gl/words.h"

#include "base/error.h"
#include "gl/api.h"

#include <cassert>
#include <string>

namespace kerf::gl {

Words::Words(const int width, const int height) : width_(width), height_(height) {
  // An error of an earlier call must not be taken for one of this object.
  while (glGetError() != GL_NO_ERROR) {
  }
  glGenTextures(1, &id_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, width, height, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (glGetError() == GL_NO_ERROR)
    return;
  glDeleteTextures(1, &id_);
  throw DataError({.path = "OpenGL texture [words]",
                   .value = std::to_string(width) + " x " + std::to_string(height),
                   .rule = "there is no memory for a texture of this size",
                   .remedy = "Make it smaller"});
}

Words::~Words() { glDeleteTextures(1, &id_); }

void Words::upload(const std::span<const std::uint32_t> words) const {
  assert(words.size() == static_cast<std::size_t>(width_) * height_);
  bind(0);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, words.data());
}

void Words::bind(const int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, id_);
}

} // namespace kerf::gl
