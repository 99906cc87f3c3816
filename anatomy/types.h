// The geometric vocabulary of all rooms.
//
// SI units in memory (m, kg, s, rad). World frame: +X the body's left, +Y up, +Z the way the face
// looks. X_AB maps points of frame B into frame A. One letter per index set: i vertices, j joints,
// k slices, m muscles, f frames.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <numbers>

namespace ecorche::inline v1 {

inline constexpr double kDegree = std::numbers::pi / 180;            // rad
inline constexpr double kDegreesPerRadian = 180 / std::numbers::pi;  // for output

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;
using Transform = Eigen::Isometry3d;
using Affine = Eigen::Affine3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  // #V x 3
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3,
                                Eigen::RowMajor>;  // #F x 3, counter-clockwise seen from outside

struct TriMesh {
  Points V;
  Triangles F;
};

// 'left' is +X; 'middle' is for unpaired parts.
enum class Side { middle, left, right };

// "femur" + left -> "femur_l"; unpaired parts keep their name.
inline const char* side_suffix(Side side) {
  return side == Side::left ? "_l" : side == Side::right ? "_r" : "";
}

}  // namespace ecorche::inline v1
