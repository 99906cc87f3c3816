#include "skinning/relief/relief_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <queue>
#include <tuple>

namespace ecorche::inline v1 {
namespace {

// Node of each vertex: the nearest along edges, by one wave from all nodes.
std::vector<int> nearest_nodes(const SurfaceGraph& skin, const std::vector<int>& nodes) {
  using Reached = std::tuple<double, int, int>;  // distance, vertex, node
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> wave;
  std::vector<int> out(skin.ring.size(), -1);
  for (std::size_t n = 0; n < nodes.size(); ++n) wave.emplace(0, nodes[n], int(n));
  while (!wave.empty()) {
    const auto [far, v, n] = wave.top();
    wave.pop();
    if (out[std::size_t(v)] >= 0) continue;
    out[std::size_t(v)] = n;
    for (const int u : skin.ring[std::size_t(v)])
      if (out[std::size_t(u)] < 0)
        wave.emplace(far + (skin.at.row(u) - skin.at.row(v)).norm(), u, n);
  }
  return out;
}

// Vertices in their order, each unless one that is joined to it within its spacing was taken.
std::vector<int> choose_nodes(const SurfaceGraph& skin) {
  std::vector<char> near(skin.ring.size(), 0);
  std::vector<int> out, reached;
  std::vector<int> seen_by(skin.ring.size(), -1);
  for (std::size_t v = 0; v < near.size(); ++v) {
    if (near[v]) continue;
    out.push_back(int(v));
    const Vec3 at = skin.at.row(Eigen::Index(v));
    const double reach = std::min(kNodeSpacing, kNodeEdges * mean_edge(skin, int(v)));
    reached.assign(1, int(v));
    seen_by[v] = int(v);
    for (std::size_t next = 0; next < reached.size(); ++next) {
      near[std::size_t(reached[next])] = 1;
      for (const int u : skin.ring[std::size_t(reached[next])])
        if (seen_by[std::size_t(u)] != int(v) && (Vec3(skin.at.row(u)) - at).norm() < reach) {
          seen_by[std::size_t(u)] = int(v);
          reached.push_back(u);
        }
    }
  }
  return out;
}

SurfaceGraph graph_of_nodes(const SurfaceGraph& skin, const std::vector<int>& nodes,
                            const std::vector<int>& node_of) {
  SurfaceGraph out{Points(Eigen::Index(nodes.size()), 3),
                   std::vector<std::vector<int>>(nodes.size()),
                   std::vector<double>(nodes.size(), 0)};
  for (std::size_t n = 0; n < nodes.size(); ++n)
    out.at.row(Eigen::Index(n)) = skin.at.row(nodes[n]);
  for (std::size_t v = 0; v < node_of.size(); ++v) {
    const std::size_t n = std::size_t(node_of[v]);
    out.area[n] += skin.area[v];
    for (const int u : skin.ring[v])
      if (node_of[std::size_t(u)] != node_of[v]) out.ring[n].push_back(node_of[std::size_t(u)]);
  }
  for (std::vector<int>& ring : out.ring) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }
  return out;
}

}  // namespace

ReliefNodes make_relief_nodes(const SurfaceGraph& skin, std::span<const char> wanted) {
  ReliefNodes out;
  out.vertex = choose_nodes(skin);
  const std::vector<int> node_of = nearest_nodes(skin, out.vertex);
  out.graph = graph_of_nodes(skin, out.vertex, node_of);
  out.wanted.assign(out.vertex.size(), 0);
  std::vector<std::vector<int>> members(out.vertex.size());
  for (std::size_t v = 0; v < node_of.size(); ++v) {
    const std::size_t n = std::size_t(node_of[v]);
    members[n].push_back(int(v));
    out.wanted[n] = out.wanted[n] || wanted[v];
  }
  out.to.first.push_back(0);
  for (std::size_t n = 0; n < members.size(); ++n) {
    double sum = 0;
    for (const int v : members[n]) sum += std::max(skin.area[std::size_t(v)], 1e-12);
    for (const int v : members[n]) {
      out.to.vertex.push_back(v);
      out.to.weight.push_back(float(std::max(skin.area[std::size_t(v)], 1e-12) / sum));
    }
    out.to.first.push_back(int(out.to.vertex.size()));
  }
  out.from.first.push_back(0);
  for (std::size_t v = 0; v < node_of.size(); ++v) {
    if (wanted[v]) {
      const int own = node_of[v];
      std::vector<int> near = out.graph.ring[std::size_t(own)];
      near.push_back(own);
      // Narrower where nodes are closer: their own spacing counts.
      const double width = std::min(kFromNodes, 0.6 * mean_edge(out.graph, own));
      double sum = 0;
      std::vector<double> weights;
      for (const int n : near) {
        const double far = (out.graph.at.row(n) - skin.at.row(Eigen::Index(v))).norm() / width;
        weights.push_back(std::exp(-0.5 * far * far) + 1e-9);
        sum += weights.back();
      }
      for (std::size_t k = 0; k < near.size(); ++k) {
        out.from.vertex.push_back(near[k]);
        out.from.weight.push_back(float(weights[k] / sum));
      }
    }
    out.from.first.push_back(int(out.from.vertex.size()));
  }
  return out;
}

}  // namespace ecorche::inline v1
