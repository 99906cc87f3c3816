#include "app/edit/skeleton_actions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "anatomy/bones/own_joints.h"
#include "anatomy/errors.h"
#include "anatomy/files/similar_names.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/document/edited_skeleton.h"
#include "app/edit/document/own_mesh.h"
#include "app/edit/hanging_strips.h"
#include "morph/placement/bone_groups.h"
#include "morph/placement/joint_regressor.h"

namespace ecorche {
namespace {

constexpr double kLeastFactor = 0.5, kMostFactor = 2, kMostLength = 60;  // mm

std::vector<std::string> group_names(Workshop& workshop) {
  std::vector<std::string> out;
  for (const GroupRule& rule : workshop.base().tables.rules.groups) out.push_back(rule.name);
  return out;
}

void check_group(Workshop& workshop, const std::string& name) {
  const std::vector<std::string> names = group_names(workshop);
  if (std::ranges::find(names, name) != names.end()) return;
  throw InputError(
      fmt::format("argument 'group': '{}': there is no such group of bones{}; there "
                  "are {}",
                  name, did_you_mean(name, names), fmt::join(names, ", ")));
}

void check_own_name(const std::string& name, const std::vector<std::string>& taken) {
  const std::string base = split_side(name).first;
  const bool letters = !base.empty() && std::ranges::all_of(base, [](unsigned char c) {
    return std::isdigit(c) || std::islower(c) || c == '_';
  });
  if (!letters)
    throw InputError(
        fmt::format("argument 'name': '{}': expected small letters, digits and _", name));
  if (std::ranges::find(taken, base) != taken.end() ||
      std::ranges::find(taken, name) != taken.end())
    throw InputError(fmt::format("argument 'name': '{}': there is one of that name", name));
}

// What a joint hangs on now, as documents name it.
std::string parent_now(Workshop& workshop, const Document& document, const std::string& joint) {
  std::string out;
  for (const OwnJoint& own : document.skeleton->joints) {
    if (own.name == joint) out = own.parent;
    if (own.child == joint) out = own.name;
  }
  if (!out.empty()) return out;
  const Skeleton& skeleton = workshop.source().skeleton;
  const std::vector<std::string> names = sided_names(skeleton, joint);
  const int found = names.empty() ? -1 : find_joint(skeleton, names.front());
  const int parent = found < 0 ? -1 : skeleton.joints[std::size_t(found)].parent;
  return parent < 0 ? std::string() : split_side(skeleton.joints[std::size_t(parent)].name).first;
}

const OwnBone& own_bone(const Document& document, const std::string& name) {
  std::vector<std::string> names;
  for (const OwnBone& bone : document.skeleton->bones) {
    if (bone.name == name) return bone;
    names.push_back(bone.name);
  }
  throw InputError(
      fmt::format("argument 'bone': '{}': there is no bone of one's own of that "
                  "name{}; add_bone makes one",
                  name, did_you_mean(name, names)));
}

// As it reads back from a project.
TablePoint rounded_place(Workshop& workshop, const Document& document, const std::string& text) {
  const TablePoint place = read_place(workshop, document, text);
  return read_place(workshop, document, place_text(*document.frame, place));
}

// In place of one whose bone is taken away: the others keep their index. No place can name it.
const SourceLandmark kNoLandmark{"a bone that was removed", "", "", Vec3::Zero(), "remove_bone"};

// The landmark by which scripts say places on a bone of one's own: its highest vertex.
void set_landmark(Workshop& workshop, const OwnBone& bone, Document& document) {
  const TriMesh placed = placed_bone(workshop, document, bone);
  Eigen::Index top = 0;
  placed.V.col(1).maxCoeff(&top);
  const Vec3 position = placed.V.row(top);
  const std::string name = split_side(bone.name).first;
  document = with_part(document, &Document::frame, [&](MuscleTable& frame) {
    const int known = find_landmark(frame, name);
    if (known < 0)
      frame.landmarks.push_back({name, name, "its highest point", position, "add_bone"});
    else
      frame.landmarks[std::size_t(known)].position = position;
  });
}

}  // namespace

void arguments(Arguments& a, SetGroup& x) {
  a.text("group", "group of bones", x.group, Need::required,
         "as data/bone_groups.csv names it: femur, thorax, foot, ...");
  for (std::size_t k = 0; k < x.values.size(); ++k) {
    const GroupMeasure& measure = group_measures()[k];
    const NumberRange range =
        measure.factor ? NumberRange{ArgumentUnit::none, kLeastFactor, kMostFactor}
                       : NumberRange{ArgumentUnit::millimetre, -kMostLength, kMostLength};
    a.number(measure.name, x.values[k], range, measure.help);
  }
}
Document apply(Workshop& workshop, const Document& document, const SetGroup& x) {
  check_group(workshop, x.group);
  if (std::ranges::none_of(x.values, [](const auto& value) { return value.has_value(); }))
    throw InputError("no measure is given; say length=1.05 or another");
  return with_part(document, &Document::skeleton, [&](EditedSkeleton& skeleton) {
    auto& values = skeleton.groups.try_emplace(x.group, GroupScale::unchanged()).first->second;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (x.values[k]) values[k] = *x.values[k];
    if (values == GroupScale::unchanged()) skeleton.groups.erase(x.group);
  });
}

void arguments(Arguments& a, ResetGroup& x) {
  a.text("group", "group of bones", x.group, Need::required, "that the skin alone shapes again");
}
Document apply(Workshop& workshop, const Document& document, const ResetGroup& x) {
  check_group(workshop, x.group);
  return with_part(document, &Document::skeleton,
                   [&](EditedSkeleton& skeleton) { skeleton.groups.erase(x.group); });
}

void arguments(Arguments& a, AddJoint& x) {
  a.text("name", "name", x.name, Need::required,
         "small letters, digits and _; with _l or _r: of that side alone");
  a.text("parent", "joint", x.parent, Need::required, "that it hangs on");
  a.text("at", "place", x.at, Need::required, "its centre: LANDMARK+L,U,F or BONE@L,U,F");
  a.text("to", "place", x.to, Need::optional,
         "where its long axis points to; left out: away from its parent");
  a.text("child", "joint", x.child, Need::optional,
         "of the parent: the new joint stands between them");
  a.choice("paired", x.paired, {"yes", "no"}, Need::optional,
           "left and right; left out: as its parent");
}
Document apply(Workshop& workshop, const Document& document, const AddJoint& x) {
  check_own_name(x.name, joint_names(workshop, document));
  check_own_name(x.name, workshop.joint_names());
  check_joint(workshop, document, x.parent, "parent");
  OwnJoint joint{x.name, x.parent, x.child, false, rounded_place(workshop, document, x.at)};
  if (!x.to.empty()) joint.to = rounded_place(workshop, document, x.to);
  const bool one_side = split_side(x.name).second != Side::middle;
  const bool by_parent = is_paired(workshop, document, x.parent);
  joint.paired = !one_side && (x.paired.empty() ? by_parent : x.paired == "yes");
  if (!joint.paired && !one_side && by_parent)
    throw InputError(
        fmt::format("argument 'paired': 'no': '{}' has two sides; say {}_l or {}_r for "
                    "a joint on one of them",
                    x.parent, x.name, x.name));
  if (!x.child.empty()) {
    check_joint(workshop, document, x.child, "child");
    const std::string now = parent_now(workshop, document, x.child);
    if (now != x.parent)
      throw InputError(fmt::format("argument 'child': '{}': it hangs on '{}', not on '{}'", x.child,
                                   now, x.parent));
    if (is_paired(workshop, document, x.child) != joint.paired)
      throw InputError(
          fmt::format("argument 'child': '{}': expected a joint of as many sides", x.child));
  }
  return with_part(document, &Document::skeleton,
                   [&](EditedSkeleton& skeleton) { skeleton.joints.push_back(joint); });
}

void arguments(Arguments& a, RemoveJoint& x) {
  a.text("joint", "joint", x.joint, Need::required,
         "of one's own, or of a finger or toe with all beyond it");
  a.choice("muscles", x.muscles, {"keep", "remove"}, Need::optional,
           "what hangs on it: refused, or its strips are taken away, too");
}
Document apply(Workshop& workshop, const Document& document, const RemoveJoint& x) {
  check_joint(workshop, document, x.joint);
  const EditedSkeleton& now = *document.skeleton;
  const auto own = std::ranges::find(now.joints, x.joint, &OwnJoint::name);
  const auto [base, side] = split_side(x.joint);
  if (own == now.joints.end() && !is_of_digit(base))
    throw InputError(
        fmt::format("argument 'joint': '{}': every body has it, and the fit looks for "
                    "it; joints of fingers, toes and one's own can be taken away",
                    x.joint));
  const std::vector<std::string> joints =
      own != now.joints.end() ? std::vector<std::string>{x.joint} : joints_with(workshop, base);
  const auto goes = [&](const std::string& joint) {
    return std::ranges::find(joints, joint) != joints.end() ||
           std::ranges::find(joints, split_side(joint).first) != joints.end();
  };
  for (const OwnJoint& other : now.joints)
    if (goes(other.parent) &&
        !(own != now.joints.end() && other.child == own->child && !other.child.empty()))
      throw InputError(
          fmt::format("argument 'joint': '{}': joint '{}' hangs on it; remove_joint {} "
                      "first",
                      x.joint, other.name, other.name));
  for (const OwnBone& bone : now.bones)
    if (goes(bone.joint))
      throw InputError(
          fmt::format("argument 'joint': '{}': bone '{}' hangs on it; remove_bone {} "
                      "first",
                      x.joint, bone.name, bone.name));
  Document out = document;
  if (own != now.joints.end())
    return with_part(out, &Document::skeleton, [&](EditedSkeleton& skeleton) {
      for (OwnJoint& other : skeleton.joints)
        if (other.parent == x.joint) other.parent = own->parent;
      std::erase_if(skeleton.joints, [&](const OwnJoint& each) { return each.name == x.joint; });
    });
  const std::set<std::string> bones = bones_of(workshop, joints);
  const HangingStrips hanging = hanging_on(document, bones, side);
  if (!hanging.muscles.empty() && x.muscles != "remove")
    throw InputError(
        fmt::format("argument 'joint': '{}': muscles hang on it: {}; move their ends, "
                    "or say muscles=remove to take these strips away, too",
                    x.joint, hanging.words()));
  out = without_strips_on(std::move(out), bones, side);
  return with_part(out, &Document::skeleton,
                   [&](EditedSkeleton& skeleton) { skeleton.removed.insert(x.joint); });
}

void arguments(Arguments& a, RestoreJoint& x) {
  a.text("joint", "joint", x.joint, Need::required,
         "that was taken away; its muscles come back by undo, or by hand");
}
Document apply(Workshop&, const Document& document, const RestoreJoint& x) {
  const auto& removed = document.skeleton->removed;
  if (!removed.contains(x.joint))
    throw InputError(fmt::format("argument 'joint': '{}': it was not taken away; there are [{}]",
                                 x.joint, fmt::join(removed, ", ")));
  return with_part(document, &Document::skeleton,
                   [&](EditedSkeleton& skeleton) { skeleton.removed.erase(x.joint); });
}

void arguments(Arguments& a, SnapJoint& x) {
  a.text("joint", "joint", x.joint, Need::required,
         "whose centre goes where the skin says that it is");
}
Document apply(Workshop& workshop, const Document& document, const SnapJoint& x) {
  check_joint(workshop, document, x.joint);
  const Template& base = workshop.base();
  const NamedPoints centres = joint_centres(
      base.tables.regressor, base.body.skin.V.topRows(base.tables.topology.skin_size));
  const std::string name = split_side(x.joint).first;
  const auto centre = centres.find(name);
  std::vector<std::string> known;
  for (const auto& each : centres) known.push_back(each.first);
  const std::vector<std::string> sides = sided_names(base.anatomy.skeleton, name);
  if (centre == centres.end() || sides.empty())
    throw InputError(
        fmt::format("argument 'joint': '{}': the skin does not say where it is; it "
                    "does of {}",
                    x.joint, fmt::join(known, ", ")));
  const int joint = find_joint(base.anatomy.skeleton, sides.front());
  const Vec3 rest = rest_positions(base.anatomy.skeleton)[std::size_t(joint)];
  Vec3 by = 1e3 * (centre->second - rest);
  for (double& value : by) value = std::round(100 * value) / 100 + 0.0;
  return with_part(document, &Document::joints, [&](auto& joints) {
    EditedJoint& edited = joints[x.joint];
    edited.moved = by;
    const bool limited =
        std::ranges::any_of(edited.limits, [](const auto& each) { return each.has_value(); });
    if (by.isZero() && edited.turned.isZero() && !limited) joints.erase(x.joint);
  });
}

void arguments(Arguments& a, AddBone& x) {
  a.text("name", "name", x.name, Need::required,
         "small letters, digits and _; on both sides where the joint is");
  a.text("joint", "joint", x.joint, Need::required, "that carries it");
  a.text("file", "file", x.file, Need::required, "mesh: OBJ, PLY, STL, OFF, GLB");
  unit_and_up(a, x.unit, x.up);
  a.vector("at", x.at, ArgumentUnit::millimetre, Need::optional,
           "of the mesh's origin, from the joint's centre");
  a.vector("turn", x.turn, ArgumentUnit::degree, Need::optional, "about left, then up, then front");
  a.number("scale", x.scale, {ArgumentUnit::none, 0.01, 100}, Need::optional, "times the file's");
}
Document apply(Workshop& workshop, const Document& document, const AddBone& x) {
  std::vector<std::string> taken = workshop.bone_names();
  for (const OwnBone& bone : document.skeleton->bones) taken.push_back(bone.name);
  for (const SourceLandmark& landmark : document.frame->landmarks) taken.push_back(landmark.id);
  check_own_name(x.name, taken);
  check_joint(workshop, document, x.joint);
  const OwnBone bone{
      x.name, x.joint, std::make_shared<TriMesh>(read_own_mesh(x.file, x.unit, x.up)), x.file, x.at,
      x.turn, x.scale};
  Document out = with_part(document, &Document::skeleton,
                           [&](EditedSkeleton& skeleton) { skeleton.bones.push_back(bone); });
  set_landmark(workshop, bone, out);
  return out;
}

void arguments(Arguments& a, SetBone& x) {
  a.text("bone", "bone", x.bone, Need::required, "of one's own");
  a.vector("by", x.by, ArgumentUnit::millimetre, Need::optional, "how far it is moved");
  a.vector("turn", x.turn, ArgumentUnit::degree, Need::optional,
           "how far it is turned, more, about left, then up, then front");
  a.number("scale", x.scale, {ArgumentUnit::none, 0.01, 100}, "times the file's");
}
Document apply(Workshop& workshop, const Document& document, const SetBone& x) {
  OwnBone bone = own_bone(document, x.bone);
  bone.at += x.by;
  bone.turn += x.turn;
  if (x.scale) bone.scale = *x.scale;
  Document out = with_part(document, &Document::skeleton, [&](EditedSkeleton& skeleton) {
    *std::ranges::find(skeleton.bones, x.bone, &OwnBone::name) = bone;
  });
  set_landmark(workshop, bone, out);
  return out;
}

void arguments(Arguments& a, RemoveBone& x) {
  a.text("bone", "bone", x.bone, Need::required, "of one's own, that no muscle hangs on");
}
Document apply(Workshop&, const Document& document, const RemoveBone& x) {
  const std::string name = split_side(own_bone(document, x.bone).name).first;
  const HangingStrips hanging = hanging_on(document, {name}, Side::middle);
  if (!hanging.muscles.empty())
    throw InputError(
        fmt::format("argument 'bone': '{}': muscles hang on it: {}; move their ends "
                    "first",
                    x.bone, hanging.words()));
  for (const TableWrap& wrap : document.frame->wraps)
    if (document.frame->landmarks[std::size_t(wrap.landmark)].carrier == name)
      throw InputError(
          fmt::format("argument 'bone': '{}': wrap '{}' rides on it; remove_wrap {} "
                      "first",
                      x.bone, wrap.name, wrap.name));
  const auto lies_on_it = [&](const TablePoint& place) {
    return document.frame->landmarks[std::size_t(place.landmark)].carrier == name;
  };
  for (const OwnJoint& joint : document.skeleton->joints)
    if (lies_on_it(joint.at) || (joint.to && lies_on_it(*joint.to)))
      throw InputError(
          fmt::format("argument 'bone': '{}': joint '{}' is placed by it; remove_joint {} first",
                      x.bone, joint.name, joint.name));
  Document out = with_part(document, &Document::skeleton, [&](EditedSkeleton& skeleton) {
    std::erase_if(skeleton.bones, [&](const OwnBone& bone) { return bone.name == x.bone; });
  });
  return with_part(out, &Document::frame, [&](MuscleTable& frame) {
    const int landmark = find_landmark(frame, name);
    if (landmark >= 0) frame.landmarks[std::size_t(landmark)] = kNoLandmark;
  });
}

}  // namespace ecorche
