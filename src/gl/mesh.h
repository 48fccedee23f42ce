#pragma once

/// Triangles in the memory of OpenGL: interleaved float attributes and vertex indices.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace kerf::gl {

class Mesh {
 public:
  /// Attribute i of a vertex has `attribute_sizes[i]` floats and is `layout(location = i)` in the shader.
  explicit Mesh(std::initializer_list<int> attribute_sizes);
  ~Mesh();
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  /// Replaces the triangles: all attributes of vertex 0, of vertex 1, ...; three indices a triangle.
  void upload(std::span<const float> vertices, std::span<const std::uint32_t> indices);

  /// Draws all triangles with the program in use into the bound framebuffer.
  void draw() const;

 private:
  unsigned int array_ = 0, vertices_ = 0, indices_ = 0;
  std::size_t n_indices_ = 0;
};

/// Draws one triangle over the whole framebuffer; the vertex shader makes it from gl_VertexID = 0, 1, 2.
class ScreenTriangle {
 public:
  ScreenTriangle();
  ~ScreenTriangle();
  ScreenTriangle(const ScreenTriangle&) = delete;
  ScreenTriangle& operator=(const ScreenTriangle&) = delete;

  void draw() const;

 private:
  unsigned int array_ = 0;
};

} // namespace kerf::gl
