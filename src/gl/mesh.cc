#include "gl/mesh.h"

#include "gl/api.h"

namespace kerf::gl {

namespace {

const void* offset_of_floats(std::size_t n) { return reinterpret_cast<const void*>(n * sizeof(float)); }

} // namespace

Mesh::Mesh(std::initializer_list<int> attribute_sizes) {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &vertices_);
  glGenBuffers(1, &indices_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  std::size_t n_floats = 0;
  for (const int size : attribute_sizes)
    n_floats += static_cast<std::size_t>(size);
  GLuint attribute = 0;
  std::size_t offset = 0;
  for (const int size : attribute_sizes) {
    glEnableVertexAttribArray(attribute);
    glVertexAttribPointer(attribute++, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(n_floats * sizeof(float)),
                          offset_of_floats(offset));
    offset += static_cast<std::size_t>(size);
  }
}

Mesh::~Mesh() {
  glDeleteBuffers(1, &indices_);
  glDeleteBuffers(1, &vertices_);
  glDeleteVertexArrays(1, &array_);
}

void Mesh::upload(std::span<const float> vertices, std::span<const std::uint32_t> indices) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(), GL_STREAM_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(), GL_STREAM_DRAW);
  n_indices_ = indices.size();
}

void Mesh::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(n_indices_), GL_UNSIGNED_INT, nullptr);
}

ScreenTriangle::ScreenTriangle() { glGenVertexArrays(1, &array_); }

ScreenTriangle::~ScreenTriangle() { glDeleteVertexArrays(1, &array_); }

void ScreenTriangle::draw() const {
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

} // namespace kerf::gl
