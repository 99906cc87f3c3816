// Four floats that the compiler keeps in one register on any x86-64, and eight that take one or
// two. Private to the room.
#pragma once

#include <cstring>

namespace ecorche::inline v1 {

typedef float Float4 __attribute__((vector_size(16)));
typedef int Int4 __attribute__((vector_size(16)));
typedef float Float8 __attribute__((vector_size(32)));
typedef int Int8 __attribute__((vector_size(32)));

inline Float4 load4(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

inline void store4(float* p, Float4 v) { std::memcpy(p, &v, sizeof v); }

inline Float8 load8(const float* p) {
  Float8 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

inline void store8(float* p, Float8 v) { std::memcpy(p, &v, sizeof v); }

// (y z x w)
inline Float4 turn(Float4 v) { return __builtin_shuffle(v, Int4{1, 2, 0, 3}); }

// w = 0 when both have finite w
inline Float4 cross(Float4 a, Float4 b) { return turn(a * turn(b) - turn(a) * b); }

// Lane by lane. The compiler does not find these instructions by itself, as they differ from a
// comparison where something is not a number.
#ifdef __SSE__
inline Float4 least(Float4 a, Float4 b) { return __builtin_ia32_minps(a, b); }
inline Float4 most(Float4 a, Float4 b) { return __builtin_ia32_maxps(a, b); }
#else
inline Float4 least(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 most(Float4 a, Float4 b) { return a > b ? a : b; }
#endif

#ifdef __AVX__
inline Float8 least(Float8 a, Float8 b) { return __builtin_ia32_minps256(a, b); }
inline Float8 most(Float8 a, Float8 b) { return __builtin_ia32_maxps256(a, b); }
#else
inline Float8 least(Float8 a, Float8 b) { return a < b ? a : b; }
inline Float8 most(Float8 a, Float8 b) { return a > b ? a : b; }
#endif

// Which lanes of a comparison hold, a bit each.
#ifdef __AVX__
inline unsigned lanes_that(Int8 holds) {
  return unsigned(__builtin_ia32_movmskps256((Float8)holds));
}
#else
inline unsigned lanes_that(Int8 holds) {
  unsigned out = 0;
  for (int lane = 0; lane < 8; ++lane) out |= (holds[lane] != 0 ? 1u : 0u) << lane;
  return out;
}
#endif

// In every lane.
inline Float4 sum4(Float4 v) {
  v += __builtin_shuffle(v, Int4{2, 3, 0, 1});
  return v + __builtin_shuffle(v, Int4{1, 0, 3, 2});
}

}  // namespace ecorche::inline v1
