#include "skinning/skin_lie.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "skinning/lanes.h"
#include "skinning/skin_survey.h"

namespace ecorche {
namespace {

constexpr int kMostSteps = 40;

std::size_t at(int vertex) { return 4 * static_cast<std::size_t>(vertex); }

Wide3 same(Float4 v) { return {all_eight(v[0]), all_eight(v[1]), all_eight(v[2])}; }

Float8 clamped(Float8 v) {
  const Float8 positive = v > 0 ? v : Float8{};
  return positive < 1 ? positive : all_eight(1);
}

float least_of(Float8 v) {
  const auto smaller = [](Float8 a, Float8 b) { return a < b ? a : b; };
  v = smaller(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  v = smaller(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
  return smaller(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6))[0];
}

// The first lane that holds `value`.
int lane_of(Float8 v, float value) { return std::countr_zero(lanes_that(v == value) | 0x80u); }

// The points of eight triangles 0, b, c nearest to p, as shares of b and c.
struct Shares {
  Float8 b{}, c{}, distance2{};
};

Shares nearest_shares(const Wide3& p, const Wide3& b, const Wide3& c) {
  constexpr float kTiny = 1e-20f;
  const Float8 bp = dot(b, p), cp = dot(c, p), bb = dot(b, b), cc = dot(c, c), bc = dot(b, c);
  const Float8 per = 1.0f / (bb * cc - bc * bc + kTiny);
  Shares out{per * (cc * bp - bc * cp), per * (bb * cp - bc * bp), {}};
  const Float8 on_b = clamped(bp / (bb + kTiny)), on_c = clamped(cp / (cc + kTiny));
  const Wide3 edge = c - b;
  const Float8 along = clamped(dot(p - b, edge) / (dot(edge, edge) + kTiny));
  const auto distance2 = [&](Float8 share_b, Float8 share_c) {
    const Wide3 way = p - (share_b * b + share_c * c);
    return dot(way, way);
  };
  const Float8 zero{}, one = all_eight(1), far_b = distance2(on_b, zero), far_c = distance2(zero, on_c),
                       far_bc = distance2(one - along, along);
  const auto inside = (out.b >= 0) & (out.c >= 0) & (out.b + out.c <= 1);
  const auto b_wins = (far_b <= far_c) & (far_b <= far_bc);
  const auto c_wins = far_c <= far_bc;
  out.b = inside ? out.b : (b_wins ? on_b : (c_wins ? zero : one - along));
  out.c = inside ? out.c : (b_wins ? zero : (c_wins ? on_c : along));
  out.distance2 = distance2(out.b, out.c);
  return out;
}

std::span<const SkinRings::Eight> eights_of(const SkinRings& rings, int vertex) {
  const auto v = static_cast<std::size_t>(vertex);
  return {rings.eights.data() + rings.eight_begin[v], rings.eights.data() + rings.eight_begin[v + 1]};
}

// What positions are taken relative to: less is lost so than by their size.
struct Looker {
  const PosedSkin& skin;
  Wide3 base, p;  // `p`: relative to `base`

  Wide3 ways_to(const SkinRings::Eight& eight) const { return xyz(gather_eight(skin.positions.data(), eight.neighbour.data())) - base - p; }
};

// Of the triangles about a vertex, the nearest point. `about`: the ways to its neighbours, if they fill one eight
// and are known.
void look_at_fan(std::span<const SkinRings::Eight> eights, const Looker& looker, Float4 way_to_vertex, const Wide3* about, Lie& lie) {
  const PosedSkin& skin = looker.skin;
  const Wide3 from_a = same(-way_to_vertex);
  constexpr Float8 kLane{0, 1, 2, 3, 4, 5, 6, 7};
  float least_distance2 = 1e30f;
  for (const SkinRings::Eight& eight : eights) {
    const Wide3 b = (about ? *about : looker.ways_to(eight)) + from_a;
    const auto next = [](Float8 v) { return __builtin_shufflevector(v, v, 1, 2, 3, 4, 5, 6, 7, 0); };
    const Wide3 c{next(b.x), next(b.y), next(b.z)};
    const Shares shares = nearest_shares(from_a, b, c);
    const Float8 distance2 = kLane < static_cast<float>(eight.triangles) ? shares.distance2 : all_eight(1e30f);
    const float nearest = least_of(distance2);
    if (!(nearest < least_distance2)) continue;
    least_distance2 = nearest;
    const int best = lane_of(distance2, nearest);
    const float to_b = shares.b[best], to_c = shares.c[best];
    const int second = eight.neighbour[static_cast<std::size_t>(best)],
              third = eight.neighbour[static_cast<std::size_t>(best + 1) % 8];
    const Float4 normal = (1 - to_b - to_c) * load4(&skin.normals[at(lie.vertex)]) + to_b * load4(&skin.normals[at(second)]) +
                          to_c * load4(&skin.normals[at(third)]);
    lie.normal = normal * (1.0f / std::sqrt(sum4(normal * normal)[0] + 1e-30f));
    const Wide3 way = from_a - (all_eight(to_b) * b + all_eight(to_c) * c);
    lie.height = way.x[best] * lie.normal[0] + way.y[best] * lie.normal[1] + way.z[best] * lie.normal[2];
  }
}

// Chains the sides that triangles have opposite to a vertex, and lays them out.
void add_eights(std::vector<std::array<int, 2>> sides, std::vector<SkinRings::Eight>& out) {
  while (!sides.empty()) {
    const auto is_start = [&](const std::array<int, 2>& side) {
      return std::none_of(sides.begin(), sides.end(), [&](const auto& other) { return other[1] == side[0]; });
    };
    auto side = std::find_if(sides.begin(), sides.end(), is_start);
    if (side == sides.end()) side = sides.begin();
    std::vector<int> chain{(*side)[0]};
    while (side != sides.end()) {
      chain.push_back((*side)[1]);
      sides.erase(side);
      side = std::find_if(sides.begin(), sides.end(), [&](const auto& other) { return other[0] == chain.back(); });
    }
    const bool fits = chain.size() == 9 && chain.front() == chain.back();
    if (fits) chain.pop_back();
    for (std::size_t begin = 0; begin + 1 < chain.size(); begin += 7) {
      SkinRings::Eight& eight = out.emplace_back();
      for (std::size_t k = 0; k < 8; ++k) eight.neighbour[k] = chain[std::min(begin + k, chain.size() - 1)];
      eight.triangles = fits ? 8 : static_cast<int>(std::min<std::size_t>(7, chain.size() - 1 - begin));
      if (fits) break;
    }
  }
}

}  // namespace

SkinRings make_skin_rings(const TriMesh& skin) {
  SkinRings out;
  out.ring_begin.push_back(0);
  for (const std::vector<int>& neighbours : vertex_neighbours(skin)) {
    out.ring.insert(out.ring.end(), neighbours.begin(), neighbours.end());
    out.ring_begin.push_back(static_cast<int>(out.ring.size()));
  }
  std::vector<std::vector<std::array<int, 2>>> sides(static_cast<std::size_t>(skin.V.rows()));
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      sides[static_cast<std::size_t>(skin.F(f, k))].push_back({skin.F(f, (k + 1) % 3), skin.F(f, (k + 2) % 3)});
  out.eight_begin.push_back(0);
  for (std::vector<std::array<int, 2>>& about : sides) {
    add_eights(std::move(about), out.eights);
    out.eight_begin.push_back(static_cast<int>(out.eights.size()));
  }
  return out;
}

Lie lie_of(const SkinRings& rings, const PosedSkin& skin, Float4 point, int from) {
  const Float4 begin = load4(&skin.positions[at(from)]);
  const Looker looker{skin, same(begin), same(point)};
  Lie lie{from, 0, {}};
  float least_distance2 = sum4(point * point)[0];
  Wide3 about;
  bool arrived = false;
  for (int step = 0; step < kMostSteps && !arrived; ++step) {
    const int before = lie.vertex;
    for (const SkinRings::Eight& eight : eights_of(rings, before)) {
      about = looker.ways_to(eight);
      const Float8 distance2 = dot(about, about);
      const float nearest = least_of(distance2);
      if (!(nearest < least_distance2)) continue;
      least_distance2 = nearest;
      lie.vertex = eight.neighbour[static_cast<std::size_t>(lane_of(distance2, nearest))];
    }
    arrived = lie.vertex == before;
  }
  lie.normal = load4(&skin.normals[at(lie.vertex)]);
  const Float4 way = load4(&skin.positions[at(lie.vertex)]) - begin - point;
  lie.height = -sum4(way * lie.normal)[0];
  if (lie.height < -kDeepLie) return lie;
  const std::span<const SkinRings::Eight> eights = eights_of(rings, lie.vertex);
  look_at_fan(eights, looker, way, arrived && eights.size() == 1 ? &about : nullptr, lie);
  return lie;
}

}  // namespace ecorche
