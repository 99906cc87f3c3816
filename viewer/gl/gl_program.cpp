#include "viewer/gl/gl_program.h"

#include <fmt/format.h>

#include <array>
#include <glm/gtc/type_ptr.hpp>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

[[noreturn]] void refuse(const char* name, const char* log) {
  throw OutputError(
      fmt::format("the graphics driver cannot compile the shader '{}': {}; "
                  "without a display ECORCHE_GL=osmesa (package libosmesa6) takes another driver",
                  name, log));
}

GLuint compile(const GlApi& gl, GLenum stage, const char* name, const char* defines,
               const char* prelude, const char* source) {
  const GLuint shader = gl.CreateShader(stage);
  const std::array<const char*, 4> texts{"#version 330 core\n", defines, prelude, source};
  gl.ShaderSource(shader, static_cast<GLsizei>(texts.size()), texts.data(), nullptr);
  gl.CompileShader(shader);
  GLint good = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  std::array<char, 4096> log{};
  gl.GetShaderInfoLog(shader, log.size(), nullptr, log.data());
  refuse(name, log.data());
}

}  // namespace

GlProgram::GlProgram(const GlApi& gl, const char* name, const char* defines, const char* prelude,
                     const char* vertex, const char* fragment)
    : gl_(gl) {
  id_ = gl_.CreateProgram();
  const GLuint stages[2] = {compile(gl_, GL_VERTEX_SHADER, name, defines, prelude, vertex),
                            compile(gl_, GL_FRAGMENT_SHADER, name, defines, prelude, fragment)};
  for (const GLuint stage : stages) gl_.AttachShader(id_, stage);
  gl_.LinkProgram(id_);
  for (const GLuint stage : stages) gl_.DeleteShader(stage);
  GLint good = 0;
  gl_.GetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good) return;
  std::array<char, 4096> log{};
  gl_.GetProgramInfoLog(id_, log.size(), nullptr, log.data());
  refuse(name, log.data());
}

GlProgram::~GlProgram() { gl_.DeleteProgram(id_); }

GLint GlProgram::place(const char* name) const {
  const auto found = places_.find(std::string_view(name));
  if (found != places_.end()) return found->second;
  return places_.emplace(name, gl_.GetUniformLocation(id_, name)).first->second;
}

void GlProgram::set(const char* name, float value) const { gl_.Uniform1f(place(name), value); }
void GlProgram::set(const char* name, int value) const { gl_.Uniform1i(place(name), value); }
void GlProgram::set(const char* name, const glm::vec2& v) const {
  gl_.Uniform2f(place(name), v.x, v.y);
}
void GlProgram::set(const char* name, const glm::vec3& v) const {
  gl_.Uniform3f(place(name), v.x, v.y, v.z);
}
void GlProgram::set(const char* name, const glm::vec4& v) const {
  gl_.Uniform4f(place(name), v.x, v.y, v.z, v.w);
}
void GlProgram::set(const char* name, const glm::mat3& v) const {
  gl_.UniformMatrix3fv(place(name), 1, GL_FALSE, glm::value_ptr(v));
}
void GlProgram::set(const char* name, const glm::mat4& v) const {
  gl_.UniformMatrix4fv(place(name), 1, GL_FALSE, glm::value_ptr(v));
}

}  // namespace ecorche
