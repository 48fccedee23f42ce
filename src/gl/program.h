#pragma once

/// A vertex and a fragment shader, linked.

#include <Eigen/Core>

#include <string>
#include <string_view>

namespace kerf::gl {

/// GLSL text with the name that error messages give it.
struct ShaderText {
  std::string name;
  std::string source;
};

class Program {
 public:
  /// Links two embedded shaders, named by their files; throws DataError with the GLSL log.
  Program(std::string_view vertex_file, std::string_view fragment_file);
  /// Links two given texts; throws DataError with the GLSL log.
  Program(const ShaderText& vertex, const ShaderText& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Draws with this program from now on.
  void use() const;

  /// Makes this the program in use and sets a uniform of it; throws DataError if it has none of that name.
  void set(const std::string& uniform, int value) const;
  void set(const std::string& uniform, float value) const;
  void set(const std::string& uniform, const Eigen::Vector2f& value) const;
  void set(const std::string& uniform, const Eigen::Vector3f& value) const;
  void set(const std::string& uniform, const Eigen::Matrix4f& value) const;

 private:
  int location(const std::string& uniform) const;

  std::string name_;
  unsigned int id_ = 0;
};

} // namespace kerf::gl
