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

// The middle of the deepest run within `reach` of a height, seen from `before`; kNone: no place is
// deeper than its ends.
double notch(const NearestSurface& skin, const Vec3& before, double reach) {
  const int half = int(reach / kStep);
  std::vector<double> depths;
  for (int k = -half; k <= half; ++k)
    depths.push_back(skin.cast(before + k * kStep * Vec3::UnitY(), -Vec3::UnitZ())
                         .value_or(std::numeric_limits<double>::max()));
  const double deepest = *std::ranges::max_element(depths);
  if (deepest < 0.5 * (depths.front() + depths.back()) + kNotch) return kNone;
  double sum = 0, count = 0;
  for (int k = -half; k <= half; ++k)
    if (depths[std::size_t(k + half)] > deepest - kNotch) sum += before.y() + k * kStep, ++count;
  return sum / count;
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
