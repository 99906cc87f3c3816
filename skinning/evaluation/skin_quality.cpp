#include "skinning/evaluation/skin_quality.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "skinning/bind/blend_frames.h"

namespace ecorche {
namespace {

Vec3 area_vector(const Points& V, const Triangles& F, Eigen::Index f) {
  const Vec3 a = V.row(F(f, 0)), b = V.row(F(f, 1)), c = V.row(F(f, 2));
  return (b - a).cross(c - a);
}

// Rotation of the flesh at each vertex: the mean of its carriers' rotations by its shares.
std::vector<Eigen::Vector4d> vertex_turns(const SkinTables& tables,
                                          std::span<const Transform> X_WJ) {
  std::vector<Quat> turns;
  chain_turns(tables, X_WJ, turns);
  std::vector<Eigen::Vector4d> out(tables.vertex_count, Eigen::Vector4d::Zero());
  for (const VertexRun& run : tables.runs)
    for (int e = run.begin; e < run.end; ++e) {
      const std::size_t sorted = tables.place[e];
      Eigen::Vector4d& sum = out[tables.order.empty() ? sorted : std::size_t(tables.order[sorted])];
      for (int k = 0; k < run.carriers; ++k) {
        const std::size_t entry =
            run.carrier_entry + std::size_t((e - run.begin) * run.carriers + k);
        if (tables.carrier[entry] < turns.size())
          sum += tables.carrier_weight[entry] * turns[tables.carrier[entry]].coeffs();
      }
    }
  return out;
}

void measure_edges(const TriMesh& rest, const Points& V, SkinQuality& out) {
  std::vector<double> stretch;
  stretch.reserve(3 * rest.F.rows());
  for (Eigen::Index f = 0; f < rest.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = rest.F(f, k), b = rest.F(f, (k + 1) % 3);
      const double length = (rest.V.row(a) - rest.V.row(b)).norm();
      if (a < b && length > 0) stretch.push_back((V.row(a) - V.row(b)).norm() / length);
    }
  if (stretch.empty()) return;
  const auto [low, high] = std::minmax_element(stretch.begin(), stretch.end());
  out.stretch_min = *low;
  out.stretch_max = *high;
  const auto p99 = stretch.begin() + std::ptrdiff_t(0.99 * double(stretch.size() - 1));
  std::nth_element(stretch.begin(), p99, stretch.end());
  out.stretch_p99 = *p99;
}

}  // namespace

std::vector<std::vector<std::array<int, 2>>> open_rims(const std::vector<int>& triangles,
                                                       const Triangles& F) {
  std::set<std::array<int, 2>> edges;
  for (int f : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = F(f, k), b = F(f, (k + 1) % 3);
      if (edges.erase({b, a}) == 0) edges.insert({a, b});
    }
  std::vector<std::vector<std::array<int, 2>>> rims;
  while (!edges.empty()) {
    std::vector<std::array<int, 2>> rim;
    auto it = edges.begin();
    while (it != edges.end()) {
      const std::array<int, 2> edge = *it;
      edges.erase(it);
      rim.push_back({edge[1], edge[0]});
      it = edges.lower_bound({edge[1], -1});
      if (it != edges.end() && (*it)[0] != edge[1]) it = edges.end();
    }
    rims.push_back(std::move(rim));
  }
  return rims;
}

std::vector<LimbSection> limb_sections(const Skeleton& skeleton, const TriMesh& skin,
                                       const Binding& binding) {
  return limb_sections(skeleton, skin, binding.joint_weights);
}

std::vector<LimbSection> limb_sections(const Skeleton& skeleton, const TriMesh& skin,
                                       std::span<const std::array<Influence, 4>> joint_weights) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::vector<LimbSection> out;
  for (const auto& [upper, middle, lower] :
       {std::array{"shoulder", "elbow", "wrist"}, std::array{"hip", "knee", "ankle"}})
    for (const std::string side : {"_l", "_r"}) {
      const int u = find_joint(skeleton, upper + side), m = find_joint(skeleton, middle + side),
                l = find_joint(skeleton, lower + side);
      if (u < 0 || m < 0 || l < 0) continue;
      std::set<int> limb{u, m};  // the upper joint and everything below it
      for (std::size_t j = 0; j < skeleton.joints.size(); ++j)
        if (limb.count(skeleton.joints[j].parent) > 0) limb.insert(int(j));
      const auto at = [&](int j) { return origins[j]; };
      LimbSection section{middle + side, {}, {}};
      for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
        double share = 0;
        for (int k = 0; k < 3; ++k)
          for (const Influence& w : joint_weights[skin.F(f, k)])
            if (limb.count(w.joint) > 0) share += w.weight / 3;
        const Vec3 p =
            (skin.V.row(skin.F(f, 0)) + skin.V.row(skin.F(f, 1)) + skin.V.row(skin.F(f, 2))) / 3;
        const bool below = (p - 0.5 * (at(u) + at(m))).dot(at(m) - at(u)) > 0;
        const bool above = (p - 0.5 * (at(m) + at(l))).dot(at(l) - at(m)) < 0;
        if (share > 0.5 && below && above) section.triangles.push_back(int(f));
      }
      section.rims = open_rims(section.triangles, skin.F);
      out.push_back(std::move(section));
    }
  return out;
}

double section_volume(const LimbSection& section, const Triangles& F, const Points& V) {
  double six = 0;
  for (int f : section.triangles)
    six += Vec3(V.row(F(f, 0))).dot(Vec3(V.row(F(f, 1))).cross(Vec3(V.row(F(f, 2)))));
  for (const std::vector<std::array<int, 2>>& rim : section.rims) {
    Vec3 center = Vec3::Zero();
    for (const std::array<int, 2>& edge : rim) center += V.row(edge[0]);
    center /= double(rim.size());
    for (const std::array<int, 2>& edge : rim)
      six += center.dot(Vec3(V.row(edge[0])).cross(Vec3(V.row(edge[1]))));
  }
  return six / 6;
}

std::vector<int> flipped_triangles(const TriMesh& rest, const Binding& binding,
                                   std::span<const Transform> X_WJ, const Points& V) {
  if (V.rows() != rest.V.rows() || binding.vertex_count != rest.V.rows())
    throw std::invalid_argument(
        "flipped_triangles: the shape, the rest skin and the binding differ in their number of "
        "vertices");
  std::vector<int> out;
  const std::vector<Eigen::Vector4d> turns = vertex_turns(*binding.tables, X_WJ);
  for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int k = 0; k < 3; ++k) sum += turns[rest.F(f, k)];
    if (area_vector(V, rest.F, f).dot(Quat(sum).normalized() * area_vector(rest.V, rest.F, f)) < 0)
      out.push_back(int(f));
  }
  return out;
}

SkinQuality measure_skin(const TriMesh& rest, const Binding& binding,
                         std::span<const LimbSection> sections, std::span<const Transform> X_WJ,
                         const SkinFrame& frame) {
  if (frame.positions.size() != 4 * std::size_t(rest.V.rows()) ||
      binding.vertex_count != rest.V.rows())
    throw std::invalid_argument(
        "measure_skin: the frame, the rest skin and the binding differ in their number of "
        "vertices");
  SkinQuality out;
  Points V;
  to_points(frame, V);
  out.triangles = rest.F.rows();
  for (Eigen::Index i = 0; i < V.rows(); ++i) out.not_finite += !V.row(i).allFinite();
  out.flipped = flipped_triangles(rest, binding, X_WJ, V).size();
  out.flipped_share = out.triangles > 0 ? double(out.flipped) / out.triangles : 0;
  measure_edges(rest, V, out);
  for (const LimbSection& section : sections) {
    const double before = section_volume(section, rest.F, rest.V);
    out.limb_volume_change.push_back((section_volume(section, rest.F, V) - before) / before);
  }
  return out;
}

}  // namespace ecorche
