#include "skinning/bind/muscle_handles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/edge_walker.h"

namespace ecorche::inline v1 {
namespace {

// m of tissue over the muscle: full effect below the first, none above the second
constexpr double kNear = 0.012, kFar = 0.045;
// least cosine between skin normal and direction out of the muscle
constexpr double kFacing = 0.35;
constexpr std::size_t kHandlesAVertex = 3;

struct Reached {
  int handle = 0;
  double distance = 0;
};

// Where the nearest muscle point lies on the smooth tube: the fraction between its two slices.
bool anchor_handle(const PosedAnatomy& rest, const SliceRange& range, const Anchor& anchor,
                   const Vec3& normal, const Vec3& p, MuscleHandle& handle) {
  const int k = std::clamp(anchor.part, range.begin, range.end - 2);
  const Vec3 a = rest.slices[k].center, b = rest.slices[k + 1].center;
  const double along =
      std::clamp((anchor.point - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-12), 0.0, 1.0);
  handle.anchor = {range.begin, range.end - 1, k + along};
  handle.surface = anchor.point;
  handle.normal = normal;
  const double height = (p - anchor.point).norm();
  const Vec3 center = a + along * (b - a);
  if ((anchor.point - center).normalized().dot(normal) < kFacing || height > kFar) return false;
  handle.weight = 1 - smooth_step(kNear, kFar, height);
  return handle.weight > 0.02;
}

}  // namespace

std::vector<WeightRow> place_muscle_handles(const Anatomy& anatomy, const PosedAnatomy& rest,
                                            const TriMesh& skin, const SkinDepth& depth,
                                            const std::vector<WeightRow>& rows, double spacing,
                                            HandleTables& tables) {
  const std::size_t n = rows.size();
  std::vector<int> range_of_slice(rest.slices.size(), -1);
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  for (std::size_t r = 0; r < ranges.size(); ++r)
    for (int s = ranges[r].begin; s < ranges[r].end; ++s) range_of_slice[s] = int(r);

  EdgeWalker walker(skin);
  std::vector<char> covered(n, 0);
  std::vector<std::vector<Reached>> reached(n);
  std::vector<int> vertices, kept;  // of every handle; its index in tables.handles or -1
  for (std::size_t i = 0; i < n; ++i) {
    if (covered[i]) continue;
    const int handle = vertices.size();
    vertices.push_back(int(i));
    walker.walk(int(i), 2.2 * spacing, [&](int v, double d) {
      if (d < spacing) covered[v] = 1;
      reached[v].push_back({handle, d});
    });
    MuscleHandle entry;
    entry.vertex = int(i);
    const Anchor& anchor = depth.muscles[i];
    const bool anchored = anchor.kind == Anchor::Kind::muscle &&
                          anchor_handle(rest, ranges[range_of_slice[anchor.part]], anchor,
                                        depth.normal[i], skin.V.row(i), entry);
    kept.push_back(anchored ? int(tables.handles.size()) : -1);
    if (!anchored) continue;
    for (const Influence& w : rows[i]) entry.frames.emplace_back(w.joint, float(w.weight));
    tables.handles.push_back(std::move(entry));
  }
  // Rings for smoothing: handles whose vertices see each other.
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (kept[k] < 0) continue;
    MuscleHandle& handle = tables.handles[kept[k]];
    for (const Reached& other : reached[vertices[k]]) {
      if (other.handle == int(k)) continue;
      handle.ring_size++;
      if (kept[other.handle] >= 0) handle.ring.push_back(kept[other.handle]);
    }
  }
  std::vector<WeightRow> handle_rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Reached>& near = reached[i];
    std::sort(near.begin(), near.end(), [](const Reached& a, const Reached& b) {
      return std::pair(a.distance, a.handle) < std::pair(b.distance, b.handle);
    });
    // The first handle left out sets the radius, so that weights fade to nothing where handles
    // change.
    const double radius =
        near.size() > kHandlesAVertex ? near[kHandlesAVertex].distance : 2.2 * spacing;
    double sum = 0;
    for (std::size_t k = 0; k < std::min(near.size(), kHandlesAVertex); ++k) {
      const double t = std::max(0.0, 1 - near[k].distance / std::max(radius, 1e-9));
      if (t <= 0) continue;
      sum += t * t;
      if (const int place = kept[near[k].handle]; place >= 0)
        handle_rows[i].push_back({place, t * t});
    }
    for (Influence& w : handle_rows[i]) w.weight /= sum;
    if (sum <= 0) handle_rows[i].clear();
  }
  return handle_rows;
}

}  // namespace ecorche::inline v1
