#pragma once

/// The GLSL sources of the folder shaders/, embedded when the program is built.

#include <span>
#include <string_view>

namespace kerf::gl {

struct Shader {
  std::string_view name; ///< file name: "solid.frag"
  std::string_view source;
};

/// Every embedded shader.
std::span<const Shader> embedded_shaders();

/// The source of the shader with this file name; throws DataError if there is none.
std::string_view shader_source(std::string_view name);

} // namespace kerf::gl
