// Four vertices side by side, or eight, one in each lane. Private to the room.
#pragma once

#include <Eigen/Core>

#include "anatomy/compute/simd.h"
#include "anatomy/compute/vector3.h"

namespace ecorche::inline v1 {

template <class Floats>
struct Lanes4Of {
  Floats x, y, z, w;
};

using Lanes3 = Vec3xN<Float4>;
using Lanes4 = Lanes4Of<Float4>;
using Wide3 = Vec3xN<Float8>;
using Wide4 = Lanes4Of<Float8>;

// Four rows of four floats become four columns, and back: it is its own inverse.
inline Lanes4 transposed(Float4 a, Float4 b, Float4 c, Float4 d) {
  const Float4 ab_low = __builtin_shuffle(a, b, Int4{0, 4, 1, 5}),
               ab_high = __builtin_shuffle(a, b, Int4{2, 6, 3, 7});
  const Float4 cd_low = __builtin_shuffle(c, d, Int4{0, 4, 1, 5}),
               cd_high = __builtin_shuffle(c, d, Int4{2, 6, 3, 7});
  return {__builtin_shuffle(ab_low, cd_low, Int4{0, 1, 4, 5}),
          __builtin_shuffle(ab_low, cd_low, Int4{2, 3, 6, 7}),
          __builtin_shuffle(ab_high, cd_high, Int4{0, 1, 4, 5}),
          __builtin_shuffle(ab_high, cd_high, Int4{2, 3, 6, 7})};
}

// The same of both halves.
inline Wide4 transposed(Float8 a, Float8 b, Float8 c, Float8 d) {
  const Float8 ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
               ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Float8 cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13),
               cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  return {__builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(ab_high, cd_high, 2, 3, 10, 11, 6, 7, 14, 15)};
}

inline Float8 halves(Float4 low, Float4 high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

// The eight rows with these numbers.
inline Wide4 gather_eight(const float* rows, const int* number) {
  const auto two = [&](int k) {
    return halves(load4(rows + 4 * number[k]), load4(rows + 4 * number[k + 4]));
  };
  return transposed(two(0), two(1), two(2), two(3));
}

// Eight rows that follow each other.
inline Wide4 load_eight(const float* rows) {
  const auto two = [&](int k) { return halves(load4(rows + 4 * k), load4(rows + 4 * k + 16)); };
  return transposed(two(0), two(1), two(2), two(3));
}

// act(lane, row) for each of eight rows.
template <class Act>
void each_row(const Wide4& v, const Act& act) {
  const Wide4 t = transposed(v.x, v.y, v.z, v.w);
  const Float8 two[] = {t.x, t.y, t.z, t.w};
  for (int k = 0; k < 4; ++k) {
    act(k, __builtin_shufflevector(two[k], two[k], 0, 1, 2, 3));
    act(k + 4, __builtin_shufflevector(two[k], two[k], 4, 5, 6, 7));
  }
}

inline void store_eight(float* rows, const Wide4& v) {
  each_row(v, [&](int k, Float4 row) { store4(rows + 4 * k, row); });
}

inline Float4 all(float value) { return Float4{value, value, value, value}; }
inline Float8 all_eight(float value) { return Float8{} + value; }
inline Float8 root(Float8 v) {
  Eigen::Array<float, 8, 1> in;
  store8(in.data(), v);
  const Eigen::Array<float, 8, 1> out = in.sqrt();
  return load8(out.data());
}

template <class F>
Vec3xN<F> xyz(const Lanes4Of<F>& v) {
  return {v.x, v.y, v.z};
}

inline Wide3 normalized(const Wide3& v) { return (1.0f / root(dot(v, v) + 1e-30f)) * v; }
inline Wide3 load3(const float* columns) {
  return {load8(columns), load8(columns + 8), load8(columns + 16)};
}

// By a unit quaternion.
inline Wide3 rotate(const Wide4& q, const Wide3& v) {
  const Wide3 u = xyz(q), t = cross(u, v), twice = t + t;
  return v + q.w * twice + cross(u, twice);
}

inline Wide4 normalized(const Wide4& q) {
  const Float8 s = 1.0f / root(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w + 1e-30f);
  return {s * q.x, s * q.y, s * q.z, s * q.w};
}

// Columns of the rotation.
struct Wide33 {
  Wide3 col[3];
};

inline Wide33 matrix(const Wide4& q) {
  const Float8 x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const Float8 xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2,
               yz = q.y * z2, wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  const Float8 one = all_eight(1);
  return {{{one - yy - zz, xy + wz, xz - wy},
           {xy - wz, one - xx - zz, yz + wx},
           {xz + wy, yz - wx, one - xx - yy}}};
}

// The unit quaternion of a rotation. The largest of the four components is found first, so that
// nothing is divided by little.
inline Wide4 quaternion(const Wide33& R) {
  const Float8 a = R.col[0].x, b = R.col[1].y, c = R.col[2].z, one = all_eight(1);
  const Float8 ww = one + a + b + c, xx = one + a - b - c, yy = one - a + b - c,
               zz = one - a - b + c;
  const Float8 zy = R.col[1].z - R.col[2].y, xz = R.col[2].x - R.col[0].z,
               yx = R.col[0].y - R.col[1].x;
  const Float8 sum_xy = R.col[0].y + R.col[1].x, sum_xz = R.col[0].z + R.col[2].x,
               sum_yz = R.col[1].z + R.col[2].y;
  Wide4 q{zy, xz, yx, ww};
  Float8 most = ww;
  const auto take = [&](Float8 size, const Wide4& other) {
    const auto better = size > most;
    q = {better ? other.x : q.x, better ? other.y : q.y, better ? other.z : q.z,
         better ? other.w : q.w};
    most = better ? size : most;
  };
  take(xx, {xx, sum_xy, sum_xz, zy});
  take(yy, {sum_xy, yy, sum_yz, xz});
  take(zz, {sum_xz, sum_yz, zz, yx});
  return normalized(q);
}

}  // namespace ecorche::inline v1
