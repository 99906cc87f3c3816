#include "anatomy/queries/mouth_line.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kColumn = 0.001;                   // m
constexpr double kReach = 0.012, kNext = 0.003;     // m up and down
constexpr double kStep = 0.00025, kNotch = 0.0005;  // m
constexpr double kAbout = 0.03;                     // m about the jaw
constexpr double kFront = 0.85;                     // of the jaw's length
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::size_t column(const MouthLine& line, double x) {
  return std::size_t(std::abs(x - line.middle) / kColumn);
}
const std::vector<double>& side(const MouthLine& line, double x) {
  return x > line.middle ? line.left : line.right;
}

// The middle of the most prominent notch within `reach` of a height, seen from `before`: what is
// deepest beyond the shallowest places on both sides, so that a chin's groove at the end of the
// reach is none. kNone: there is no notch.
double notch(const NearestSurface& skin, const Vec3& before, double reach) {
  const int half = int(reach / kStep), count = 2 * half + 1;
  std::vector<double> depths;
  for (int k = -half; k <= half; ++k)
    depths.push_back(skin.cast(before + k * kStep * Vec3::UnitY(), -Vec3::UnitZ())
                         .value_or(std::numeric_limits<double>::max()));
  std::vector<double> below = depths, above = depths;  // the shallowest up to each place
  for (int k = 1; k < count; ++k) below[k] = std::min(below[k], below[k - 1]);
  for (int k = count - 2; k >= 0; --k) above[k] = std::min(above[k], above[k + 1]);
  const auto prominence = [&](int k) { return depths[k] - std::max(below[k], above[k]); };
  int best = 0;
  for (int k = 1; k < count; ++k)
    if (prominence(k) > prominence(best)) best = k;
  if (prominence(best) < kNotch) return kNone;
  int first = best, last = best;
  while (first > 0 && depths[first - 1] > depths[best] - kNotch) --first;
  while (last + 1 < count && depths[last + 1] > depths[best] - kNotch) ++last;
  return before.y() + (0.5 * (first + last) - half) * kStep;
}

}  // namespace

bool MouthLine::spans(double x) const { return column(*this, x) < side(*this, x).size(); }

double MouthLine::over(const Vec3& p) const {
  const std::vector<double>& heights = side(*this, p.x());
  return p.y() - heights[std::min(column(*this, p.x()), heights.size() - 1)];
}

std::optional<MouthLine> find_mouth(const Anatomy& anatomy, const TriMesh& skin) {
  const int joint = find_joint(anatomy.skeleton, "jaw");
  std::vector<Vec3> jaw;
  for (const Bone& bone : anatomy.bones)
    if (joint >= 0 && bone.joint == joint)
      for (Eigen::Index i = 0; i < bone.mesh.V.rows(); ++i) jaw.emplace_back(bone.mesh.V.row(i));
  if (jaw.empty()) return std::nullopt;
  Vec3 low = jaw[0], high = jaw[0];
  for (const Vec3& p : jaw) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double teeth = low.z() + kFront * (high.z() - low.z());
  double edge = low.y();
  for (const Vec3& p : jaw)
    if (p.z() > teeth) edge = std::max(edge, p.y());
  MouthLine out;
  out.middle = 0.5 * (low.x() + high.x());
  out.low = low - kAbout * Vec3::Ones();
  out.high = high + kAbout * Vec3::Ones();
  out.low.z() = 0.5 * (low.z() + high.z());
  const NearestSurface surface(skin);
  const double before = skin.V.col(2).maxCoeff() + 0.1;
  const double first = notch(surface, {out.middle, edge, before}, kReach);
  for (const double way : {1.0, -1.0}) {
    std::vector<double>& heights = way > 0 ? out.left : out.right;
    heights = {std::isnan(first) ? edge : first};
    for (int k = 1; !std::isnan(first) && k * kColumn < high.x() - out.middle; ++k) {
      const double x = out.middle + way * k * kColumn;
      const double y = notch(surface, {x, heights.back(), before}, kNext);
      if (std::isnan(y)) break;
      heights.push_back(y);
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
