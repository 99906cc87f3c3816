// A linked shader program and its uniforms by name.
#pragma once

#include <map>
#include <string>

#include <Eigen/Core>

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
  // Names the program does not have are passed over: a pass uses what it needs of the frame's
  // values.
  void set(const char* name, float value) const;
  void set(const char* name, int value) const;
  void set(const char* name, const Eigen::Vector2f& value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Vector4f& value) const;
  void set(const char* name, const Eigen::Matrix3f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  GLint place(const char* name) const;
  const GlApi& gl_;
  GLuint id_ = 0;
  mutable std::map<std::string, GLint, std::less<>> places_;
};

}  // namespace ecorche
