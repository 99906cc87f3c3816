#include "skinning/bind/muscle_handles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "anatomy/compute/smooth_step.h"
#include "skinning/bind/muscle_offsets.h"

namespace ecorche {
namespace {

constexpr double kNear = 0.012, kFar = 0.045;  // m over the muscle: full effect, none
// least cosine between skin normal and direction out of the muscle
constexpr double kFacing = 0.35;
constexpr std::size_t kNodesAVertex = 3;

struct Reached {
  int node = 0;
  double distance = 0;
};

// Vertices within `limit` of `start` along the edges of the skin.
class Walker {
 public:
  Walker(const TriMesh& skin)
      : skin_(skin),
        neighbours_(vertex_neighbours(skin)),
        distance_(neighbours_.size(), kUnreached) {}

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
        const double next = d + (skin_.V.row(i) - skin_.V.row(k)).norm();
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
  const TriMesh& skin_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<double> distance_;
  std::vector<int> touched_;
};

// Where the nearest muscle point lies on the smooth tube: the share between its two slices.
bool anchor_node(const PosedAnatomy& rest, const SliceRange& range, const Anchor& anchor,
                 const Vec3& normal, const Vec3& p, MuscleNode& node) {
  const int k = std::clamp(anchor.part, range.begin, range.end - 2);
  const Vec3 a = rest.slices[k].center, b = rest.slices[k + 1].center;
  const double along =
      std::clamp((anchor.point - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-12), 0.0, 1.0);
  node.anchor = {range.begin, range.end - 1, k + along};
  node.surface = anchor.point;
  node.normal = normal;
  const double height = (p - anchor.point).norm();
  const Vec3 center = a + along * (b - a);
  if ((anchor.point - center).normalized().dot(normal) < kFacing || height > kFar) return false;
  node.weight = 1 - smooth_step(kNear, kFar, height);
  return node.weight > 0.02;
}

}  // namespace

std::vector<ShareRow> place_nodes(const Anatomy& anatomy, const PosedAnatomy& rest,
                                  const TriMesh& skin, const SkinSurvey& survey,
                                  const std::vector<ShareRow>& rows, double spacing,
                                  SkinTables& tables) {
  const std::size_t n = rows.size();
  std::vector<int> range_of_slice(rest.slices.size(), -1);
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  for (std::size_t r = 0; r < ranges.size(); ++r)
    for (int s = ranges[r].begin; s < ranges[r].end; ++s) range_of_slice[s] = int(r);

  Walker walker(skin);
  std::vector<char> covered(n, 0);
  std::vector<std::vector<Reached>> reached(n);
  std::vector<int> vertices, kept;  // of every node; its place in tables.nodes or -1
  for (std::size_t i = 0; i < n; ++i) {
    if (covered[i]) continue;
    const int node = vertices.size();
    vertices.push_back(int(i));
    walker.walk(int(i), 2.2 * spacing, [&](int v, double d) {
      if (d < spacing) covered[v] = 1;
      reached[v].push_back({node, d});
    });
    MuscleNode entry;
    entry.vertex = int(i);
    const Anchor& anchor = survey.muscles[i];
    const bool anchored = anchor.kind == Anchor::Kind::muscle &&
                          anchor_node(rest, ranges[range_of_slice[anchor.part]], anchor,
                                      survey.normal[i], skin.V.row(i), entry);
    kept.push_back(anchored ? int(tables.nodes.size()) : -1);
    if (!anchored) continue;
    for (const Influence& w : rows[i]) entry.carriers.emplace_back(w.joint, float(w.weight));
    tables.nodes.push_back(std::move(entry));
  }
  // Rings for smoothing: nodes whose vertices see each other.
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (kept[k] < 0) continue;
    MuscleNode& node = tables.nodes[kept[k]];
    for (const Reached& other : reached[vertices[k]]) {
      if (other.node == int(k)) continue;
      node.ring_size++;
      if (kept[other.node] >= 0) node.ring.push_back(kept[other.node]);
    }
  }
  std::vector<ShareRow> node_rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Reached>& near = reached[i];
    std::sort(near.begin(), near.end(), [](const Reached& a, const Reached& b) {
      return std::pair(a.distance, a.node) < std::pair(b.distance, b.node);
    });
    // The first node left out sets the radius, so that weights fade to nothing where nodes change.
    const double radius =
        near.size() > kNodesAVertex ? near[kNodesAVertex].distance : 2.2 * spacing;
    double sum = 0;
    for (std::size_t k = 0; k < std::min(near.size(), kNodesAVertex); ++k) {
      const double t = std::max(0.0, 1 - near[k].distance / std::max(radius, 1e-9));
      if (t <= 0) continue;
      sum += t * t;
      if (const int place = kept[near[k].node]; place >= 0) node_rows[i].push_back({place, t * t});
    }
    for (Influence& w : node_rows[i]) w.weight /= sum;
    if (sum <= 0) node_rows[i].clear();
  }
  return node_rows;
}

}  // namespace ecorche
