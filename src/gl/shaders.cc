#include "gl/shaders.h"

#include "base/error.h"

#include <string>

namespace kerf::gl {

std::string_view shader_source(std::string_view name) {
  std::string known;
  for (const Shader& shader : embedded_shaders()) {
    if (shader.name == name)
      return shader.source;
    known += (known.empty() ? "" : ", ") + std::string(shader.name);
  }
  throw DataError({.path = "shader",
                   .value = std::string(name),
                   .rule = "must be one of the embedded files: " + known,
                   .remedy = "Add the file to shaders/ and build again"});
}

} // namespace kerf::gl
