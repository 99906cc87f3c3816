#include "skinning/constraints/ground_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "anatomy/compute/sphere_directions.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kDirections = 160;    // some 9 deg from the nearest: 2 mm on a buttock
constexpr double kUpperArm = 0.3;   // of its length from the shoulder: goes with the trunk
constexpr double kShank = 0.9;      // of its length from the knee; heels go with the foot
constexpr double kKnee = 0.05;      // m; of the skin before a knee, which the patella carries
constexpr double kFingerTip = 0.8;  // of the bone before it: how far a finger goes on

enum class GroundPart { body, elbow, hand, finger, foot };

// A bone as a segment. Beyond `share` of its length another joint and part may follow.
struct BoneAxis {
  Vec3 from, to;
  int joint = -1;
  GroundPart part = GroundPart::body;
  double share = 1;
  int later_joint = -1;
  GroundPart later_part = GroundPart::body;
  std::size_t side = 0;
};

class GroundMeasurer {
 public:
  GroundMeasurer(const Skeleton& skeleton, const Points& skin)
      : skeleton_(skeleton), skin_(skin), rest_(rest_positions(skeleton)) {}

  GroundPoints run() {
    add_trunk();
    for (std::size_t side = 0; side < 2; ++side) {
      s_ = side_suffix(side == 0 ? Side::left : Side::right);
      side_ = side;
      add_leg();
      add_arm();
    }
    assign_vertices();
    GroundPoints out;
    for (const auto& [key, points] : parts_) {
      const auto& [part, side, joint] = key;
      GroundPatch patch = outermost(joint, points);
      (part == GroundPart::body    ? out.body
       : part == GroundPart::elbow ? out.elbows[side]
       : part == GroundPart::hand  ? out.hands[side]
       : part == GroundPart::foot  ? out.feet[side]
                                   : out.fingers[side])
          .push_back(std::move(patch));
    }
    return out;
  }

 private:
  std::size_t joint(const std::string& name) const {
    return std::size_t(joint_of(skeleton_, name));
  }
  Vec3 at(const std::string& name) const { return rest_[joint(name)]; }

  BoneAxis& add(const Vec3& from, const Vec3& to, const std::string& moves, GroundPart part) {
    BoneAxis axis;
    axis.from = from;
    axis.to = to;
    axis.joint = int(joint(moves));
    axis.part = part;
    axis.side = side_;
    return axes_.emplace_back(axis);
  }

  void add_trunk() {
    const Vec3 head = at("head");
    const Vec3 crown(head.x(), skin_.rows() > 0 ? skin_.col(1).maxCoeff() : head.y() + 0.2,
                     head.z());
    add(at("pelvis"), at("l4"), "pelvis", GroundPart::body);
    add(at("l4"), at("t12"), "l3", GroundPart::body);
    add(at("t12"), at("c7"), "thorax", GroundPart::body);
    add(at("c7"), head, "c4", GroundPart::body);
    add(head, crown, "head", GroundPart::body);
  }

  void add_leg() {
    add(at("hip" + s_), at("knee" + s_), "hip" + s_, GroundPart::body);
    BoneAxis& shank = add(at("knee" + s_), at("ankle" + s_), "knee" + s_, GroundPart::body);
    shank.share = kShank;
    shank.later_joint = int(joint("subtalar" + s_));
    shank.later_part = GroundPart::foot;
    add(at("ankle" + s_), at("mtp3" + s_), "subtalar" + s_, GroundPart::foot);
    add(at("mtp3" + s_), at("toe_dip3" + s_), "mtp3" + s_, GroundPart::foot);
    add(at("mtp1" + s_), at("toe_ip1" + s_), "mtp1" + s_, GroundPart::foot);
  }

  void add_arm() {
    add(at("thorax"), at("shoulder" + s_), "scapula" + s_, GroundPart::body);
    BoneAxis& upper = add(at("shoulder" + s_), at("elbow" + s_), "shoulder" + s_, GroundPart::body);
    upper.share = kUpperArm;
    upper.later_joint = upper.joint;
    upper.later_part = GroundPart::elbow;
    BoneAxis& lower = add(at("elbow" + s_), at("wrist" + s_), "elbow" + s_, GroundPart::elbow);
    lower.share = 0.5;
    lower.later_joint = int(joint("forearm" + s_));
    lower.later_part = GroundPart::hand;
    for (int k = 1; k <= 5; ++k) {
      const std::string n = std::to_string(k) + s_;
      const bool thumb = k == 1;
      const std::string middle = (thumb ? "mcp" : "pip") + n, last = (thumb ? "ip" : "dip") + n,
                        root = (thumb ? "cmc" : "mcp") + n;
      add(at("wrist" + s_), at(root), "wrist" + s_, GroundPart::hand);
      const GroundPart part = GroundPart::finger;
      add(at(root), at(middle), root, part);
      add(at(middle), at(last), middle, part);
      add(at(last), at(last) + kFingerTip * (at(last) - at(middle)), last, part);
    }
  }

  // Skin before a knee goes with the patella.
  struct Knee {
    Vec3 centre;
    int thigh, shank, patella;
  };

  void assign_vertices() {
    std::vector<Knee> knees;
    for (const std::string s : {"_l", "_r"})
      knees.push_back({at("knee" + s), int(joint("hip" + s)), int(joint("knee" + s)),
                       int(joint("patella" + s))});
    for (Eigen::Index i = 0; i < skin_.rows(); ++i) {
      const Vec3 p = skin_.row(i);
      double least = std::numeric_limits<double>::infinity(), along = 0;
      const BoneAxis* nearest = nullptr;
      for (const BoneAxis& axis : axes_) {
        const Vec3 way = axis.to - axis.from;
        const double t = std::clamp((p - axis.from).dot(way) / way.squaredNorm(), 0.0, 1.0),
                     d = (p - axis.from - t * way).squaredNorm();
        if (d < least) least = d, along = t, nearest = &axis;
      }
      const bool later = along > nearest->share;
      const GroundPart part = later ? nearest->later_part : nearest->part;
      int moves = later ? nearest->later_joint : nearest->joint;
      for (const Knee& knee : knees)
        if ((moves == knee.thigh || moves == knee.shank) &&
            std::abs(p.y() - knee.centre.y()) < kKnee && p.z() > knee.centre.z())
          moves = knee.patella;
      parts_[{part, nearest->side, moves}].push_back(p);
    }
  }

  GroundPatch outermost(int moves, const std::vector<Vec3>& points) const {
    static const std::vector<Vec3> directions = sphere_directions(kDirections);
    std::set<std::size_t> chosen;
    for (const Vec3& u : directions)
      chosen.insert(std::size_t(
          std::ranges::max_element(points, {}, [&](const Vec3& p) { return u.dot(p); }) -
          points.begin()));
    GroundPatch out;
    out.joint = moves;
    for (const std::size_t k : chosen) {
      out.points.emplace_back(points[k] - rest_[std::size_t(moves)]);
      out.reach = std::max(out.reach, out.points.back().norm());
    }
    return out;
  }

  const Skeleton& skeleton_;
  const Points& skin_;
  const std::vector<Vec3> rest_;
  std::string s_;
  std::size_t side_ = 0;
  std::vector<BoneAxis> axes_;
  std::map<std::tuple<GroundPart, std::size_t, int>, std::vector<Vec3>> parts_;
};

}  // namespace

GroundPoints measure_ground_points(const Skeleton& skeleton, const Points& skin) {
  return GroundMeasurer(skeleton, skin).run();
}

}  // namespace ecorche::inline v1
