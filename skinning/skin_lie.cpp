#include "skinning/skin_lie.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "skinning/lanes.h"
#include "skinning/skin_survey.h"

namespace ecorche {
namespace {

constexpr int kMostSteps = 40;

std::size_t at(int vertex) { return 4 * static_cast<std::size_t>(vertex); }

Lanes3 same(Float4 v) { return {all(v[0]), all(v[1]), all(v[2])}; }

Float4 clamped(Float4 v) { return least(most(v, all(0)), all(1)); }

// The points of four triangles 0, b, c nearest to p, as shares of b and c.
struct Shares {
  Float4 b{}, c{}, distance2{};
};

Shares nearest_shares(const Lanes3& p, const Lanes3& b, const Lanes3& c) {
  constexpr float kTiny = 1e-20f;
  const Float4 bp = dot(b, p), cp = dot(c, p), bb = dot(b, b), cc = dot(c, c), bc = dot(b, c);
  const Float4 per = 1.0f / (bb * cc - bc * bc + kTiny);
  Shares out{per * (cc * bp - bc * cp), per * (bb * cp - bc * bp), {}};
  const Float4 on_b = clamped(bp / (bb + kTiny)), on_c = clamped(cp / (cc + kTiny));
  const Lanes3 edge = c - b;
  const Float4 along = clamped(dot(p - b, edge) / (dot(edge, edge) + kTiny));
  const auto distance2 = [&](Float4 share_b, Float4 share_c) {
    const Lanes3 way = p - (share_b * b + share_c * c);
    return dot(way, way);
  };
  const Float4 zero{}, far_b = distance2(on_b, zero), far_c = distance2(zero, on_c), far_bc = distance2(all(1) - along, along);
  const auto inside = (out.b >= 0) & (out.c >= 0) & (out.b + out.c <= 1);
  const auto b_wins = (far_b <= far_c) & (far_b <= far_bc);
  const auto c_wins = far_c <= far_bc;
  out.b = inside ? out.b : (b_wins ? on_b : (c_wins ? zero : all(1) - along));
  out.c = inside ? out.c : (b_wins ? zero : (c_wins ? on_c : along));
  out.distance2 = distance2(out.b, out.c);
  return out;
}

// Of the fan about `vertex`, the nearest point; `base`: what positions are taken relative to.
void look_at_fan(const SkinRings& rings, const PosedSkin& skin, const Lanes3& p, const Lanes3& base, Lie& lie) {
  const Float4 corner = load4(&skin.positions[at(lie.vertex)]);
  const Lanes3 a = same(corner) - base, from_a = p - a;
  float least_distance2 = 1e30f;
  for (int k = rings.fan_begin[static_cast<std::size_t>(lie.vertex)]; k < rings.fan_begin[static_cast<std::size_t>(lie.vertex) + 1]; ++k) {
    const int *second = &rings.fan[8 * static_cast<std::size_t>(k)], *third = second + 4;
    const Lanes3 b = xyz(gather_rows(skin.positions.data(), second)) - base - a, c = xyz(gather_rows(skin.positions.data(), third)) - base - a;
    const Shares shares = nearest_shares(from_a, b, c);
    int best = -1;
    for (int lane = 0; lane < 4; ++lane)
      if (shares.distance2[lane] < least_distance2) least_distance2 = shares.distance2[lane], best = lane;
    if (best < 0) continue;
    const float to_b = shares.b[best], to_c = shares.c[best];
    const Float4 normal = (1 - to_b - to_c) * load4(&skin.normals[at(lie.vertex)]) + to_b * load4(&skin.normals[at(second[best])]) +
                          to_c * load4(&skin.normals[at(third[best])]);
    lie.normal = normal * (1.0f / std::sqrt(sum4(normal * normal)[0] + 1e-30f));
    const Lanes3 way = from_a - (all(to_b) * b + all(to_c) * c);
    lie.height = way.x[best] * lie.normal[0] + way.y[best] * lie.normal[1] + way.z[best] * lie.normal[2];
  }
}

// Fours of a list; the last is filled up with `filling`.
void add_fours(const std::vector<int>& list, int filling, std::vector<int>& out) {
  for (std::size_t k = 0; k < (list.size() + 3) / 4 * 4; ++k) out.push_back(k < list.size() ? list[k] : filling);
}

}  // namespace

SkinRings make_skin_rings(const TriMesh& skin) {
  SkinRings out;
  out.near_begin.push_back(0);
  out.ring_begin.push_back(0);
  int vertex = 0;
  for (const std::vector<int>& neighbours : vertex_neighbours(skin)) {
    add_fours(neighbours, vertex++, out.near);
    out.near_begin.push_back(static_cast<int>(out.near.size() / 4));
    out.ring.insert(out.ring.end(), neighbours.begin(), neighbours.end());
    out.ring_begin.push_back(static_cast<int>(out.ring.size()));
  }
  std::vector<std::vector<std::array<int, 2>>> fans(static_cast<std::size_t>(skin.V.rows()));
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) fans[static_cast<std::size_t>(skin.F(f, k))].push_back({skin.F(f, (k + 1) % 3), skin.F(f, (k + 2) % 3)});
  out.fan_begin.push_back(0);
  for (const auto& fan : fans) {
    for (std::size_t begin = 0; begin < fan.size(); begin += 4)
      for (std::size_t corner = 0; corner < 2; ++corner)
        for (std::size_t lane = 0; lane < 4; ++lane) out.fan.push_back(fan[std::min(begin + lane, fan.size() - 1)][corner]);
    out.fan_begin.push_back(static_cast<int>(out.fan.size() / 8));
  }
  return out;
}

Lie lie_of(const SkinRings& rings, const PosedSkin& skin, Float4 point, int from) {
  const Float4 begin = load4(&skin.positions[at(from)]);
  const Lanes3 p = same(point), base = same(begin);
  Lie lie{from, 0, {}};
  float least_distance2 = sum4(point * point)[0];
  for (int step = 0; step < kMostSteps; ++step) {
    const int before = lie.vertex;
    for (int k = rings.near_begin[static_cast<std::size_t>(before)]; k < rings.near_begin[static_cast<std::size_t>(before) + 1]; ++k) {
      const int* near = &rings.near[4 * static_cast<std::size_t>(k)];
      const Lanes3 way = xyz(gather_rows(skin.positions.data(), near)) - base - p;
      const Float4 distance2 = dot(way, way);
      for (int lane = 0; lane < 4; ++lane)
        if (distance2[lane] < least_distance2) least_distance2 = distance2[lane], lie.vertex = near[lane];
    }
    if (lie.vertex == before) break;
  }
  lie.normal = load4(&skin.normals[at(lie.vertex)]);
  const Float4 way = point - (load4(&skin.positions[at(lie.vertex)]) - begin);
  lie.height = sum4(way * lie.normal)[0];
  if (lie.height < -kDeepLie) return lie;
  look_at_fan(rings, skin, p, base, lie);
  return lie;
}

}  // namespace ecorche
