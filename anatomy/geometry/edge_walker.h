// Vertices near a vertex, by the length of the shortest way along the edges of a mesh.
#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "anatomy/geometry/vertex_rings.h"

namespace ecorche::inline v1 {

// Walks from many vertices one after another, in memory that is kept.
class EdgeWalker {
 public:
  // Precondition: the mesh outlives the walker.
  explicit EdgeWalker(const TriMesh& mesh)
      : mesh_(mesh),
        neighbours_(vertex_neighbours(mesh)),
        distance_(neighbours_.size(), kUnreached) {}

  const std::vector<int>& neighbours(int vertex) const { return neighbours_[vertex]; }

  // visit(vertex, distance) for every vertex nearer than `limit`, m, the nearest first.
  template <typename Visit>
  void walk(int start, double limit, Visit visit) {
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
        front;
    front.emplace(0.0, start);
    distance_[start] = 0;
    touched_.assign(1, start);
    while (!front.empty()) {
      const auto [d, i] = front.top();
      front.pop();
      if (d > distance_[i]) continue;
      visit(i, d);
      for (int k : neighbours_[i]) {
        const double next = d + (mesh_.V.row(i) - mesh_.V.row(k)).norm();
        if (next >= limit || next >= distance_[k]) continue;
        if (distance_[k] == kUnreached) touched_.push_back(k);
        distance_[k] = next;
        front.emplace(next, k);
      }
    }
    for (int i : touched_) distance_[i] = kUnreached;
  }

 private:
  static constexpr double kUnreached = std::numeric_limits<double>::infinity();
  const TriMesh& mesh_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<double> distance_;
  std::vector<int> touched_;
};

}  // namespace ecorche::inline v1
