// Four vertices side by side, or eight, one in each lane. Private to the room.
#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "skinning/float4.h"

namespace ecorche {

template <class Floats>
struct Lanes3Of {
  Floats x, y, z;
};

using Lanes3 = Lanes3Of<Float4>;

struct Lanes4 {
  Float4 x, y, z, w;
};

// Four rows of four floats become four columns, and back: it is its own inverse.
inline Lanes4 transposed(Float4 a, Float4 b, Float4 c, Float4 d) {
  const Float4 ab_low = __builtin_shuffle(a, b, Int4{0, 4, 1, 5}), ab_high = __builtin_shuffle(a, b, Int4{2, 6, 3, 7});
  const Float4 cd_low = __builtin_shuffle(c, d, Int4{0, 4, 1, 5}), cd_high = __builtin_shuffle(c, d, Int4{2, 6, 3, 7});
  return {__builtin_shuffle(ab_low, cd_low, Int4{0, 1, 4, 5}), __builtin_shuffle(ab_low, cd_low, Int4{2, 3, 6, 7}),
          __builtin_shuffle(ab_high, cd_high, Int4{0, 1, 4, 5}), __builtin_shuffle(ab_high, cd_high, Int4{2, 3, 6, 7})};
}

// Rows that follow each other.
inline Lanes4 load_rows(const float* rows) { return transposed(load4(rows), load4(rows + 4), load4(rows + 8), load4(rows + 12)); }

// The rows with these numbers.
inline Lanes4 gather_rows(const float* rows, const int* number) {
  return transposed(load4(rows + 4 * number[0]), load4(rows + 4 * number[1]), load4(rows + 4 * number[2]), load4(rows + 4 * number[3]));
}

// Places of the eight rows with these numbers.
inline Lanes3Of<Float8> gather_eight(const float* rows, const int* number) {
  const auto two = [&](int k) {
    return __builtin_shufflevector(load4(rows + 4 * number[k]), load4(rows + 4 * number[k + 4]), 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const Float8 a = two(0), b = two(1), c = two(2), d = two(3);
  const Float8 ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13), cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15), cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  return {__builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13), __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13)};
}

inline void store_rows(float* rows, const Lanes4& v) {
  const Lanes4 t = transposed(v.x, v.y, v.z, v.w);
  store4(rows, t.x);
  store4(rows + 4, t.y);
  store4(rows + 8, t.z);
  store4(rows + 12, t.w);
}

inline Float4 all(float value) { return Float4{value, value, value, value}; }
inline Float8 all_eight(float value) { return Float8{} + value; }
inline Float4 root(Float4 v) {
  Eigen::Array4f in;
  store4(in.data(), v);
  const Eigen::Array4f out = in.sqrt();
  return load4(out.data());
}

template <class F>
Lanes3Of<F> operator+(const Lanes3Of<F>& a, const Lanes3Of<F>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
Lanes3Of<F> operator-(const Lanes3Of<F>& a, const Lanes3Of<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
Lanes3Of<F> operator*(const std::type_identity_t<F>& s, const Lanes3Of<F>& v) {
  return {s * v.x, s * v.y, s * v.z};
}
template <class F>
F dot(const Lanes3Of<F>& a, const Lanes3Of<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Lanes3 cross(const Lanes3& a, const Lanes3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Lanes3 normalized(const Lanes3& v) { return (1.0f / root(dot(v, v) + 1e-30f)) * v; }
inline Lanes3 xyz(const Lanes4& v) { return {v.x, v.y, v.z}; }
inline Lanes3 load3(const float* columns) { return {load4(columns), load4(columns + 4), load4(columns + 8)}; }

// By a unit quaternion.
inline Lanes3 rotate(const Lanes4& q, const Lanes3& v) {
  const Lanes3 u = xyz(q), t = cross(u, v), twice = t + t;
  return v + q.w * twice + cross(u, twice);
}

inline Lanes4 normalized(const Lanes4& q) {
  const Float4 s = 1.0f / root(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w + 1e-30f);
  return {s * q.x, s * q.y, s * q.z, s * q.w};
}

// Columns of the rotation.
struct Lanes33 {
  Lanes3 col[3];
};

inline Lanes33 matrix(const Lanes4& q) {
  const Float4 x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const Float4 xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2, yz = q.y * z2, wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  const Float4 one = all(1);
  return {{{one - yy - zz, xy + wz, xz - wy}, {xy - wz, one - xx - zz, yz + wx}, {xz + wy, yz - wx, one - xx - yy}}};
}

// The unit quaternion of a rotation. The largest of the four components is found first, so that nothing is divided by little.
inline Lanes4 quaternion(const Lanes33& R) {
  const Float4 a = R.col[0].x, b = R.col[1].y, c = R.col[2].z, one = all(1);
  const Float4 ww = one + a + b + c, xx = one + a - b - c, yy = one - a + b - c, zz = one - a - b + c;
  const Float4 zy = R.col[1].z - R.col[2].y, xz = R.col[2].x - R.col[0].z, yx = R.col[0].y - R.col[1].x;
  const Float4 sum_xy = R.col[0].y + R.col[1].x, sum_xz = R.col[0].z + R.col[2].x, sum_yz = R.col[1].z + R.col[2].y;
  Lanes4 q{zy, xz, yx, ww};
  Float4 most = ww;
  const auto take = [&](Float4 size, const Lanes4& other) {
    const auto better = size > most;
    q = {better ? other.x : q.x, better ? other.y : q.y, better ? other.z : q.z, better ? other.w : q.w};
    most = better ? size : most;
  };
  take(xx, {xx, sum_xy, sum_xz, zy});
  take(yy, {sum_xy, yy, sum_yz, xz});
  take(zz, {sum_xz, sum_yz, zz, yx});
  return normalized(q);
}

}  // namespace ecorche
