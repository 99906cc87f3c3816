#include "skinning/contact_patches.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "skinning/float4.h"

namespace ecorche {
namespace {

constexpr std::size_t kPatch = 48;                     // vertices
constexpr std::size_t kTask = 16;                      // patches
constexpr float kNearer = 0.97f;                       // of the distance at rest
constexpr float kRight = std::numbers::pi_v<float> / 2;
constexpr float kFold = 0.7f, kNewFold = 0.1f;         // rad: spread of a patch that may meet itself; and beyond its own at rest

Float4 row(std::span<const float> rows, int i) { return load4(&rows[4 * static_cast<std::size_t>(i)]); }

float angle(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

std::span<const int> hull_of(const ContactPatches& patches, std::size_t p) {
  return std::span(patches.hull).subspan(static_cast<std::size_t>(patches.hull_first[p]), static_cast<std::size_t>(patches.hull_first[p + 1] - patches.hull_first[p]));
}

PatchScratch::Shape shape_of(std::span<const int> hull, float reach, std::span<const float> positions, std::span<const float> normals) {
  PatchScratch::Shape out;
  Float4 low = row(positions, hull[0]), high = low, sum{}, up{};
  for (const int i : hull) {
    const Float4 p = row(positions, i);
    low = least(low, p);
    high = most(high, p);
    sum += p;
    up += row(normals, i);
  }
  up *= 1 / std::sqrt(sum4(up * up)[0] + 1e-30f);
  float least = 1;
  for (const int i : hull) least = std::min(least, sum4(up * row(normals, i))[0]);
  store4(out.low, low);
  store4(out.high, high);
  out.reach = reach;
  store4(out.middle, sum * (1 / static_cast<float>(hull.size())));
  store4(out.up, up);
  out.spread = angle(least);
  return out;
}

bool overlap(const PatchScratch::Shape& a, const PatchScratch::Shape& b) {
  const float reach = std::max(a.reach, b.reach);
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - reach > b.high[k] || b.low[k] - reach > a.high[k]) return false;
  return true;
}

bool may_meet(const ContactPatches& patches, const std::vector<PatchScratch::Shape>& shapes, std::size_t a, std::size_t b) {
  const PatchScratch::Shape &A = shapes[a], &B = shapes[b];
  if (!overlap(A, B)) return false;
  const Float4 way = load4(A.middle) - load4(B.middle), rest = load4(&patches.rest_middle[4 * a]) - load4(&patches.rest_middle[4 * b]);
  if (sum4(way * way)[0] >= kNearer * kNearer * sum4(rest * rest)[0]) return false;
  return angle(sum4(load4(A.up) * load4(B.up))[0]) + A.spread + B.spread > kRight;
}

// The vertices of a patch that are within reach of another one and, by their normals, may be on its far side.
bool mark(const ContactPatches& patches, std::size_t patch, const PatchScratch::Shape& other, std::span<const float> give, std::span<const float> positions,
          std::span<const float> normals, std::vector<char>& wanted) {
  const Float4 low = load4(other.low), high = load4(other.high), up = load4(other.up);
  const float facing = other.spread < kRight ? std::sin(other.spread) : 1;
  bool any = false;
  for (int k = patches.first[patch]; k < patches.first[patch + 1]; ++k) {
    const int i = patches.vertex[static_cast<std::size_t>(k)];
    const Float4 p = row(positions, i), beyond = most(low - p, p - high);
    const float reach = give[static_cast<std::size_t>(i)];
    if (beyond[0] > reach || beyond[1] > reach || beyond[2] > reach || reach <= 0 || sum4(up * row(normals, i))[0] > facing) continue;
    wanted[static_cast<std::size_t>(i)] = 1;
    any = true;
  }
  return any;
}

}  // namespace

ContactPatches cut_patches(const Membrane& rings, std::span<const float> positions, std::span<const float> normals, std::span<const float> give) {
  ContactPatches out;
  const std::size_t n = give.size();
  std::vector<int> patch(n, -1), seen(n, -1);
  for (std::size_t start = 0; start < n; ++start) {
    if (patch[start] >= 0) continue;
    const int p = static_cast<int>(out.first.size());
    const std::size_t begin = out.vertex.size();
    out.first.push_back(static_cast<int>(begin));
    out.hull_first.push_back(static_cast<int>(out.hull.size()));
    patch[start] = p;
    out.vertex.push_back(static_cast<int>(start));
    float reach = 0;
    for (std::size_t k = begin; k < out.vertex.size(); ++k) {
      const std::size_t i = static_cast<std::size_t>(out.vertex[k]);
      reach = std::max(reach, give[i]);
      const auto reach_for = [&](int v) {
        if (seen[static_cast<std::size_t>(v)] == p) return;
        seen[static_cast<std::size_t>(v)] = p;
        out.hull.push_back(v);
      };
      reach_for(static_cast<int>(i));
      for (int e = rings.first[i]; e < rings.first[i + 1]; ++e) {
        const int j = rings.neighbour[static_cast<std::size_t>(e)];
        reach_for(j);
        if (patch[static_cast<std::size_t>(j)] >= 0 || out.vertex.size() - begin >= kPatch) continue;
        patch[static_cast<std::size_t>(j)] = p;
        out.vertex.push_back(j);
      }
    }
    out.reach.push_back(reach);
    const PatchScratch::Shape shape = shape_of(std::span(out.hull).subspan(static_cast<std::size_t>(out.hull_first.back())), reach, positions, normals);
    out.rest_middle.insert(out.rest_middle.end(), shape.middle, shape.middle + 4);
    out.rest_spread.push_back(shape.spread);
  }
  out.first.push_back(static_cast<int>(out.vertex.size()));
  out.hull_first.push_back(static_cast<int>(out.hull.size()));
  return out;
}

bool find_meetings(const ContactPatches& patches, std::span<const float> give, std::span<const float> positions, std::span<const float> normals, PatchScratch& s,
                   std::vector<char>& wanted) {
  const std::size_t count = patches.reach.size();
  s.shapes.resize(count);
  wanted.assign(give.size(), 0);
  s.met.assign(count, 0);
  const tbb::blocked_range<std::size_t> all(0, count, kTask);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p) s.shapes[p] = shape_of(hull_of(patches, p), patches.reach[p], positions, normals);
  });
  tbb::parallel_for(all, [&](const auto& range) {  // each marks its own vertices
    for (std::size_t a = range.begin(); a < range.end(); ++a) {
      bool any = s.shapes[a].spread > std::max(kFold, patches.rest_spread[a] + kNewFold) && mark(patches, a, s.shapes[a], give, positions, normals, wanted);
      for (std::size_t b = 0; b < count; ++b)
        if (a != b && may_meet(patches, s.shapes, a, b)) any = mark(patches, a, s.shapes[b], give, positions, normals, wanted) || any;
      s.met[a] = any;
    }
  });
  return std::find(s.met.begin(), s.met.end(), 1) != s.met.end();
}

}  // namespace ecorche
