#include "skinning/bind/weight_rules.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/joints_below.h"
#include "anatomy/queries/mouth_line.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kLeastRange = 0.6;   // rad, joints that move less are blended linearly
constexpr double kLeastPair = 0.01;   // 2 w_a w_b below it is not worth a frame
constexpr double kGirdleShare = 0.4;  // of a pair's weight about a joint of the girdle
constexpr double kHingeSlack = 0.2;   // rad, of abduction
// Fractions of the upper arm between which its skin comes to slide, and the arm's own weight
// between which it does: the web before and behind the armpit stays with the trunk. Were it to
// slide, it would be folded over the front of a raised arm.
constexpr double kSlideFrom = -0.3, kSlideTo = 0.3;
constexpr double kLeastArm = 0.3, kMostLeastArm = 0.8;
// Fractions of the thigh between which the trunk lets go of its skin, how much of it, and what the
// leg must hold of a vertex that is its own.
constexpr double kReleaseFrom = 0.25, kReleaseTo = 0.6, kReleased = 0.8;
constexpr double kLeastLeg = 0.2;
// Of the thigh's skin in front, next to the knee: what the shin draws along; and the fraction of it
// behind.
constexpr double kDrawnByShin = 0.6, kDrawnBehind = 0.2;
constexpr double kReachQuantile = 0.5, kReachSlack = 1.35;

double* find_weight(WeightRow& row, int joint) {
  for (Influence& w : row)
    if (w.joint == joint) return &w.weight;
  return nullptr;
}

void move_weight(WeightRow& row, int from, int to, double fraction) {
  double* source = find_weight(row, from);
  if (source == nullptr || fraction <= 0) return;
  const double moved = *source * fraction;
  *source -= moved;
  if (double* target = find_weight(row, to))
    *target += moved;
  else
    row.push_back({to, moved});
}

// Position along the segment from joint a to joint b, 0 at a and 1 at b.
double along(const Vec3& p, const Vec3& a, const Vec3& b) {
  return (p - a).dot(b - a) / (b - a).squaredNorm();
}

double range_of_motion(const Joint& joint) { return (joint.max - joint.min).maxCoeff(); }

// Joints that turn between a and b: up from both to their common ancestor, which itself is not
// among them.
std::vector<int> joints_between(const Skeleton& skeleton, int a, int b) {
  std::vector<int> up_a, up_b;
  for (int j = a; j >= 0; j = skeleton.joints[j].parent) up_a.push_back(j);
  for (int j = b; j >= 0; j = skeleton.joints[j].parent) up_b.push_back(j);
  while (!up_a.empty() && !up_b.empty() && up_a.back() == up_b.back())
    up_a.pop_back(), up_b.pop_back();
  up_a.insert(up_a.end(), up_b.begin(), up_b.end());
  return up_a;
}

// The joint with the widest range between two frames is where they hinge. False: they hardly turn
// against each other.
bool find_center(const Skeleton& skeleton, const std::vector<Vec3>& origins, int a, int b,
                 Vec3& center, int& hinge) {
  double widest = 0;
  for (int j : joints_between(skeleton, a, b))
    widest = std::max(widest, range_of_motion(skeleton.joints[j]));
  if (widest < kLeastRange) return false;
  int count = 0;
  center.setZero();
  for (int j : joints_between(skeleton, a, b))
    if (range_of_motion(skeleton.joints[j]) > 0.95 * widest) {
      center += origins[j];
      hinge = j;
      ++count;
    }
  center /= count;
  return true;
}

// Whether it bends about one axis alone.
bool is_hinge(const Joint& joint) { return (joint.max - joint.min).y() < kHingeSlack; }

// Whether it moves the upper arm or what carries it.
bool is_of_girdle(const Joint& joint) {
  return joint.name.starts_with("shoulder") || joint.name.starts_with("scapula") ||
         joint.name.starts_with("clavicle");
}

// Pairs about the girdle count less, at any distance. The reach of another pair is the distance
// from its hinge at which most of the flesh about it lies; beyond it weights fade with its square.
void weigh_pairs(const Skeleton& skeleton, const TriMesh& skin, const std::vector<FramePair>& pairs,
                 std::vector<WeightRow>& found) {
  const auto distance = [&](std::size_t i, int pair) {
    return (Vec3(skin.V.row(i)) - pairs[pair].center).norm();
  };
  std::vector<std::vector<double>> around(pairs.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const Influence& w : found[i])
      if (w.weight > 0.2) around[w.joint].push_back(distance(i, w.joint));
  std::vector<double> reach(pairs.size(), std::numeric_limits<double>::infinity()),
      share(pairs.size(), 1.0);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const int hinge = pairs[k].hinge;
    if (hinge >= 0 && is_of_girdle(skeleton.joints[hinge])) {
      share[k] = kGirdleShare;
      continue;
    }
    if (around[k].empty() || (hinge >= 0 && is_hinge(skeleton.joints[hinge]))) continue;
    const auto rank =
        around[k].begin() + std::ptrdiff_t(kReachQuantile * double(around[k].size() - 1));
    std::nth_element(around[k].begin(), rank, around[k].end());
    reach[k] = kReachSlack * *rank;
  }
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Influence& w : found[i]) {
      const double ratio = reach[w.joint] / std::max(distance(i, w.joint), 1e-6);
      w.weight *= share[w.joint] * std::min(1.0, ratio * ratio);
    }
}

}  // namespace

void spread_twist(const Skeleton& skeleton, const TriMesh& skin, std::span<const int> painted,
                  std::vector<WeightRow>& rows, std::vector<TwistFrame>& twists) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const auto origin = [&](int j) { return origins[j]; };
  std::vector<char> kept(rows.size(), 0);
  for (const int v : painted) kept[v] = 1;
  for (const std::string side : {"_l", "_r"}) {
    for (const auto& [upper, lower] : {std::pair{"shoulder", "elbow"}, std::pair{"hip", "knee"}}) {
      const int j = find_joint(skeleton, upper + side), end = find_joint(skeleton, lower + side);
      if (j < 0 || end < 0 || skeleton.joints[j].parent < 0) continue;
      const int frame = skeleton.joints.size() + twists.size();
      twists.push_back({j, skeleton.joints[j].parent, (origin(end) - origin(j)).normalized()});
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double t = along(skin.V.row(i), origin(j), origin(end));
        move_weight(rows[i], j, frame, 1 - std::clamp(t, 0.0, 1.0));
      }
    }
    const int elbow = find_joint(skeleton, "elbow" + side),
              forearm = find_joint(skeleton, "forearm" + side);
    const int wrist = find_joint(skeleton, "wrist" + side);
    if (elbow < 0 || forearm < 0 || wrist < 0) continue;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double t = along(skin.V.row(i), origin(elbow), origin(wrist));
      if (kept[i]) continue;
      move_weight(rows[i], elbow, forearm, 1);
      move_weight(rows[i], forearm, elbow, 1 - std::clamp((t - 0.1) / 0.85, 0.0, 1.0));
    }
  }
  for (WeightRow& row : rows)
    std::erase_if(row, [](const Influence& w) { return w.weight <= 1e-6; });
}

void part_lips(const Anatomy& anatomy, const TriMesh& skin, SkinDepth& depth) {
  const std::optional<MouthLine> mouth = find_mouth(anatomy, skin);
  if (!mouth) return;
  constexpr double kLip = 0.02;  // m above the mouth
  const int jaw = find_joint(anatomy.skeleton, "jaw"), skull = anatomy.skeleton.joints[jaw].parent;
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) {
    const Vec3 p = skin.V.row(v);
    int& joint = depth.joint[v];
    if ((joint >= 0 && joint != skull && joint != jaw) || !mouth->about(p)) continue;
    const double over = mouth->over(p);
    if (over < 0)
      joint = jaw;
    else if (over < kLip && (joint < 0 || mouth->spans(p.x())))
      joint = skull;
  }
}

void let_scapula_glide(const Skeleton& skeleton, const TriMesh& skin,
                       std::vector<WeightRow>& rows) {
  const int thorax = find_joint(skeleton, "thorax");
  const std::vector<Vec3> origins = rest_positions(skeleton);
  for (const std::string side : {"_l", "_r"}) {
    const int scapula = find_joint(skeleton, "scapula" + side),
              shoulder = find_joint(skeleton, "shoulder" + side);
    const int elbow = find_joint(skeleton, "elbow" + side);
    if (thorax < 0 || scapula < 0 || shoulder < 0 || elbow < 0) continue;
    const Vec3 center = origins[shoulder];
    const double arm = (origins[elbow] - center).norm();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double away = (Vec3(skin.V.row(i)) - center).norm() / arm;
      move_weight(rows[i], scapula, thorax, 0.6 * smooth_step(0.1, 0.35, away));
    }
  }
}

void release_thigh(const Skeleton& skeleton, const TriMesh& skin, std::vector<WeightRow>& rows) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::vector<char> of_leg(skeleton.joints.size(), 0);
  for (const char* hip : {"hip_l", "hip_r"})
    if (const int j = find_joint(skeleton, hip); j >= 0) {
      const std::vector<char> below = joints_below(skeleton, j);
      std::transform(below.begin(), below.end(), of_leg.begin(), of_leg.begin(), std::bit_or<>());
    }
  for (const std::string side : {"_l", "_r"}) {
    const int hip = find_joint(skeleton, "hip" + side), knee = find_joint(skeleton, "knee" + side);
    if (hip < 0 || knee < 0) continue;
    const Vec3 from = origins[hip], to = origins[knee];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double* own = find_weight(rows[i], hip);
      if (own == nullptr) continue;
      const double share = kReleased * smooth_step(0, kLeastLeg, *own) *
                           smooth_step(kReleaseFrom, kReleaseTo, along(skin.V.row(i), from, to));
      if (share <= 0) continue;
      const WeightRow before = rows[i];
      for (const Influence& w : before)
        if (!of_leg[std::size_t(w.joint)]) move_weight(rows[i], w.joint, hip, share);
    }
  }
}

void let_arm_skin_slide(const Skeleton& skeleton, const TriMesh& skin, FrameTables& tables,
                        std::vector<WeightRow>& rows) {
  for (const std::string side : {"_l", "_r"}) {
    const int shoulder = find_joint(skeleton, "shoulder" + side),
              elbow = find_joint(skeleton, "elbow" + side);
    if (shoulder < 0 || elbow < 0) continue;
    const Vec3 from = tables.origins[std::size_t(shoulder)],
               to = tables.origins[std::size_t(elbow)];
    const std::vector<char> below = joints_below(skeleton, shoulder);
    const auto is_of_arm = [&](int frame) {
      return below[std::size_t(tables.joint_of(frame))] != 0;
    };
    std::map<int, int> slide_of;  // carrier -> frame
    for (std::size_t i = 0; i < rows.size(); ++i) {
      double arm = 0;
      for (const Influence& w : rows[i])
        if (is_of_arm(w.joint)) arm += w.weight;
      const double share = smooth_step(kSlideFrom, kSlideTo, along(skin.V.row(i), from, to)) *
                           smooth_step(kLeastArm, kMostLeastArm, arm);
      if (share <= 0) continue;
      const WeightRow before = rows[i];
      for (const Influence& w : before) {
        if (w.joint >= tables.joint_count() || is_of_arm(w.joint)) continue;
        const auto [it, added] = slide_of.emplace(w.joint, tables.first_pair());
        if (added) tables.slides.push_back({shoulder, w.joint, (to - from).normalized()});
        move_weight(rows[i], w.joint, it->second, share);
      }
    }
  }
}

void let_thigh_skin_slide(const Skeleton& skeleton, const TriMesh& skin, FrameTables& tables,
                          std::vector<WeightRow>& rows) {
  for (const std::string side : {"_l", "_r"}) {
    const int hip = find_joint(skeleton, "hip" + side), knee = find_joint(skeleton, "knee" + side);
    if (hip < 0 || knee < 0) continue;
    const Vec3 from = tables.origins[std::size_t(hip)], to = tables.origins[std::size_t(knee)];
    const Vec3 bone = (to - from).normalized(),
               back = skeleton.joints[std::size_t(knee)].axes.col(0).cross(bone).normalized();
    const int slide = tables.first_pair();
    tables.slides.push_back({hip, knee, bone});
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Vec3 p = skin.V.row(i), off = (p - from) - (p - from).dot(bone) * bone;
      const double t = std::clamp(along(p, from, to), 0.0, 1.0),
                   behind = 0.5 + 0.5 * back.dot(off) / std::max(off.norm(), 1e-6);
      const double share = kDrawnByShin * t * t * (1 - (1 - kDrawnBehind) * behind);
      const WeightRow before = rows[i];
      for (const Influence& w : before)
        if (w.joint < tables.first_slide() && tables.joint_of(w.joint) == hip)
          move_weight(rows[i], w.joint, slide, share);
    }
  }
}

std::vector<FramePair> add_frame_pairs(const Skeleton& skeleton, const TriMesh& skin,
                                       const FrameTables& tables, std::vector<WeightRow>& rows) {
  const std::vector<Vec3>& origins = tables.origins;
  std::map<std::pair<int, int>, int> index;  // -1: blended linearly
  std::vector<FramePair> pairs;
  std::vector<WeightRow> found(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    WeightRow& row = rows[i];
    std::sort(row.begin(), row.end(),
              [](const Influence& a, const Influence& b) { return a.joint < b.joint; });
    const std::size_t rigid =  // frames that are no slides, which come last
        std::size_t(std::count_if(row.begin(), row.end(), [&](const Influence& w) {
          return w.joint < tables.first_slide();
        }));
    for (std::size_t x = 0; x < rigid; ++x)
      for (std::size_t y = x + 1; y < rigid; ++y) {
        const double product = 2 * row[x].weight * row[y].weight;
        if (product < kLeastPair) continue;
        const std::pair<int, int> key{row[x].joint, row[y].joint};
        auto it = index.find(key);
        if (it == index.end()) {
          FramePair pair{key.first, key.second, Vec3::Zero()};
          const int a = tables.joint_of(key.first), b = tables.joint_of(key.second);
          if (a == b) pair.center = origins[a];
          const bool hinged =
              a == b || find_center(skeleton, origins, a, b, pair.center, pair.hinge);
          it = index.emplace(key, hinged ? int(pairs.size()) : -1).first;
          if (hinged) pairs.push_back(pair);
        }
        if (it->second >= 0) found[i].push_back({it->second, product});
      }
  }
  weigh_pairs(skeleton, skin, pairs, found);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::stable_sort(found[i].begin(), found[i].end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    if (int(found[i].size()) > kMostPairs) found[i].resize(kMostPairs);
    for (const Influence& w : found[i])
      rows[i].push_back({tables.first_pair() + w.joint, w.weight});
  }
  return pairs;
}

}  // namespace ecorche::inline v1
