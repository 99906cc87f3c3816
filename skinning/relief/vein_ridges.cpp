#include "skinning/relief/vein_ridges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/compute/parallel_ranges.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kReachOfRidge = 3;     // widths
constexpr double kWidthInEdges = 0.6;   // at least, of the mean edge
constexpr double kWidest = 0.006;       // m
constexpr double kThroughBody = 0.012;  // m: veins of the other side of a finger do not count

struct Piece {
  Vec3 from, to, low, high;
  double width = 0, height = 0;
};

std::vector<Piece> pieces_of(std::span<const VeinPath> veins) {
  std::vector<Piece> out;
  for (const VeinPath& vein : veins)
    for (std::size_t i = 1; i < vein.points.size(); ++i) {
      const double reach = kReachOfRidge * std::max(vein.width, kWidest);
      const Vec3 a = vein.points[i - 1], b = vein.points[i];
      out.push_back({a, b, (a.cwiseMin(b).array() - reach).matrix(),
                     (a.cwiseMax(b).array() + reach).matrix(), vein.width, vein.height});
    }
  return out;
}

double distance_to(const Piece& piece, const Vec3& p) {
  const Vec3 along = piece.to - piece.from;
  const double share =
      std::clamp((p - piece.from).dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - piece.from - share * along).norm();
}

}  // namespace

std::vector<float> vein_ridges(std::span<const VeinPath> veins, const SurfaceGraph& skin,
                               std::span<const double> thickness) {
  const std::vector<Piece> pieces = pieces_of(veins);
  std::vector<float> out(skin.ring.size(), 0.0f);
  if (pieces.empty()) return out;
  parallel_for_ranges(out.size(), 512, Threads::all, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 p = skin.at.row(Eigen::Index(v));
      double highest = 0;
      for (const Piece& piece : pieces) {
        if ((p.array() < piece.low.array()).any() || (p.array() > piece.high.array()).any())
          continue;
        const double far = distance_to(piece, p);
        const double width =
            std::min(std::max(piece.width, kWidthInEdges * mean_edge(skin, int(v))), kWidest);
        if (far > std::min(kReachOfRidge * width, kThroughBody)) continue;
        const double height = piece.height * piece.width / std::max(width, piece.width);
        highest = std::max(highest, height * std::exp(-0.5 * far * far / (width * width)));
      }
      const double over = std::max(thickness[v] - kSkinAlone, 0.0);
      out[v] = float(highest * std::exp(-over / kVeinFade));
    }
  });
  return out;
}

}  // namespace ecorche::inline v1
