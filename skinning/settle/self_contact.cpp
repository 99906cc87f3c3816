#include "skinning/settle/self_contact.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "anatomy/compute/simd_lanes.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/queries/ray_bundle.h"

namespace ecorche::inline v1 {

namespace {

constexpr SelfContactParameters kParametersSelfContact;
constexpr int kBlockSelfContact = 512;  // vertices a task
constexpr int kThicknessRings = 2;
constexpr std::size_t kPatches = 16;  // a task
constexpr std::size_t kManyRays = 4;  // rays of a patch from which on triangles are gathered first

struct Surface {
  const RefittedBvh& tree;
  std::span<const float> boxes, positions;
};

// The ray of a vertex: from a little before it inwards, as far as it may be pushed.
struct InwardRay {
  Float4 from, normal;
  float gap = 0, reach = 0;
};

InwardRay inward_ray(const Surface& surface, const SelfContact& contact,
                     std::span<const float> normals, std::size_t vertex) {
  const Float4 normal = load4(&normals[4 * vertex]);
  return {load4(&surface.positions[4 * vertex]) + contact.gap[vertex] * normal, normal,
          contact.gap[vertex], kParametersSelfContact.look_behind * contact.max_push[vertex]};
}

// Half of the way out, and of the gap. A point before the vertex that is inside another part sees
// the back of the surface that it came through a little way behind it, at `depth`, and some back
// ahead of it; the ray behind comes first, as it is short and mostly settles the matter.
Float4 find_push(const Surface& surface, const InwardRay& ray, float depth) {
  if (depth <= 0 || back_seen(surface.tree, surface.boxes, surface.positions, ray.from, ray.normal,
                              0, kParametersSelfContact.ray_length) <= 0)
    return Float4{};
  const float fade = std::clamp(2 - 2 * (depth - ray.gap) / ray.reach, 0.0f, 1.0f);
  return (-0.5f * fade * depth) * ray.normal;
}

template <class Do>
void each_vertex(int count, const Do& act) {
  tbb::parallel_for(0, (count + kBlockSelfContact - 1) / kBlockSelfContact, [&](int block) {
    for (int i = block * kBlockSelfContact; i < std::min(count, (block + 1) * kBlockSelfContact);
         ++i)
      act(i);
  });
}

// The pushes of a patch's candidates. Where these are many, the triangles behind them are gathered
// first.
void find_pushes(const Surface& surface, const SelfContact& contact, std::span<const float> normals,
                 std::span<const int> patch, SelfContactWorkspace& s) {
  std::size_t count = 0;
  Float4 low = all(1e30f), high = all(-1e30f);
  for (const int i : patch) {
    const std::size_t at = i;
    if (!s.wanted[at]) continue;
    const InwardRay ray = inward_ray(surface, contact, normals, at);
    const Float4 end = ray.from - (ray.gap + ray.reach) * ray.normal;
    low = least(low, least(ray.from, end));
    high = most(high, most(ray.from, end));
    ++count;
  }
  RayBundle bundle;
  const bool gathered = count >= kManyRays && gather_leaves(surface.tree, surface.boxes,
                                                            surface.positions, low, high, bundle);
  for (const int i : patch) {
    const std::size_t at = i;
    if (!s.wanted[at]) continue;
    const InwardRay ray = inward_ray(surface, contact, normals, at);
    const float far = ray.gap + ray.reach;
    const float depth = gathered ? next_back(bundle, ray.from, -ray.normal, ray.gap, far)
                                 : next_back(surface.tree, surface.boxes, surface.positions,
                                             ray.from, -ray.normal, ray.gap, far);
    store4(&s.pushes[4 * at], find_push(surface, ray, depth));
  }
}

// The pushes of all candidates; s.pushed: those that get one.
void find_pushes(const Surface& surface, const SelfContact& contact, std::span<const float> normals,
                 SelfContactWorkspace& s) {
  std::fill(s.pushes.begin(), s.pushes.end(), 0.0f);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, contact.patches.reach.size(), kPatches),
      [&](const auto& range) {
        for (std::size_t p = range.begin(); p < range.end(); ++p) {
          const std::span<const int> patch = own_of(contact.patches.groups, p);
          if (std::any_of(patch.begin(), patch.end(), [&](int i) { return s.wanted[i] != 0; }))
            find_pushes(surface, contact, normals, patch, s);
        }
      });
  s.pushed.clear();
  for (std::size_t i = 0; i < s.wanted.size(); ++i) {
    if (!s.wanted[i]) continue;
    const Float4 push = load4(&s.pushes[4 * i]);
    s.wanted[i] = sum4(push * push)[0] > 0;
    if (s.wanted[i]) s.pushed.push_back(int(i));
  }
}

// Vertices about those that are pushed follow by a fraction.
void spread_pushes(const Membrane& rings, std::span<const float> max_push,
                   SelfContactWorkspace& s) {
  std::size_t begin = 0;
  for (int round = 0; round < kParametersSelfContact.spread_rings; ++round) {
    for (const std::size_t end = s.pushed.size(); begin < end; ++begin)
      for (int k = rings.first[s.pushed[begin]]; k < rings.first[s.pushed[begin] + 1]; ++k) {
        const std::size_t j = rings.neighbour[k];
        if (s.wanted[j] || max_push[j] <= 0) continue;
        s.wanted[j] = 1;
        s.pushed.push_back(int(j));
      }
    each_vertex(int(s.pushed.size()), [&](int p) {
      const std::size_t i = s.pushed[p];
      Float4 push = load4(&s.pushes[4 * i]), sum{};
      for (int k = rings.first[i]; k < rings.first[i + 1]; ++k)
        sum += load4(&s.pushes[4 * rings.neighbour[k]]);
      sum *= kParametersSelfContact.spread_fraction / float(rings.first[i + 1] - rings.first[i]);
      store4(&s.spread[4 * i], sum4(sum * sum)[0] > sum4(push * push)[0] ? sum : push);
    });
    each_vertex(int(s.pushed.size()), [&](int p) {
      const std::size_t at = 4 * std::size_t(s.pushed[p]);
      store4(&s.pushes[at], load4(&s.spread[at]));
    });
  }
}

// Normals of those that have been pushed and of their neighbours.
void renew_normals(const Membrane& rings, const SelfContact& contact,
                   std::span<const float> positions, std::span<float> normals,
                   SelfContactWorkspace& s) {
  s.turning.clear();
  const auto add = [&](int i) {
    char& turned = s.turned[i];
    if (!turned) s.turning.push_back(i);
    turned = 1;
  };
  for (const int i : s.pushed) {
    add(i);
    for (int k = rings.first[i]; k < rings.first[i + 1]; ++k) add(rings.neighbour[k]);
  }
  each_vertex(int(s.turning.size()), [&](int t) {
    const std::size_t i = s.turning[t];
    const auto place = [&](int corner) { return load4(&positions[4 * contact.about[corner]]); };
    Float4 sum{};
    for (int k = contact.about_first[i]; k < contact.about_first[i + 1]; k += 3) {
      const Float4 a = place(k);
      sum += cross(place(k + 1) - a, place(k + 2) - a);
    }
    store4(&normals[4 * i], sum * (1.0f / std::sqrt(sum4(sum * sum)[0] + 1e-30f)));
    s.turned[i] = 0;
  });
}

void find_triangles(std::span<const int> triangles, std::size_t vertices, SelfContact& out) {
  out.about_first.assign(vertices + 1, 0);
  for (const int v : triangles) out.about_first[v + 1] += 3;
  std::partial_sum(out.about_first.begin(), out.about_first.end(), out.about_first.begin());
  out.about.resize(3 * triangles.size());
  std::vector<int> next(out.about_first.begin(), out.about_first.end() - 1);
  for (std::size_t f = 0; f < triangles.size(); f += 3)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c) out.about[next[triangles[f + k]]++] = triangles[f + c];
}

// How thick the skin's part is at each vertex, square to it, the least within kThicknessRings, m.
std::vector<float> part_thickness(const Membrane& rings, const Surface& surface,
                                  std::span<const float> normals) {
  std::vector<float> out(normals.size() / 4);
  each_vertex(int(out.size()), [&](int vertex) {
    const std::size_t i = std::size_t(vertex);
    const float across =
        next_back(surface.tree, surface.boxes, surface.positions, load4(&surface.positions[4 * i]),
                  -load4(&normals[4 * i]), 0, kParametersSelfContact.thickest);
    out[i] = across > 0 ? across : kParametersSelfContact.thickest;
  });
  for (int round = 0; round < kThicknessRings; ++round) {
    const std::vector<float> before = out;
    for (std::size_t i = 0; i < out.size(); ++i)
      for (int k = rings.first[i]; k < rings.first[i + 1]; ++k)
        out[i] = std::min(out[i], before[std::size_t(rings.neighbour[k])]);
  }
  return out;
}

}  // namespace

SelfContact make_self_contact(const Membrane& rings, std::span<const float> positions,
                              std::span<const int> triangles, std::span<const double> tissue) {
  SelfContact out;
  out.tree = make_refitted_bvh(positions, triangles);
  std::vector<float> boxes;
  fit_boxes(out.tree, positions, boxes);
  std::vector<float> normals(positions.size());
  vertex_normals(positions, triangles, normals);
  const std::vector<float> thickness = part_thickness(rings, {out.tree, boxes, positions}, normals);
  for (std::size_t i = 0; i < tissue.size(); ++i) {
    const Float4 p = load4(&positions[4 * i]), n = load4(&normals[4 * i]);
    const bool inside =
        back_seen(out.tree, boxes, positions, p, n, kParametersSelfContact.ray_start,
                  kParametersSelfContact.ray_length) > 0;
    const float before =
        front_seen(out.tree, boxes, positions, p, n, kParametersSelfContact.ray_start,
                   2 * kParametersSelfContact.gap);
    const float of_tissue = float(kParametersSelfContact.push_of_tissue * tissue[i] +
                                  kParametersSelfContact.least_push);
    out.max_push.push_back(
        inside ? 0 : std::min(of_tissue, kParametersSelfContact.push_of_thickness * thickness[i]));
    out.gap.push_back(before > 0 ? before / 2 : kParametersSelfContact.gap);
  }
  find_triangles(triangles, tissue.size(), out);
  out.patches = cut_patches(rings, positions, normals, out.max_push);
  return out;
}

bool separate_skin(const Membrane& rings, const SelfContact& contact,
                   std::span<const int> triangles, RelaxedSkin& skin, SelfContactWorkspace& s) {
  std::vector<float>& positions = skin.positions;
  std::vector<float>& normals = skin.normals;
  const std::size_t n = positions.size() / 4;
  const std::vector<float>& max_push = contact.max_push;
  for (std::vector<float>* each : {&s.pushes, &s.spread, &normals}) each->resize(4 * n);
  s.wanted.resize(n);
  s.pushed.reserve(n);
  s.turned.resize(n, 0);
  s.turning.reserve(n);
  vertex_normals(positions, triangles, normals, s.half);
  if (!find_contact_vertices(contact.patches,
                             {max_push, kParametersSelfContact.gap, positions, normals}, s.patches,
                             s.wanted))
    return false;
  s.before.assign(positions.begin(), positions.end());
  bool moved = false;
  for (int round = 0; round < kParametersSelfContact.rounds; ++round) {
    fit_boxes(contact.tree, positions, s.boxes);
    find_pushes({contact.tree, s.boxes, positions}, contact, normals, s);
    spread_pushes(rings, max_push, s);
    each_vertex(int(s.pushed.size()), [&](int p) {
      const std::size_t i = s.pushed[p];
      const Float4 start = load4(&s.before[4 * i]);
      Float4 way = load4(&positions[4 * i]) + load4(&s.pushes[4 * i]) - start;
      const float length = std::sqrt(sum4(way * way)[0]);
      if (length > max_push[i]) way *= max_push[i] / length;
      store4(&positions[4 * i], start + way);
    });
    if (s.pushed.empty()) break;
    renew_normals(rings, contact, positions, normals, s);
    moved = true;
  }
  return moved;
}

void find_liftable(const SelfContact& contact, RelaxedSkin& skin, SelfContactWorkspace& s) {
  skin.liftable = skin.openness;
  if (!find_contact_vertices(contact.patches, {contact.max_push, 0, skin.positions, skin.normals},
                             s.patches, s.wanted))
    return;
  for (std::size_t i = 0; i < skin.liftable.size(); ++i)
    skin.liftable[i] *= s.wanted[i] ? kParametersSelfContact.liftable_in_contact : 1.0f;
}

bool resolve_self_contact(const Membrane& rings, const SelfContact& contact,
                          std::span<const int> triangles, RelaxedSkin& skin,
                          SelfContactWorkspace& s) {
  const std::size_t n = skin.openness.size();
  skin.pressed.assign(n, 0);
  const bool moved = separate_skin(rings, contact, triangles, skin, s);
  // Tissue that contact has pressed away swells where nothing presses.
  for (std::size_t i = 0; moved && i < n; ++i) {
    const Float4 way = load4(&skin.positions[4 * i]) - load4(&s.before[4 * i]);
    const float square = sum4(way * way)[0];
    if (!(square > 0)) continue;
    const float share = std::sqrt(square) / kParametersSelfContact.pressed;
    skin.pressed[i] = share > 1;
    skin.openness[i] *= std::max(0.0f, 1 - share);
  }
  return moved;
}

}  // namespace ecorche::inline v1
