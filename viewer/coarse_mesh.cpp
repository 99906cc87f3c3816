#include "viewer/coarse_mesh.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace ecorche {
namespace {

constexpr float kLeastTurn = 0.2f;  // cosine between the normals of a vertex and its stand-in
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Neighbours of all vertices over edges, one after the other.
struct Neighbours {
  std::vector<std::uint32_t> begin, of;

  Neighbours(std::size_t vertices, std::span<const Triangle32> triangles)
      : begin(vertices + 1, 0), of(6 * triangles.size()) {
    for (const Triangle32& t : triangles)
      for (int k = 0; k < 3; ++k) begin[t[k] + 1] += 2;
    for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const Triangle32& t : triangles)
      for (int k = 0; k < 3; ++k) {
        of[next[t[k]]++] = t[(k + 1) % 3];
        of[next[t[k]]++] = t[(k + 2) % 3];
      }
  }
};

}  // namespace

std::vector<std::uint32_t> standing_for(std::span<const Vec3f> positions,
                                        std::span<const Vec3f> normals,
                                        std::span<const Triangle32> triangles, float reach) {
  const Neighbours near(positions.size(), triangles);
  std::vector<std::uint32_t> out(positions.size(), kNone), open;
  for (std::uint32_t v = 0; v < out.size(); ++v) {
    if (out[v] != kNone) continue;
    out[v] = v;
    open.assign(1, v);
    while (!open.empty()) {
      const std::uint32_t from = open.back();
      open.pop_back();
      for (std::uint32_t k = near.begin[from]; k < near.begin[from + 1]; ++k) {
        const std::uint32_t u = near.of[k];
        if (out[u] != kNone || (positions[u] - positions[v]).squaredNorm() > reach * reach ||
            normals[u].dot(normals[v]) < kLeastTurn)
          continue;
        out[u] = v;
        open.push_back(u);
      }
    }
  }
  return out;
}

std::vector<Triangle32> coarse_triangles(std::span<const Triangle32> triangles,
                                         std::span<const std::uint32_t> standing) {
  std::vector<Triangle32> out;
  for (const Triangle32& t : triangles) {
    const Triangle32 c(standing[t[0]], standing[t[1]], standing[t[2]]);
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) out.push_back(c);
  }
  return out;
}

}  // namespace ecorche
