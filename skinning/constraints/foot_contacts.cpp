#include "skinning/constraints/foot_contacts.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "anatomy/chain_kinematics.h"
#include "anatomy/joint_angles.h"
#include "skinning/constraints/temporal_smoothing.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

// Contact detection with hysteresis: a contact continues below the larger thresholds and has a
// frame below the smaller ones. Larger: swinging feet are planted; smaller: contacts are missed.
constexpr double kLowHeight = 0.025, kHighHeight = 0.040;  // m over the floor
constexpr double kSlow = 0.35, kFast = 0.60;               // m/s
constexpr double kShortestFootContacts = 0.060;            // s; shorter contacts are dropped
constexpr double kGap = 0.060, kSamePlace = 0.03;          // s, m; smaller gaps are closed
constexpr double kSampled = 240;                           // a second, of the path's curve
constexpr double kSpeedSpan = 1.0 / 48;                    // s; speeds are means over it
constexpr double kCalmed = 0.03;  // s; half the width of the mean that takes a recording's tremble
// A foot that is shifted: the mean speed over twice kWay, and how long it stays before and after.
constexpr double kWay = 0.05, kTravels = 0.3, kStays = 0.12;  // s, m/s, s

// A Catmull-Rom curve through the points, `fine` samples from each to the next.
std::vector<Vec3> sampled_curve(const std::vector<Vec3>& points, int fine) {
  const int last = int(points.size()) - 1;
  std::vector<Vec3> out;
  for (int f = 0; f < last; ++f) {
    const Vec3 &a = points[f], &b = points[f + 1];
    const Vec3 at_a = f > 0 ? Vec3(0.5 * (b - points[f - 1])) : Vec3(b - a),
               at_b = f + 1 < last ? Vec3(0.5 * (points[f + 2] - a)) : Vec3(b - a);
    for (int k = 0; k < fine; ++k) {
      const double t = double(k) / fine, u = 1 - t;
      out.push_back(u * u * (1 + 2 * t) * a + t * t * (3 - 2 * t) * b +
                    t * u * (u * at_a - t * at_b));
    }
  }
  out.push_back(points[last]);
  return out;
}

// Without what a recording trembles: means under a raised cosine, nearer to the ends less wide.
std::vector<Vec3> calmed(const std::vector<Vec3>& curve, double rate) {
  const int last = int(curve.size()) - 1, widest = int(std::lround(kCalmed * rate));
  std::vector<Vec3> out;
  for (int k = 0; k <= last; ++k) {
    const int reach = std::min({widest, k, last - k});
    out.push_back(raised_cosine_mean(reach, Vec3(Vec3::Zero()), [&](int i) -> const Vec3& {
      return curve[std::size_t(k + i)];
    }));
  }
  return out;
}

// Parts of runs of samples between which the point goes to another place.
std::vector<Interval> in_places(const std::vector<Vec3>& curve, const std::vector<Interval>& runs,
                                double rate) {
  const int apart = std::max(1, int(std::lround(kWay * rate)));
  const auto way = [&](int from, int to) {
    return std::hypot(curve[std::size_t(to)].x() - curve[std::size_t(from)].x(),
                      curve[std::size_t(to)].z() - curve[std::size_t(from)].z());
  };
  std::vector<Interval> out;
  for (Interval run : runs) {
    const auto travels = [&](int k) {
      return k - apart >= run.begin && k + apart < run.end &&
             way(k - apart, k + apart) > 2 * kWay * kTravels;
    };
    const Interval whole = run;
    for (int k = whole.begin; k < whole.end; ++k) {
      if (!travels(k)) continue;
      int end = k;
      while (travels(end)) ++end;
      const int left = k - apart, there = end - 1 + apart;
      if (std::min(left - run.begin, whole.end - there) >= kStays * rate &&
          way(left, there) > kSamePlace) {
        out.push_back({run.begin, left + 1});
        run.begin = there;
      }
      k = end;
    }
    out.push_back(run);
  }
  return out;
}

}  // namespace

double guess_sole_height(const Skeleton& skeleton) {
  const std::vector<Vec3> at = rest_positions(skeleton);
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t j = 0; j < at.size(); ++j) lowest = std::min(lowest, at[j].y());
  const double ankle = at[joint_of(skeleton, "ankle_l")].y();
  return lowest -
         0.25 * (ankle -
                 lowest);  // toe joints lie about a fifth of the ankle's height over the ground
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
  const Vec3 toes =
      0.5 * (at[joint_of(skeleton, "toe_dip2" + s)] + at[joint_of(skeleton, "toe_dip3" + s)]);
  auto level = [&](const Vec3& p) { return Vec3(p.x(), sole_height, p.z()); };
  foot.ball = level(ball);
  const Vec3 ankle = level(at[foot.ankle]);
  // Behind the ankle the heel is 0.4 as long as the way to the ball; the toes end 0.15 of it before
  // their last joints.
  foot.heel = ankle - 0.40 * (foot.ball - ankle);
  foot.tip = level(toes) + 0.15 * (foot.ball - ankle);
  const Joint& toe = skeleton.joints[foot.mtp[1]];
  foot.toes_up = at[foot.mtp[1]] + joint_rotation(toe, Vec3(toe.min[0] + limit_ease(toe, 0),
                                                            toe.zero[1], toe.zero[2])) *
                                       (foot.tip - at[foot.mtp[1]]);
  return foot;
}

std::vector<int> feet_joints(const Skeleton& skeleton) {
  std::vector<int> ends;
  for (const Side side : {Side::left, Side::right})
    for (int k = 1; k <= 5; ++k)
      ends.push_back(joint_of(skeleton, "mtp" + std::to_string(k) + side_suffix(side)));
  return joints_up_from(skeleton, ends);
}

FootPoints foot_points(const Skeleton& skeleton, const FootShape& foot,
                       const std::vector<Transform>& X) {
  Vec3 subtalar = Vec3::Zero(), toe = Vec3::Zero();
  for (int j = foot.subtalar; j >= 0; j = skeleton.joints[j].parent)
    subtalar += skeleton.joints[j].X_PJ.translation();
  toe = subtalar + skeleton.joints[foot.mtp[1]].X_PJ.translation();
  return {X[foot.subtalar] * (foot.heel - subtalar), X[foot.subtalar] * (foot.ball - subtalar),
          X[foot.mtp[1]] * (foot.tip - toe)};
}

std::vector<double> floor_heights(const std::array<FootPaths, 2>& paths, const Motion& motion) {
  constexpr double kStep = 0.06, kStanding = 0.5, kStill = 0.5, kSteady = 0.10;  // m, m, m/s, s
  const int n = motion.frames.size();
  const std::array<const std::vector<Vec3>*, 4> tracks = {&paths[0].heel, &paths[0].ball,
                                                          &paths[1].heel, &paths[1].ball};
  auto lowest = [&](int f) {
    return *std::min_element(tracks.begin(), tracks.end(),
                             [&](auto* a, auto* b) { return (*a)[f].y() < (*b)[f].y(); });
  };
  // Low, but not the lowest of all, which may be a glitch.
  std::vector<double> low;
  for (int f = 0; f < n; ++f) low.push_back((*lowest(f))[f].y());
  std::vector<double> sorted = low;
  std::nth_element(sorted.begin(), sorted.begin() + n / 20, sorted.end());
  std::vector<double> floor(n, sorted[n / 20]);
  for (int begin = 1; begin < n; ++begin) {
    int end = begin;
    auto still = [&](int f) {
      const std::vector<Vec3>& point = *lowest(f);
      return (point[f] - point[f - 1]).norm() * motion.fps < kStill &&
             motion.frames[f].root.y() - low[f] > kStanding;
    };
    while (end < n && still(end)) ++end;
    if (end - begin >= kSteady * motion.fps && low[(begin + end) / 2] - floor[begin] > kStep)
      std::fill(floor.begin() + begin, floor.begin() + end, low[(begin + end) / 2]);
    begin = end;
  }
  return floor;
}

std::vector<Interval> standing_intervals(const std::vector<Vec3>& path,
                                         const std::vector<double>& floor, double fps,
                                         std::span<const Interval> beside) {
  const int n = int(path.size());
  const int fine = std::max(1, int(std::lround(kSampled / fps)));  // samples a frame
  const double rate = fine * fps;
  const std::vector<Vec3> curve = calmed(n > 1 ? sampled_curve(path, fine) : path, rate);
  const int samples = int(curve.size()), apart = std::max(1, int(std::lround(kSpeedSpan * rate)));
  // The slower of the ways before and after: the first and last sample on the ground count as
  // standing.
  auto speed = [&](int k) {
    const int from = std::max(0, k - apart), to = std::min(samples - 1, k + apart);
    const double before = from < k ? (curve[k] - curve[from]).norm() / (k - from) : HUGE_VAL,
                 after = k < to ? (curve[to] - curve[k]).norm() / (to - k) : HUGE_VAL;
    return samples > 1 ? std::min(before, after) * rate : 0.0;
  };
  std::vector<Interval> runs;  // of samples
  for (int k = 0; k < samples; ++k) {
    Interval run{k, k};
    bool sure = false;
    for (; run.end < samples; ++run.end) {
      const double height = curve[run.end].y() - floor[run.end / fine], v = speed(run.end);
      if (height > kHighHeight || v > kFast) break;
      sure |= height < kLowHeight && v < kSlow;
    }
    k = run.end;
    for (const Interval& other : beside)
      sure |= std::min(other.lift(), double(run.end - 1) / fine) -
                  std::max(other.onset(), double(run.begin) / fine) >=
              kShortestFootContacts * fps;
    if (!sure) continue;
    if (!runs.empty() && run.begin - runs.back().end < kGap * rate &&
        (curve[run.begin] - curve[runs.back().end - 1]).norm() < kSamePlace)
      runs.back().end = run.end;
    else
      runs.push_back(run);
  }
  std::vector<Interval> out;
  for (const Interval& run : in_places(curve, runs, rate)) {
    if (run.end - run.begin < kShortestFootContacts * rate) continue;
    const double onset = double(run.begin) / fine, lift = double(run.end - 1) / fine;
    Interval span{int(std::ceil(onset)), int(std::floor(lift)) + 1};
    span.early = span.begin - onset;
    span.late = lift - (span.end - 1);
    if (span.begin < span.end) out.push_back(span);
  }
  return out;
}

}  // namespace ecorche::inline v1
