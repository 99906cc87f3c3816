#include "skinning/retarget/matching_rig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Cholesky>

#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::array<double, 7> kUnits{1, 0.1, 0.01, 0.001, 0.0254, 0.3048, 0.9144};  // m
// Largest relative deviation of the fitted scale from a unit of length: rigs and bodies measure
// their limbs between different points.
constexpr double kScaleOff = 0.02;
// Largest distance of the rig's limb joints, and of its hips, from ours. Larger: rigs of other
// bodies match.
constexpr double kBeside = 0.03, kHipBeside = 0.06;  // m
constexpr double kStiff = 0.15;  // fraction of a chain's length; regularises bends along the chain
constexpr int kRounds = 3;       // Gauss-Newton steps of a chain's bend
// m; a rig with a smaller offset is in place, and the offset belongs to its joints
constexpr double kSamePlace = 0.025;

// A part of the body between two joints: its fraction of the skin, and the part whose rotation in
// the file it takes.
struct Part {
  const char* part;
  const char* from;
  const char* to;
  double share;
};
// Fractions of the surface of an adult (Lund & Browder 1944), the trunk's between its ends.
constexpr std::array<Part, 9> kParts{{{"pelvis", "l5", "hip", 0.09},
                                      {"thorax", "clavicle", "c7", 0.11},
                                      {"head", "head", "jaw", 0.08},
                                      {"shoulder", "shoulder", "elbow", 0.04},
                                      {"elbow", "elbow", "wrist", 0.03},
                                      {"wrist", "wrist", "mcp3", 0.025},
                                      {"hip", "hip", "knee", 0.095},
                                      {"knee", "knee", "ankle", 0.07},
                                      {"ankle", "ankle", "mtp3", 0.035}}};

// A name with its side, or without one for a joint of the trunk.
std::string sided(const Skeleton& skeleton, const std::string& stem, const char* side) {
  return find_joint(skeleton, stem) >= 0 ? stem : stem + side;
}

struct Fitting {
  double metres = 1;
  Vec3 shift = Vec3::Zero();  // ours - the file's, m
  bool fits = false;
};

// Fits scale and offset of the file's limb joints to ours, without rotation.
Fitting fit_without_rotation(const std::vector<Transform>& X, const JointMapping& mapping,
                             const Mat3& W, const Skeleton& ours, const std::vector<Vec3>& rest) {
  struct Pair {
    Vec3 theirs, own;
    double beside;
  };
  std::vector<Pair> pairs;
  for (const char* stem : {"hip", "knee", "ankle", "shoulder", "elbow", "wrist"})
    for (const char* side : {"_l", "_r"}) {
      const auto at = mapping.position_joint.find(std::string(stem) + side);
      if (at == mapping.position_joint.end()) return {};
      pairs.push_back({W * X[at->second].translation(),
                       rest[joint_of(ours, std::string(stem) + side)],
                       std::string(stem) == "hip" ? kHipBeside : kBeside});
    }
  Vec3 theirs = Vec3::Zero(), own = Vec3::Zero();
  for (const Pair& p : pairs)
    theirs += p.theirs / double(pairs.size()), own += p.own / double(pairs.size());
  double both = 0, square = 0;
  for (const Pair& p : pairs)
    both += (p.theirs - theirs).dot(p.own - own), square += (p.theirs - theirs).squaredNorm();
  const double scale = both / std::max(square, std::numeric_limits<double>::min());
  const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&](double metres) {
    return std::abs(scale / metres - 1) < kScaleOff;
  });
  if (unit == kUnits.end()) return {};
  Fitting out{*unit, own - *unit * theirs, true};
  for (const Pair& p : pairs)
    out.fits = out.fits && (*unit * p.theirs + out.shift - p.own).norm() < p.beside;
  if (out.shift.norm() < kSamePlace) out.shift.setZero();
  return out;
}

}  // namespace

std::optional<MatchingRig> find_matching_rig(const MotionClip& source, const JointMapping& mapping,
                                             const RestAlignment& alignment, const Skeleton& ours) {
  if (!alignment.same_rest) return std::nullopt;
  std::vector<Transform> X;
  clip_kinematics(source, -1, X);
  const std::vector<Vec3> rest = rest_positions(ours);
  const Fitting fitting = fit_without_rotation(X, mapping, alignment.W, ours, rest);
  if (!fitting.fits) return std::nullopt;
  MatchingRig out{fitting.metres, alignment.W, {}, {}, {}};
  // Precondition: the file rotates the part.
  const auto place = [&](const std::string& part, const std::string& name, double share) {
    const int joint = joint_of(ours, name), file_joint = mapping.rotation_joint.at(part);
    const Vec3 in_file = alignment.W.transpose() * (rest[joint] - fitting.shift) / fitting.metres;
    return MatchedPoint{joint, joint_of(ours, part), file_joint, X[file_joint].inverse() * in_file,
                        share};
  };
  for (const Part& part : kParts)
    for (const char* side : {"_l", "_r"}) {
      const std::string name = sided(ours, part.part, side);
      if (!mapping.rotation_joint.contains(name)) continue;
      for (const char* end : {part.from, part.to})
        out.points.push_back(place(name, sided(ours, end, side), 0.5 * part.share));
    }
  for (const auto& [below, first, above] :
       {std::array{"pelvis", "l5", "thorax"}, std::array{"thorax", "c7", "head"}}) {
    if (!mapping.rotation_joint.contains(below) || !mapping.rotation_joint.contains(above))
      continue;
    MatchedChain chain{{}, place(below, first, 0), place(above, above, 0)};
    for (int j = ours.joints[chain.end.joint].parent; j != chain.begin.part;
         j = ours.joints[j].parent)
      chain.joints.push_back(j);
    std::reverse(chain.joints.begin(), chain.joints.end());
    const bool told = std::any_of(chain.joints.begin(), chain.joints.end(), [&](int j) {
      return mapping.rotation_joint.contains(ours.joints[j].name);
    });
    if (!told) out.chains.push_back(chain);
  }
  for (const std::string side : {"_l", "_r"})
    if (mapping.outer_collars.contains("scapula" + side) &&
        mapping.rotation_joint.contains("thorax"))
      out.collars.push_back(
          {place("thorax", "clavicle" + side, 0), place("scapula" + side, "shoulder" + side, 0)});
  return out;
}

Vec3 file_position(const MatchingRig& rig, const std::vector<Transform>& X,
                   const MatchedPoint& point) {
  return rig.metres * (rig.W * (X[point.file_joint] * point.local));
}

void bend_to_rig(const MatchingRig& rig, const MatchedChain& chain, const std::vector<Transform>& X,
                 const std::vector<Vec3>& rest, std::vector<Mat3>& R) {
  const Vec3 wanted = file_position(rig, X, chain.end) - file_position(rig, X, chain.begin);
  const std::size_t count = chain.joints.size();
  for (int round = 0; round < kRounds; ++round) {
    // All rotate about one axis perpendicular to the chain, t = u x m for its direction u, the
    // middle most: c_k t moves the end by c_k t x v_k.
    std::vector<Vec3> steps(count);
    Vec3 chord = Vec3::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t joint = chain.joints[k],
                        next = k + 1 < count ? chain.joints[k + 1] : chain.end.joint;
      steps[k] = R[joint] * (rest[next] - rest[joint]);
      chord += steps[k];
    }
    const Vec3 u = chord.normalized(), off = wanted - chord;
    const auto weight = [&](std::size_t k) {
      const double s = (double(k) + 0.5) / double(count);
      return 4 * s * (1 - s);
    };
    Mat3 moves = Mat3::Zero();
    for (std::size_t k = 0; k < count; ++k)
      moves += weight(k) * (u.dot(steps[k]) * Mat3::Identity() - u * steps[k].transpose());
    const double stiff = kStiff * chord.norm();
    const Vec3 m = (moves.transpose() * moves + stiff * stiff * Mat3::Identity())
                       .ldlt()
                       .solve(moves.transpose() * off);
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 turn = weight(k) * u.cross(m);
      const double angle = turn.norm();
      Mat3& own = R[chain.joints[k]];
      if (angle > 0) own = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * own;
    }
  }
}

void reach_with_collar(const MatchingRig& rig, const MatchedCollar& collar,
                       const std::vector<Transform>& X, const std::vector<Vec3>& rest,
                       std::vector<Mat3>& R) {
  const int clavicle = collar.clavicle.joint, scapula = collar.shoulder.part;
  const Vec3 wanted = file_position(rig, X, collar.shoulder) -
                      file_position(rig, X, collar.clavicle) -
                      R[scapula] * (rest[collar.shoulder.joint] - rest[scapula]);
  const Vec3 now = R[clavicle] * (rest[scapula] - rest[clavicle]);
  R[clavicle] = Quat::FromTwoVectors(now, wanted).toRotationMatrix() * R[clavicle];
}

Vec3 shift_to_rig(const MatchingRig& rig, const std::vector<Transform>& X,
                  const std::vector<Vec3>& rest, const std::vector<Transform>& X_WJ) {
  Vec3 sum = Vec3::Zero();
  double shares = 0;
  for (const MatchedPoint& point : rig.points) {
    const std::size_t part = point.part;
    const Vec3 here = X_WJ[part] * (rest[point.joint] - rest[part]);
    sum += point.weight * (file_position(rig, X, point) - here);
    shares += point.weight;
  }
  return sum / shares;
}

}  // namespace ecorche::inline v1
