#include "skinning/foot_contacts.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ecorche {
namespace {

constexpr double kLowHeight = 0.025, kHighHeight = 0.040;  // m
constexpr double kSlow = 0.35, kFast = 0.60;               // m/s
constexpr double kShortest = 0.060, kGap = 0.060;          // s
constexpr double kSamePlace = 0.03;                        // m

int joint_of(const Skeleton& skeleton, const std::string& name) {
  const int j = find_joint(skeleton, name);
  if (j < 0) throw std::invalid_argument("feet: our skeleton has no joint '" + name + "'");
  return j;
}

// A moving average over +-reach frames with weights of a raised cosine.
std::vector<double> smoothed(const std::vector<double>& values, int reach) {
  const int n = static_cast<int>(values.size());
  std::vector<double> out(n);
  for (int f = 0; f < n; ++f) {
    double sum = 0, weight = 0;
    for (int g = f - reach; g <= f + reach; ++g) {
      const double k = 1 + std::cos(3.14159265358979323846 * (g - f) / (reach + 1));
      sum += k * values[std::clamp(g, 0, n - 1)];
      weight += k;
    }
    out[f] = sum / weight;
  }
  return out;
}

}  // namespace

double guess_sole_height(const Skeleton& skeleton) {
  const std::vector<Vec3> at = rest_positions(skeleton);
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t j = 0; j < at.size(); ++j) lowest = std::min(lowest, at[j].y());
  const double ankle = at[joint_of(skeleton, "ankle_l")].y();
  return lowest - 0.25 * (ankle - lowest);  // toe joints lie about a fifth of the ankle's height over the ground
}

FootShape foot_shape(const Skeleton& skeleton, Side side, double sole_height) {
  const std::string s = side_suffix(side);
  const std::vector<Vec3> at = rest_positions(skeleton);
  FootShape foot;
  foot.hip = joint_of(skeleton, "hip" + s);
  foot.knee = joint_of(skeleton, "knee" + s);
  foot.ankle = joint_of(skeleton, "ankle" + s);
  foot.subtalar = joint_of(skeleton, "subtalar" + s);
  Vec3 ball = Vec3::Zero();
  for (int k = 0; k < 5; ++k) {
    foot.mtp[k] = joint_of(skeleton, "mtp" + std::to_string(k + 1) + s);
    ball += 0.2 * at[foot.mtp[k]];
  }
  const Vec3 toes = 0.5 * (at[joint_of(skeleton, "toe_dip2" + s)] + at[joint_of(skeleton, "toe_dip3" + s)]);
  auto level = [&](const Vec3& p) { return Vec3(p.x(), sole_height, p.z()); };
  foot.ball = level(ball);
  const Vec3 ankle = level(at[foot.ankle]);
  // Behind the ankle the heel is 0.4 as long as the way to the ball; the toes end 0.15 of it before their last joints.
  foot.heel = ankle - 0.40 * (foot.ball - ankle);
  foot.tip = level(toes) + 0.15 * (foot.ball - ankle);
  return foot;
}

FootPoints foot_points(const Skeleton& skeleton, const FootShape& foot, const std::vector<Transform>& X) {
  Vec3 subtalar = Vec3::Zero(), toe = Vec3::Zero();
  for (int j = foot.subtalar; j >= 0; j = skeleton.joints[j].parent) subtalar += skeleton.joints[j].X_PJ.translation();
  toe = subtalar + skeleton.joints[foot.mtp[1]].X_PJ.translation();
  return {X[foot.subtalar] * (foot.heel - subtalar), X[foot.subtalar] * (foot.ball - subtalar),
          X[foot.mtp[1]] * (foot.tip - toe)};
}

double remove_floor_drift(std::array<FootPaths, 2>& paths, Motion& motion) {
  constexpr double kBand = 0.06, kStanding = 0.5, kSteady = 0.15;  // m; hips this far over the floor, m; s
  const int n = static_cast<int>(motion.frames.size());
  const std::array<const std::vector<Vec3>*, 4> tracks = {&paths[0].heel, &paths[0].ball, &paths[1].heel, &paths[1].ball};
  std::vector<std::pair<int, double>> shown, run;  // frame, height of the floor; a run of slow frames
  for (int f = 1; f <= n; ++f) {
    bool slow = false;
    if (f < n) {
      const auto* low =
          *std::min_element(tracks.begin(), tracks.end(), [&](auto* a, auto* b) { return (*a)[f].y() < (*b)[f].y(); });
      slow = ((*low)[f] - (*low)[f - 1]).norm() * motion.fps < kSlow && motion.frames[f].root.y() - (*low)[f].y() > kStanding;
      if (slow) run.push_back({f, (*low)[f].y()});
    }
    if (slow) continue;
    if (run.size() > kSteady * motion.fps) shown.insert(shown.end(), run.begin(), run.end());  // slower than the turn of a jump
    run.clear();
  }
  if (shown.size() < 10) return 0;
  std::vector<double> floor(n);
  size_t k = 0;
  for (int f = 0; f < n; ++f) {
    while (k + 1 < shown.size() && shown[k + 1].first <= f) ++k;
    const auto& [f0, y0] = shown[k];
    const auto& [f1, y1] = shown[std::min(k + 1, shown.size() - 1)];
    floor[f] = y0 + (y1 - y0) * std::clamp((f - f0) / std::max(1.0, static_cast<double>(f1 - f0)), 0.0, 1.0);
  }
  floor = smoothed(floor, std::max(1, static_cast<int>(0.25 * motion.fps)));
  const auto [low, high] = std::minmax_element(floor.begin(), floor.end());
  if (*high - *low < kBand) return 0;
  const double drift = *high - *low;
  for (int f = 0; f < n; ++f) {
    motion.frames[f].root.y() -= floor[f];
    for (FootPaths& foot : paths) foot.heel[f].y() -= floor[f], foot.ball[f].y() -= floor[f];
  }
  return drift;
}

std::vector<Interval> standing_intervals(const std::vector<Vec3>& path, double ground, double fps) {
  const int n = static_cast<int>(path.size());
  // The slower of the ways to the neighbouring frames: the first and last frame on the ground count as standing.
  auto speed = [&](int f) {
    const double before = f > 0 ? (path[f] - path[f - 1]).norm() : HUGE_VAL,
                 after = f + 1 < n ? (path[f + 1] - path[f]).norm() : HUGE_VAL;
    return n > 1 ? std::min(before, after) * fps : 0.0;
  };
  std::vector<Interval> out;
  for (int f = 0; f < n; ++f) {
    Interval run{f, f};
    bool sure = false;
    for (; run.end < n; ++run.end) {
      const double height = path[run.end].y() - ground, v = speed(run.end);
      if (height > kHighHeight || v > kFast) break;
      sure |= height < kLowHeight && v < kSlow;
    }
    f = run.end;
    if (!sure) continue;
    if (!out.empty() && run.begin - out.back().end < kGap * fps &&
        (path[run.begin] - path[out.back().end - 1]).norm() < kSamePlace)
      out.back().end = run.end;
    else
      out.push_back(run);
  }
  std::erase_if(out, [&](const Interval& i) { return i.end - i.begin < kShortest * fps; });
  return out;
}

}  // namespace ecorche
