#include "anatomy/queries/refitted_bvh.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "anatomy/queries/bvh_ray.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kLeaf = 8;          // triangles; fewer are filled up with the last one
constexpr std::size_t kWays = 8;  // of a node
// seven a level, and medians halve thrice a level: far deeper than any mesh needs
constexpr std::size_t kMostWaitingRefittedBvh = 64;

Float4 row(std::span<const float> rows, int i) { return load4(&rows[4 * i]); }

struct Builder {
  std::span<const int> triangles;
  std::vector<Float4> middles;
  std::vector<int> order;
  RefittedBvh& tree;

  Float4 middle(int k) const { return middles[order[k]]; }

  // Halves a range at the median along its longest side.
  int halve(int begin, int end) {
    Float4 low = middle(begin), high = low;
    for (int k = begin; k < end; ++k) {
      low = least(low, middle(k));
      high = most(high, middle(k));
    }
    const Float4 size = high - low;
    const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
    const int leaves = (end - begin + kLeaf - 1) / kLeaf,
              half = begin + kLeaf * (leaves / 2);  // so that all leaves but one are full
    std::nth_element(order.begin() + begin, order.begin() + half, order.begin() + end,
                     [&](int a, int b) {
                       return std::pair(middles[a][axis], a) < std::pair(middles[b][axis], b);
                     });
    return half;
  }

  int leaf(int begin, int end) {
    const int at = tree.corners.size();
    for (int corner = 0; corner < 3; ++corner)
      for (int k = begin; k < begin + kLeaf; ++k)
        tree.corners.push_back(triangles[3 * order[std::min(k, end - 1)] + corner]);
    return ~at;
  }

  int node(int begin, int end) {
    if (end - begin <= kLeaf && !tree.children.empty()) return leaf(begin, end);
    const std::size_t at = tree.children.size();
    tree.children.emplace_back();
    std::array<int, kWays + 1> cut;
    cut[0] = begin;
    cut[kWays] = end;
    for (std::size_t width = kWays; width > 1; width /= 2)
      for (std::size_t k = 0; k < kWays; k += width)
        cut[k + width / 2] =
            cut[k + width] - cut[k] > kLeaf ? halve(cut[k], cut[k + width]) : cut[k + width];
    int last = 0;
    for (std::size_t k = 0; k < kWays; ++k) {
      const int child = cut[k] < cut[k + 1] ? node(cut[k], cut[k + 1]) : last;
      tree.children[at][k] = last = child;
    }
    return int(at);
  }
};

// Eight triangles at once (Moeller & Trumbore 1997, 10.1080/10867651.1997.10487468), a hair wider
// than they are: no ray slips through an edge. Whether one is hit before `far`, which then is how
// far; `behind`: from which side.
bool crosses(std::span<const float> positions, const int* corners, const Ray& ray, float& far,
             bool& behind) {
  constexpr float kHair = 1e-5f;
  const auto corner = [&](int k) {
    return xyz(gather_eight(positions.data(), corners + kLeaf * k));
  };
  const Wide3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
  const Wide3 p = cross(ray.direction, ac), s = ray.origin - a, q = cross(s, ab);
  const Float8 det = dot(ab, p), inverse = 1.0f / det;  // infinite where the ray lies in the plane:
                                                        // nothing is true of what follows
  const Float8 u = dot(s, p) * inverse, v = dot(ray.direction, q) * inverse,
               t = dot(ac, q) * inverse;
  Int8 hit = (u >= -kHair) & (v >= -kHair) & (u + v <= 1 + kHair) & (t >= ray.near) & (t <= far);
  if (ray.own >= 0) hit = hit & (det < 0) & ((t < ray.own - kHere) | (t > ray.own + kHere));
  const unsigned lanes = lanes_that(hit);
  for (unsigned left = lanes; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    if (t[lane] > far) continue;
    far = t[lane];
    behind = det[lane] < 0;
  }
  return lanes != 0;
}

// A node's boxes, after its children's.
void fit_node(const RefittedBvh& tree, std::span<const float> positions, std::size_t n,
              std::vector<float>& boxes) {
  std::array<Float4, kWays> low, high;
  for (std::size_t k = 0; k < kWays; ++k) {
    const int child = tree.children[n][k];
    if (child >= 0) {
      low[k] = load4(&boxes[kTreeBox * child + 48]);
      high[k] = load4(&boxes[kTreeBox * child + 52]);
      continue;
    }
    const int* corner = &tree.corners[~child];
    low[k] = high[k] = row(positions, corner[0]);
    for (int c = 1; c < 3 * kLeaf; ++c) {
      const Float4 p = row(positions, corner[c]);
      low[k] = least(low[k], p);
      high[k] = most(high[k], p);
    }
  }
  const auto columns = [](const std::array<Float4, kWays>& rows) {
    return transposed(halves(rows[0], rows[4]), halves(rows[1], rows[5]), halves(rows[2], rows[6]),
                      halves(rows[3], rows[7]));
  };
  const Wide4 lows = columns(low), highs = columns(high);
  float* box = &boxes[kTreeBox * n];
  for (const Float8 part : {lows.x, lows.y, lows.z, highs.x, highs.y, highs.z}) {
    store8(box, part);
    box += 8;
  }
  for (std::size_t k = 1; k < kWays; ++k) {
    low[0] = least(low[0], low[k]);
    high[0] = most(high[0], high[k]);
  }
  store4(box, low[0]);
  store4(box + 4, high[0]);
}

// A node's children that are nodes, each once, in the order of nodes.
std::span<const int> subtrees(const RefittedBvh& tree, std::size_t node,
                              std::array<int, kWays>& out) {
  std::size_t count = 0;
  for (const int child : tree.children[node])
    if (child > 0 && (count == 0 || out[count - 1] != child)) out[count++] = child;
  return {out.data(), count};
}

struct Sight {
  float distance = 0;  // 0: nothing
  bool behind = false;
};

Sight seen(const RefittedBvh& tree, std::span<const float> boxes, std::span<const float> positions,
           const Ray& ray, float far) {
  if (tree.children.empty()) return {};
  const float near = ray.near;
  struct Waiting {
    int child;
    float entry;
  };
  std::array<Waiting, kMostWaitingRefittedBvh> stack;
  std::size_t waiting = 1;
  stack[0] = {0, near};
  bool found = false, behind = false;
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.entry > far) continue;
    if (next.child < 0) {
      found = crosses(positions, &tree.corners[~next.child], ray, far, behind) || found;
      continue;
    }
    unsigned enters = 0;
    const Float8 entry = entries(&boxes[kTreeBox * next.child], ray, far, enters);
    const std::array<int, kWays>& children = tree.children[next.child];
    const std::size_t begin = waiting;
    for (; enters != 0; enters &= enters - 1) {
      const int k = std::countr_zero(enters);
      const int child = children[k];
      if (k > 0 && child == children[k - 1]) continue;
      std::size_t at = waiting++;  // the nearest one last
      for (; at > begin && stack[at - 1].entry < entry[k]; --at) stack[at] = stack[at - 1];
      stack[at] = {child, entry[k]};
    }
  }
  return found ? Sight{far, behind} : Sight{};
}

}  // namespace

RefittedBvh make_refitted_bvh(std::span<const float> positions, std::span<const int> triangles) {
  RefittedBvh out;
  Builder builder{triangles, {}, std::vector<int>(triangles.size() / 3), out};
  std::iota(builder.order.begin(), builder.order.end(), 0);
  for (std::size_t f = 0; f < triangles.size(); f += 3)
    builder.middles.push_back((row(positions, triangles[f]) + row(positions, triangles[f + 1]) +
                               row(positions, triangles[f + 2])) *
                              (1 / 3.0f));
  if (!triangles.empty()) builder.node(0, int(triangles.size() / 3));
  return out;
}

void fit_boxes(const RefittedBvh& tree, std::span<const float> positions,
               std::vector<float>& boxes) {
  boxes.resize(kTreeBox * tree.children.size());
  if (tree.children.empty()) return;
  // Whole subtrees of the third level at once, then what is above them. Nodes follow their parents,
  // a subtree's each other.
  constexpr std::size_t kMost = 1 + kWays + kWays * kWays + 1;
  std::array<std::size_t, kMost> begins;
  std::array<char, kMost> upper;
  std::size_t count = 0;
  const auto add = [&](std::size_t node, bool above) {
    begins[count] = node;
    upper[count++] = above;
  };
  add(0, true);
  std::array<int, kWays> children, grandchildren;
  for (const int child : subtrees(tree, 0, children)) {
    add(std::size_t(child), true);
    for (const int grandchild : subtrees(tree, std::size_t(child), grandchildren))
      add(std::size_t(grandchild), false);
  }
  begins[count] = tree.children.size();
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t part) {
    if (upper[part]) return;
    for (std::size_t n = begins[part + 1]; n-- > begins[part];) fit_node(tree, positions, n, boxes);
  });
  for (std::size_t part = count; part-- > 0;)
    if (upper[part]) fit_node(tree, positions, begins[part], boxes);
}

float back_seen(const RefittedBvh& tree, std::span<const float> boxes,
                std::span<const float> positions, Float4 from, Float4 direction, float near,
                float far) {
  const Sight sight = seen(tree, boxes, positions, make_ray(from, direction, near), far);
  return sight.behind ? sight.distance : 0;
}

float front_seen(const RefittedBvh& tree, std::span<const float> boxes,
                 std::span<const float> positions, Float4 from, Float4 direction, float near,
                 float far) {
  const Sight sight = seen(tree, boxes, positions, make_ray(from, direction, near), far);
  return sight.behind ? 0 : sight.distance;
}

float next_back(const RefittedBvh& tree, std::span<const float> boxes,
                std::span<const float> positions, Float4 from, Float4 direction, float own,
                float far) {
  Ray ray = make_ray(from, direction, 0);
  ray.own = own;
  return seen(tree, boxes, positions, ray, far).distance;
}

}  // namespace ecorche::inline v1
