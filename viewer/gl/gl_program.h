// A linked shader program and its uniforms by name.
#pragma once

#include <map>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "viewer/gl/gl_api.h"

namespace ecorche {

class GlProgram {
 public:
  // Throws OutputError with the driver's log.
  // `defines`: lines "#define NAME\n" that choose a variant.
  GlProgram(const GlApi& gl, const char* name, const char* defines, const char* prelude,
            const char* vertex, const char* fragment);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const { gl_.UseProgram(id_); }
  // Sets a uniform of the program in use. A name that the program does not have is passed over: a
  // pass uses some of the frame's values.
  void set(const char* name, float value) const;
  void set(const char* name, int value) const;
  void set(const char* name, const glm::vec2& value) const;
  void set(const char* name, const glm::vec3& value) const;
  void set(const char* name, const glm::vec4& value) const;
  void set(const char* name, const glm::mat3& value) const;
  void set(const char* name, const glm::mat4& value) const;

 private:
  GLint place(const char* name) const;
  const GlApi& gl_;
  GLuint id_ = 0;
  mutable std::map<std::string, GLint, std::less<>> places_;
};

}  // namespace ecorche
