#include "skinning/muscle_collision/project_to_skin.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/geometry/vertex_rings.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kMostSteps = 40;

Float8 clamped(Float8 v) {
  const Float8 positive = v > 0 ? v : Float8{};
  return positive < 1 ? positive : all_eight(1);
}

// The points of eight triangles 0, b, c nearest to p, by their weights of b and c.
struct Barycentric {
  Float8 b{}, c{}, distance2{};
};

Barycentric nearest_barycentric(const Wide3& p, const Wide3& b, const Wide3& c) {
  constexpr float kTiny = 1e-20f;
  const Float8 bp = dot(b, p), cp = dot(c, p), bb = dot(b, b), cc = dot(c, c), bc = dot(b, c);
  const Float8 per = 1.0f / (bb * cc - bc * bc + kTiny);
  Barycentric out{per * (cc * bp - bc * cp), per * (bb * cp - bc * bp), {}};
  const Float8 on_b = clamped(bp / (bb + kTiny)), on_c = clamped(cp / (cc + kTiny));
  const Wide3 edge = c - b;
  const Float8 along = clamped(dot(p - b, edge) / (dot(edge, edge) + kTiny));
  const auto distance2 = [&](Float8 weight_b, Float8 weight_c) {
    const Wide3 way = p - (weight_b * b + weight_c * c);
    return dot(way, way);
  };
  const Float8 zero{}, one = all_eight(1), far_b = distance2(on_b, zero),
                       far_c = distance2(zero, on_c), far_bc = distance2(one - along, along);
  const auto inside = (out.b >= 0) & (out.c >= 0) & (out.b + out.c <= 1);
  const auto b_wins = (far_b <= far_c) & (far_b <= far_bc);
  const auto c_wins = far_c <= far_bc;
  out.b = inside ? out.b : (b_wins ? on_b : (c_wins ? zero : one - along));
  out.c = inside ? out.c : (b_wins ? zero : (c_wins ? on_c : along));
  out.distance2 = distance2(out.b, out.c);
  return out;
}

using Eights = std::array<const SkinRings::Eight*, 8>;  // one a lane

// Positions relative to a vertex, a lane each, so that no precision is lost far from the origin.
struct SkinView {
  const PosedSkin& skin;
  Wide3 base, points;  // `points`: relative to `base`

  Wide3 ways_to(const std::array<int, 8>& vertex) const {
    return xyz(gather_eight(skin.positions.data(), vertex.data())) - base - points;
  }
};

std::array<int, 8> neighbours(const Eights& eights, std::size_t k) {
  std::array<int, 8> out;
  for (std::size_t lane = 0; lane < 8; ++lane) out[lane] = eights[lane]->neighbour[k];
  return out;
}

// act(eights, most) for the first eight of every vertex's neighbours, and so on; a ring that has no
// more repeats its last. `most`: triangles in one of them.
template <class Act>
void each_eight(const SkinRings& rings, const std::array<int, 8>& vertex, const Act& act) {
  for (int e = 0, count = 1; e < count; ++e) {
    Eights eights;
    int most = 0;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const std::size_t v = vertex[lane];
      const int begin = rings.eight_begin[v], own = rings.eight_begin[v + 1] - begin;
      count = std::max(count, own);
      eights[lane] = &rings.eights[begin + std::min(e, own - 1)];
      most = std::max(most, eights[lane]->triangles);
    }
    act(eights, std::size_t(most));
  }
}

Int8 load_ints(const std::array<int, 8>& of) {
  Int8 out;
  std::memcpy(&out, of.data(), sizeof out);
  return out;
}

// Every lane's vertex goes to the nearest neighbour, if that is nearer; whether one does.
bool step_on(const SkinRings& rings, const SkinView& view, std::array<int, 8>& vertex,
             Float8& least_distance2) {
  Int8 nearest = load_ints(vertex), moved{};
  each_eight(rings, vertex, [&](const Eights& eights, std::size_t most) {
    for (std::size_t k = 0; k <= std::min<std::size_t>(most, 7); ++k) {
      const std::array<int, 8> other = neighbours(eights, k);
      const Wide3 way = view.ways_to(other);
      const Float8 distance2 = dot(way, way);
      const Int8 nearer = distance2 < least_distance2;
      least_distance2 = nearer ? distance2 : least_distance2;
      nearest = nearer ? load_ints(other) : nearest;
      moved |= nearer;
    }
  });
  std::memcpy(vertex.data(), &nearest, sizeof nearest);
  return lanes_that(moved) != 0;
}

// Of the triangles about each vertex, to which `to_vertex` leads, the nearest point.
void project_to_fans(const SkinRings& rings, const SkinView& view, const Wide3& to_vertex,
                     SkinProjections& projections) {
  const Wide3 from_a = all_eight(-1) * to_vertex;
  Float8 least_distance2 = all_eight(1e30f), weight_b{}, weight_c{};
  Int8 second = load_ints(projections.vertex), third = second;
  Wide3 way = from_a;
  each_eight(rings, projections.vertex, [&](const Eights& eights, std::size_t most) {
    Int8 triangles{};
    for (std::size_t lane = 0; lane < 8; ++lane) triangles[lane] = eights[lane]->triangles;
    std::array<int, 8> next = neighbours(eights, 0);
    Wide3 c = view.ways_to(next) + from_a;
    for (std::size_t k = 0; k < most; ++k) {
      const Int8 b_vertex = load_ints(next);
      const Wide3 b = c;
      next = neighbours(eights, (k + 1) % 8);
      c = view.ways_to(next) + from_a;
      const Barycentric weights = nearest_barycentric(from_a, b, c);
      const Int8 nearer = (weights.distance2 < least_distance2) & (triangles > int(k));
      const auto take = [&](const auto& better, auto& of) { of = nearer ? better : of; };
      take(weights.distance2, least_distance2);
      take(weights.b, weight_b);
      take(weights.c, weight_c);
      take(b_vertex, second);
      take(load_ints(next), third);
      take(from_a.x - (weights.b * b.x + weights.c * c.x), way.x);
      take(from_a.y - (weights.b * b.y + weights.c * c.y), way.y);
      take(from_a.z - (weights.b * b.z + weights.c * c.z), way.z);
    }
  });
  const auto normals_of = [&](Int8 vertex) {
    std::array<int, 8> numbers;
    std::memcpy(numbers.data(), &vertex, sizeof vertex);
    return xyz(gather_eight(view.skin.normals.data(), numbers.data()));
  };
  const Wide3 normal = normalized((1 - weight_b - weight_c) * projections.normal +
                                  weight_b * normals_of(second) + weight_c * normals_of(third));
  const Int8 shallow = projections.height >= -kDeepProjection;
  projections.height = shallow ? dot(way, normal) : projections.height;
  projections.normal = {shallow ? normal.x : projections.normal.x,
                        shallow ? normal.y : projections.normal.y,
                        shallow ? normal.z : projections.normal.z};
}

// Chains the sides that triangles have opposite to a vertex, and lays them out.
void add_eights(std::vector<std::array<int, 2>> sides, std::vector<SkinRings::Eight>& out) {
  while (!sides.empty()) {
    const auto is_start = [&](const std::array<int, 2>& side) {
      return std::none_of(sides.begin(), sides.end(),
                          [&](const auto& other) { return other[1] == side[0]; });
    };
    auto side = std::find_if(sides.begin(), sides.end(), is_start);
    if (side == sides.end()) side = sides.begin();
    std::vector<int> chain{(*side)[0]};
    while (side != sides.end()) {
      chain.push_back((*side)[1]);
      sides.erase(side);
      side = std::find_if(sides.begin(), sides.end(),
                          [&](const auto& other) { return other[0] == chain.back(); });
    }
    const bool fits = chain.size() == 9 && chain.front() == chain.back();
    if (fits) chain.pop_back();
    for (std::size_t begin = 0; begin + 1 < chain.size(); begin += 7) {
      SkinRings::Eight& eight = out.emplace_back();
      for (std::size_t k = 0; k < 8; ++k)
        eight.neighbour[k] = chain[std::min(begin + k, chain.size() - 1)];
      eight.triangles = fits ? 8 : int(std::min<std::size_t>(7, chain.size() - 1 - begin));
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
    out.ring_begin.push_back(int(out.ring.size()));
  }
  std::vector<std::vector<std::array<int, 2>>> sides(skin.V.rows());
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      sides[skin.F(f, k)].push_back({skin.F(f, (k + 1) % 3), skin.F(f, (k + 2) % 3)});
  out.eight_begin.push_back(0);
  for (std::vector<std::array<int, 2>>& about : sides) {
    add_eights(std::move(about), out.eights);
    if (int(out.eights.size()) == out.eight_begin.back())
      out.eights.emplace_back().neighbour.fill(int(out.eight_begin.size()) - 1);
    out.eight_begin.push_back(int(out.eights.size()));
  }
  return out;
}

SkinProjections project_to_skin(const SkinRings& rings, const PosedSkin& skin, const Wide3& points,
                                const std::array<int, 8>& from) {
  const SkinView view{skin, xyz(gather_eight(skin.positions.data(), from.data())), points};
  SkinProjections projections;
  projections.vertex = from;
  Float8 least_distance2 = dot(points, points);
  for (int step = 0; step < kMostSteps && step_on(rings, view, projections.vertex, least_distance2);
       ++step) {
  }
  const Wide3 way = view.ways_to(projections.vertex);
  projections.normal = xyz(gather_eight(skin.normals.data(), projections.vertex.data()));
  projections.height = -dot(way, projections.normal);
  if (lanes_that(projections.height >= -kDeepProjection) != 0)
    project_to_fans(rings, view, way, projections);
  return projections;
}

StillSkin make_still_skin(const TriMesh& mesh) {
  StillSkin out;
  out.positions.reserve(4 * std::size_t(mesh.V.rows()));
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v)
    for (int k = 0; k < 4; ++k) out.positions.push_back(k < 3 ? float(mesh.V(v, k)) : 1);
  out.normals.resize(out.positions.size());
  vertex_normals(out.positions, std::span(mesh.F.data(), std::size_t(mesh.F.size())), out.normals);
  return out;
}

int nearest_vertex(const TriMesh& skin, const SurfacePoint& hit, const Vec3& p) {
  const auto far = [&](int corner) {
    return (skin.V.row(skin.F(hit.triangle, corner)).transpose() - p).squaredNorm();
  };
  int corner = 0;
  for (int c = 1; c < 3; ++c)
    if (far(c) < far(corner)) corner = c;
  return skin.F(hit.triangle, corner);
}

}  // namespace ecorche::inline v1
