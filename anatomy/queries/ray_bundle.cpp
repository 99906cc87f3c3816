#include "anatomy/queries/ray_bundle.h"

#include <algorithm>
#include <bit>

#include "anatomy/queries/bvh_ray.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kMostWaiting = 64;
// triangles are wider than they are by so much, in shares of theirs: no ray slips through an edge
constexpr float kHair = 1e-5f;

RayBundle::Leaf leaf_of(std::span<const float> positions, const int* corners) {
  const auto corner = [&](int k) { return xyz(gather_eight(positions.data(), corners + 8 * k)); };
  const Wide3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
  return {a, ab, ac, cross(ab, ac)};
}

// How far along the ray the first back of a leaf is, if that is before `far`.
float first_back(const RayBundle::Leaf& leaf, const Ray& ray, float far) {
  const Float8 facing = dot(leaf.normal, ray.direction);
  if (lanes_that(facing > 0) == 0) return far;
  const Wide3 s = ray.origin - leaf.corner, p = cross(ray.direction, leaf.second),
              q = cross(s, leaf.first);
  const Float8 inverse = -1.0f / facing, u = dot(s, p) * inverse,
               v = dot(ray.direction, q) * inverse, t = dot(leaf.second, q) * inverse;
  const Int8 hit = (facing > 0) & (u >= -kHair) & (v >= -kHair) & (u + v <= 1 + kHair) & (t >= 0) &
                   (t <= far) & ((t < ray.own - kHere) | (t > ray.own + kHere));
  for (unsigned lanes = lanes_that(hit); lanes != 0; lanes &= lanes - 1)
    far = std::min(far, t[std::countr_zero(lanes)]);
  return far;
}

}  // namespace

bool gather_leaves(const RefittedBvh& tree, std::span<const float> boxes,
                   std::span<const float> positions, Float4 low, Float4 high, RayBundle& out) {
  out.count = 0;
  if (tree.children.empty()) return true;
  std::array<int, kMostWaiting> stack;
  std::size_t waiting = 1;
  stack[0] = 0;
  while (waiting > 0) {
    const std::size_t node = stack[--waiting];
    const float* box = &boxes[kTreeBox * node];
    Int8 off{};
    for (int k = 0; k < 3; ++k)
      off |= (load8(box + 8 * k) > high[k]) | (load8(box + 24 + 8 * k) < low[k]);
    const std::array<int, 8>& children = tree.children[node];
    for (unsigned near = lanes_that(off == 0); near != 0; near &= near - 1) {
      const std::size_t lane = std::countr_zero(near);
      const int child = children[lane];
      if (lane > 0 && child == children[lane - 1]) continue;
      if (child >= 0) {
        stack[waiting++] = child;
        continue;
      }
      if (out.count == RayBundle::kMost) return false;
      float* own = &out.boxes[48 * (out.count / 8)];
      if (out.count % 8 == 0) std::fill_n(own, 48, 0.0f);
      for (std::size_t k = 0; k < 6; ++k) own[8 * k + out.count % 8] = box[8 * k + lane];
      out.leaves[out.count++] = leaf_of(positions, &tree.corners[~child]);
    }
  }
  return true;
}

float next_back(const RayBundle& bundle, Float4 from, Float4 direction, float own, float far) {
  Ray ray = make_ray(from, direction, 0);
  ray.own = own;
  float first = far;
  bool found = false;
  for (std::size_t begin = 0; begin < bundle.count; begin += 8) {
    unsigned enters = 0;
    entries(&bundle.boxes[6 * begin], ray, first, enters);
    if (bundle.count - begin < 8) enters &= (1u << (bundle.count - begin)) - 1;
    for (; enters != 0; enters &= enters - 1) {
      const float back = first_back(bundle.leaves[begin + std::countr_zero(enters)], ray, first);
      found = found || back < first;
      first = back;
    }
  }
  return found ? first : 0;
}

}  // namespace ecorche::inline v1
