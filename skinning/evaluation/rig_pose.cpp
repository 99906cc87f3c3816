#include "skinning/evaluation/rig_pose.h"
#include "anatomy/base_mesh/body_rig.h"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {
namespace {

struct Rule {
  const char* bone;  // without the side
  const char* joint;
  const char* other;  // "" or the second joint
  double share;
  bool half_twist;
};

constexpr Rule kRules[] = {
    {"root", "pelvis", "", 0, false},
    {"pelvis", "pelvis", "", 0, false},
    {"spine05", "l5", "", 0, false},
    {"spine04", "l3", "", 0, false},
    {"spine03", "t12", "", 0, false},
    {"spine02", "thorax", "", 0, false},
    {"spine01", "thorax", "", 0, false},
    {"neck01", "c6", "", 0, false},
    {"neck02", "c4", "", 0, false},
    {"neck03", "c2", "", 0, false},
    {"head", "head", "", 0, false},
    {"jaw", "jaw", "", 0, false},
    {"clavicle", "clavicle", "", 0, false},
    {"shoulder01", "scapula", "", 0, false},
    {"upperarm01", "shoulder", "", 0, true},
    {"upperarm02", "shoulder", "", 0, false},
    {"lowerarm01", "elbow", "forearm", 0.33, false},
    {"lowerarm02", "elbow", "forearm", 0.8, false},
    {"wrist", "wrist", "", 0, false},
    {"upperleg01", "hip", "", 0, true},
    {"upperleg02", "hip", "", 0, false},
    {"lowerleg01", "knee", "", 0, false},
    {"lowerleg02", "knee", "", 0, false},
    {"foot", "subtalar", "", 0, false},
    {"finger1-1", "cmc1", "", 0, false},
    {"finger1-2", "mcp1", "", 0, false},
    {"finger1-3", "ip1", "", 0, false},
    {"toe1-1", "mtp1", "", 0, false},
    {"toe1-2", "toe_ip1", "", 0, false},
};

// "finger3-2" -> pip3, "toe4-3" -> toe_dip4; "" for other names.
std::string digit_joint(std::string_view bone) {
  const bool finger = bone.starts_with("finger"), toe = bone.starts_with("toe");
  if (!finger && !toe) return "";
  const std::string_view rest = bone.substr(finger ? 6 : 3);
  if (rest.size() != 3 || rest[0] < '2' || rest[0] > '5' || rest[2] < '1' || rest[2] > '3')
    return "";
  const char* joints[2][3] = {{"mcp", "pip", "dip"}, {"mtp", "toe_pip", "toe_dip"}};
  return joints[toe ? 1 : 0][rest[2] - '1'] + std::string(1, rest[0]);
}

int joint_with_side(const Skeleton& skeleton, const std::string& name, const std::string& side) {
  const int j = find_joint(skeleton, name + side);
  return j >= 0 ? j : find_joint(skeleton, name);
}

Mat3 link_rotation(const RigLink& link, const Skeleton& skeleton, std::span<const Transform> X_WJ) {
  const Mat3 R = X_WJ[link.joint].linear();
  if (link.other >= 0)
    return Quat(R).slerp(link.share, Quat(X_WJ[link.other].linear())).toRotationMatrix();
  if (link.twist_of < 0) return R;
  const int parent = skeleton.joints[link.joint].parent;
  const Mat3 P = X_WJ[parent].linear();
  const Quat local(Mat3(P.transpose() * R));
  const double angle = 2 * std::atan2(local.vec().dot(link.axis), local.w());
  const double wrapped = std::remainder(angle, 2 * 3.14159265358979323846);
  return P * (local * Quat(Eigen::AngleAxisd(-0.5 * wrapped, link.axis))).toRotationMatrix();
}

}  // namespace

std::vector<RigLink> link_default_rig(const Rig& rig, const Skeleton& skeleton) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::vector<RigLink> links(rig.names.size());
  for (std::size_t b = 0; b < links.size(); ++b) {
    const std::string& name = rig.names[b];
    const bool paired = name.ends_with(".L") || name.ends_with(".R");
    const std::string bone = paired ? name.substr(0, name.size() - 2) : name;
    const std::string side = !paired ? "" : name.back() == 'L' ? "_l" : "_r";
    RigLink& link = links[b];
    for (const Rule& rule : kRules)
      if (bone == rule.bone) {
        link.joint = joint_with_side(skeleton, rule.joint, side);
        if (*rule.other != '\0') link.other = joint_with_side(skeleton, rule.other, side);
        link.share = rule.share;
        const int next = joint_with_side(skeleton, bone == "upperarm01" ? "elbow" : "knee", side);
        if (rule.half_twist && link.joint > 0 && next >= 0) {
          link.twist_of = link.joint;
          link.axis = (origins[next] - origins[link.joint]).normalized();
        }
      }
    if (const std::string digit = digit_joint(bone); !digit.empty())
      link.joint = joint_with_side(skeleton, digit, side);
    if (link.joint < 0 && rig.parents[b] >= 0) link = links[rig.parents[b]];
    if (link.joint < 0) link.joint = 0;
  }
  return links;
}

void pose_rig(const Rig& rig, std::span<const RigLink> links, const Skeleton& skeleton,
              std::span<const Transform> X_WJ, std::vector<Transform>& out) {
  if (links.size() != rig.names.size() || X_WJ.size() != skeleton.joints.size())
    throw std::invalid_argument("pose_rig: links or joint frames are of another rig or skeleton");
  const Vec3 root = skeleton.joints[0].X_PJ.translation();
  out.resize(rig.names.size());
  for (std::size_t b = 0; b < out.size(); ++b) {
    const Mat3 R = link_rotation(links[b], skeleton, X_WJ);
    const Vec3 head = rig.parents[b] >= 0 ? Vec3(out[rig.parents[b]] * rig.heads[b])
                                          : Vec3(X_WJ[0] * (rig.heads[b] - root));
    out[b].linear() = R;
    out[b].translation() = head - R * rig.heads[b];
  }
}

}  // namespace ecorche::inline v1
