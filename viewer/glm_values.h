// GLM's vectors and matrices from and to the viewer's values. Private to viewer: public headers
// name no type of GLM.
#pragma once

#include <Eigen/Core>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "viewer/draw_list.h"

namespace ecorche {

inline glm::vec3 to_glm(const Vec3f& v) { return {v.x(), v.y(), v.z()}; }
// Unit vector along `v`; 0 for 0, where glm::normalize gives NaN.
inline glm::vec3 unit(const Vec3f& v) { return to_glm(Vec3f(v.normalized())); }
inline Vec3f to_eigen(const glm::vec3& v) { return {v.x, v.y, v.z}; }

// Both libraries store matrices column by column.
inline glm::mat4 to_glm(const Mat4f& m) { return glm::make_mat4(m.data()); }
inline Mat4f to_eigen(const glm::mat4& m) { return Eigen::Map<const Mat4f>(glm::value_ptr(m)); }

}  // namespace ecorche
