#include "app/edit/document/edited_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/mirror_mesh.h"
#include "anatomy/joints_below.h"
#include "morph/placement/bone_groups.h"
#include "morph/placement/own_parts.h"

namespace ecorche {
namespace {

// Of joints of one's own until limits are set, deg: flexion, abduction, rotation.
const Vec3 kOwnRange(45, 45, 30);

bool in_names(const std::set<std::string>& names, const std::string& sided) {
  return names.contains(sided) || names.contains(split_side(sided).first);
}

// With the sides that a skeleton's joint of this name has.
std::vector<std::string> suffixes_of(const Skeleton& skeleton, const std::string& joint) {
  if (find_joint(skeleton, joint) >= 0) return {""};
  std::vector<std::string> out;
  for (const char* side : {"_l", "_r"})
    if (find_joint(skeleton, joint + side) >= 0) out.emplace_back(side);
  return out;
}

// A joint by its name, or the one of this side.
int joint_on_side(const Skeleton& skeleton, const std::string& name, const std::string& side) {
  const int whole = find_joint(skeleton, name);
  return whole >= 0 ? whole : find_joint(skeleton, name + side);
}

// Flexion from side to side as far as the long axis lets it, rotation about the long axis.
Mat3 own_axes(const Vec3& along) {
  const Vec3 rotation = along.norm() > 1e-9 ? Vec3(along.normalized()) : Vec3(-Vec3::UnitY());
  Vec3 flexion = Vec3::UnitX() - rotation.x() * rotation;
  if (flexion.norm() < 0.3) flexion = Vec3::UnitZ() - rotation.z() * rotation;
  Mat3 out;
  out.col(0) = flexion.normalized();
  out.col(2) = rotation;
  out.col(1) = out.col(2).cross(out.col(0));
  return out;
}

void add_joint(const Document& document, const OwnJoint& own, Skeleton& skeleton) {
  const std::vector<std::string> sides =
      own.paired ? std::vector<std::string>{"_l", "_r"} : std::vector<std::string>{""};
  for (const std::string& side : sides) {
    Joint joint;
    joint.name = own.name + side;
    const auto of = split_side(joint.name).second;
    joint.parent = joint_on_side(skeleton, own.parent, of == Side::right ? "_r" : "_l");
    if (joint.parent < 0)
      throw InputError(
          fmt::format("joint '{}': its parent '{}' is not there", joint.name, own.parent));
    const Vec3 above = rest_positions(skeleton)[std::size_t(joint.parent)];
    Vec3 centre = position(*document.frame, own.at);
    Vec3 tip = own.to ? position(*document.frame, *own.to) : centre;
    if (of == Side::right) centre = mirror_point(centre), tip = mirror_point(tip);
    joint.axes = own_axes(own.to ? Vec3(tip - centre) : Vec3(centre - above));
    // angles mean the same on either side, as those of the built-in joints
    if (of == Side::right) {
      Vec3 mirrored = joint.axes.col(2);
      mirrored.x() = -mirrored.x();
      joint.axes = own_axes(mirrored);
      joint.axes.bottomRows(2) = (-joint.axes.bottomRows(2)).eval();
    }
    joint.max = kDegree * kOwnRange;
    joint.min = -joint.max;
    joint.X_PJ.translation() = centre - above;
    skeleton.joints.push_back(std::move(joint));
  }
}

void add_bone(Workshop& workshop, const Document& document, const OwnBone& own, Anatomy& out) {
  const auto [base, one] = split_side(own.name);
  const std::string joint_base = own.joint;
  for (const std::string& side : suffixes_of(out.skeleton, joint_base)) {
    Bone bone;
    bone.name = own.name + (one == Side::middle ? side : "");
    bone.joint = find_joint(out.skeleton, joint_base + side);
    bone.side = split_side(out.skeleton.joints[std::size_t(bone.joint)].name).second;
    if (one != Side::middle && bone.side != Side::middle && bone.side != one) continue;
    bone.mesh = placed_bone(workshop, document, own);
    if (bone.side == Side::right) bone.mesh = mirror_mesh(bone.mesh, kSourceMidPlane);
    out.bones.push_back(std::move(bone));
  }
}

// Centre of a joint in the source frame, left side or middle.
Vec3 left_centre(Workshop& workshop, const Document& document, const std::string& name) {
  for (const OwnJoint& own : document.skeleton->joints)
    if (own.name == name || own.name == split_side(name).first)
      return position(*document.frame, own.at);
  const Skeleton& skeleton = workshop.source().skeleton;
  const int joint = joint_on_side(skeleton, split_side(name).first, "_l");
  if (joint < 0) throw InputError(fmt::format("there is no joint '{}'", name));
  return rest_positions(skeleton)[std::size_t(joint)];
}

void edit_joint(const EditedJoint& edit, const std::string& name, Skeleton& skeleton) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<Vec3> moved = rest;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    Joint& joint = skeleton.joints[j];
    const auto [base, side] = split_side(joint.name);
    if (joint.name != name && base != name) continue;
    const double outwards = side == Side::right ? -1 : 1;
    moved[j] += 1e-3 * Vec3(outwards * edit.moved.x(), edit.moved.y(), edit.moved.z());
    for (int axis = 0; axis < 3; ++axis) {
      // axes of both sides are right-handed frames that mean the same to either side
      joint.axes =
          Eigen::AngleAxisd(edit.turned[axis] * kDegree, joint.axes.col(axis)) * joint.axes;
      if (!edit.limits[axis]) continue;
      joint.min[axis] = edit.limits[axis]->first * kDegree;
      joint.max[axis] = edit.limits[axis]->second * kDegree;
    }
  }
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    Joint& joint = skeleton.joints[j];
    joint.X_PJ.translation() =
        joint.parent >= 0 ? Vec3(moved[j] - moved[std::size_t(joint.parent)]) : moved[j];
  }
}

// Built-in joints that are removed, with all that hangs on them: by index.
std::vector<char> removed_joints(Workshop& workshop, const Document& document) {
  const Skeleton& skeleton = workshop.source().skeleton;
  std::vector<char> out(skeleton.joints.size(), 0);
  for (std::size_t j = 0; j < out.size(); ++j) {
    if (!in_names(document.skeleton->removed, skeleton.joints[j].name)) continue;
    const std::vector<char> below = joints_below(skeleton, int(j));
    for (std::size_t k = 0; k < out.size(); ++k) out[k] |= below[k];
  }
  return out;
}

}  // namespace

bool has_own_parts(const Document& document) {
  const EditedSkeleton& own = *document.skeleton;
  return !own.joints.empty() || !own.bones.empty() || !own.removed.empty();
}

std::vector<std::string> sided_names(const Skeleton& skeleton, const std::string& name) {
  std::vector<std::string> out;
  for (const std::string& side : suffixes_of(skeleton, name)) out.push_back(name + side);
  return out;
}

std::vector<std::string> joint_names(Workshop& workshop, const Document& document) {
  const Skeleton& skeleton = workshop.source().skeleton;
  const std::vector<char> removed = removed_joints(workshop, document);
  std::vector<std::string> out;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const std::string name = split_side(skeleton.joints[j].name).first;
    if (!removed[j] && std::ranges::find(out, name) == out.end()) out.push_back(name);
  }
  for (const OwnJoint& own : document.skeleton->joints) out.push_back(own.name);
  return out;
}

bool is_paired(Workshop& workshop, const Document& document, const std::string& joint) {
  for (const OwnJoint& own : document.skeleton->joints)
    if (own.name == joint) return own.paired;
  return find_joint(workshop.source().skeleton, joint + "_l") >= 0;
}

bool has_joint(Workshop& workshop, const Document& document, const std::string& name) {
  const std::vector<std::string> names = joint_names(workshop, document);
  const auto has = [&](const std::string& each) {
    return std::ranges::find(names, each) != names.end();
  };
  const auto [base, side] = split_side(name);
  return has(name) || (side != Side::middle && has(base) && is_paired(workshop, document, base));
}

void check_joint(Workshop& workshop, const Document& document, const std::string& name,
                 const char* key) {
  if (has_joint(workshop, document, name)) return;
  throw InputError(fmt::format(
      "argument '{}': '{}': there is no such joint{}; `ecorche list joints` names the built-in "
      "ones",
      key, name, did_you_mean(split_side(name).first, joint_names(workshop, document))));
}

Skeleton edited_joints(Workshop& workshop, const Document& document) {
  Skeleton out = workshop.source().skeleton;
  for (const OwnJoint& own : document.skeleton->joints) add_joint(document, own, out);
  return out;
}

Anatomy edited_source(Workshop& workshop, const Document& document) {
  Anatomy out = workshop.source();
  out.skeleton = edited_joints(workshop, document);
  for (const OwnBone& own : document.skeleton->bones) add_bone(workshop, document, own, out);
  const std::vector<char> removed = removed_joints(workshop, document);
  std::erase_if(out.bones, [&](const Bone& bone) {
    return std::size_t(bone.joint) < removed.size() && removed[std::size_t(bone.joint)];
  });
  return out;
}

TriMesh placed_bone(Workshop& workshop, const Document& document, const OwnBone& bone) {
  TriMesh out = *bone.mesh;
  const Vec3 origin = left_centre(workshop, document, bone.joint) + 1e-3 * bone.at;
  const Mat3 turn = (Eigen::AngleAxisd(bone.turn.z() * kDegree, Vec3::UnitZ()) *
                     Eigen::AngleAxisd(bone.turn.y() * kDegree, Vec3::UnitY()) *
                     Eigen::AngleAxisd(bone.turn.x() * kDegree, Vec3::UnitX()))
                        .toRotationMatrix();
  out.V = ((bone.scale * out.V * turn.transpose()).rowwise() + origin.transpose()).eval();
  return out;
}

void edit_skeleton(Workshop& workshop, const Document& document, Template& out) {
  const Skeleton& built_in = workshop.source().skeleton;
  const auto edit_all = [&](bool of_own) {
    for (const auto& [name, edit] : *document.joints)
      if (sided_names(built_in, name).empty() == of_own)
        edit_joint(edit, name, out.anatomy.skeleton);
  };
  edit_all(false);
  if (!has_own_parts(document)) return;
  out.tables.built_in = Anatomy{out.anatomy.skeleton, out.anatomy.bones, {}, {}};
  const Anatomy own = edited_source(workshop, document);
  OwnParts(own, workshop.source(), workshop.warp()).add_to(out.anatomy);
  edit_all(true);
}

JointParents joint_parents(const Document& document) {
  JointParents out;
  for (const OwnJoint& own : document.skeleton->joints) {
    if (own.child.empty()) continue;
    if (!own.paired) out[own.child] = own.name;
    for (const char* side : {"_l", "_r"})
      if (own.paired) out[own.child + side] = own.name + side;
  }
  return out;
}

std::vector<std::string> joints_with(Workshop& workshop, const std::string& joint) {
  const Skeleton& skeleton = workshop.source().skeleton;
  const int top = joint_on_side(skeleton, split_side(joint).first, "_l");
  std::vector<std::string> out;
  const std::vector<char> below = joints_below(skeleton, top);
  for (std::size_t j = 0; j < below.size(); ++j)
    if (below[j]) out.push_back(split_side(skeleton.joints[j].name).first);
  return out;
}

}  // namespace ecorche
