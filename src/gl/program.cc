#include "gl/program.h"

#include "base/error.h"
#include "gl/api.h"
#include "gl/shaders.h"

namespace kerf::gl {

namespace {

/// Deletes the shader when the program is linked, or could not be.
struct Compiled {
  Compiled(GLenum stage, const ShaderText& text);
  ~Compiled() { glDeleteShader(id); }
  Compiled(const Compiled&) = delete;
  Compiled& operator=(const Compiled&) = delete;

  GLuint id;
};

std::string log_of_shader(GLuint id) {
  GLint length = 0;
  glGetShaderiv(id, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  glGetShaderInfoLog(id, length, &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return log;
}

std::string log_of_program(GLuint id) {
  GLint length = 0;
  glGetProgramiv(id, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  glGetProgramInfoLog(id, length, &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return log;
}

DataError failure(const std::string& name, const std::string& rule, const std::string& log) {
  return DataError({.file = name, .path = "GLSL", .rule = rule + ":\n" + log, .remedy = "Correct the shader"});
}

Compiled::Compiled(GLenum stage, const ShaderText& text) : id(glCreateShader(stage)) {
  const char* const source = text.source.c_str();
  glShaderSource(id, 1, &source, nullptr);
  glCompileShader(id);
  GLint compiled = GL_FALSE;
  glGetShaderiv(id, GL_COMPILE_STATUS, &compiled);
  if (compiled)
    return;
  const std::string log = log_of_shader(id);
  glDeleteShader(id);
  throw failure(text.name, "does not compile", log);
}

ShaderText embedded(std::string_view file) { return {std::string(file), std::string(shader_source(file))}; }

} // namespace

Program::Program(std::string_view vertex_file, std::string_view fragment_file)
  : Program(embedded(vertex_file), embedded(fragment_file)) {}

Program::Program(const ShaderText& vertex, const ShaderText& fragment) : name_(vertex.name + " + " + fragment.name) {
  const Compiled vertex_shader(GL_VERTEX_SHADER, vertex);
  const Compiled fragment_shader(GL_FRAGMENT_SHADER, fragment);
  id_ = glCreateProgram();
  glAttachShader(id_, vertex_shader.id);
  glAttachShader(id_, fragment_shader.id);
  glLinkProgram(id_);
  GLint linked = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked)
    return;
  const std::string log = log_of_program(id_);
  glDeleteProgram(id_);
  throw failure(name_, "do not link", log);
}

Program::~Program() { glDeleteProgram(id_); }

void Program::use() const { glUseProgram(id_); }

int Program::location(const std::string& uniform) const {
  use();
  const int location = glGetUniformLocation(id_, uniform.c_str());
  if (location < 0)
    throw DataError({.file = name_,
                     .path = "uniform",
                     .value = uniform,
                     .rule = "the linked shaders have no such uniform",
                     .remedy = "Declare it and use it there"});
  return location;
}

void Program::set(const std::string& uniform, int value) const { glUniform1i(location(uniform), value); }

void Program::set(const std::string& uniform, float value) const { glUniform1f(location(uniform), value); }

void Program::set(const std::string& uniform, const Eigen::Vector2f& value) const {
  glUniform2fv(location(uniform), 1, value.data());
}

void Program::set(const std::string& uniform, const Eigen::Vector3f& value) const {
  glUniform3fv(location(uniform), 1, value.data());
}

void Program::set(const std::string& uniform, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}

} // namespace kerf::gl
