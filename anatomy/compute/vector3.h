// Vectors of which every component is a number, or several side by side, one in each lane.
#pragma once

#include <type_traits>

namespace ecorche::inline v1 {

template <class T>
struct Vec3xN {
  T x, y, z;
};
template <class T>
Vec3xN<T> operator+(const Vec3xN<T>& a, const Vec3xN<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vec3xN<T> operator-(const Vec3xN<T>& a, const Vec3xN<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec3xN<T> operator*(const std::type_identity_t<T>& s, const Vec3xN<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
T dot(const Vec3xN<T>& a, const Vec3xN<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec3xN<T> cross(const Vec3xN<T>& a, const Vec3xN<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace ecorche::inline v1
