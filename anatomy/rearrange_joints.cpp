#include "anatomy/rearrange_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

int joint_named(const Skeleton& skeleton, const std::string& name) {
  const int joint = find_joint(skeleton, name);
  if (joint < 0) throw UnfitError(fmt::format("the skeleton has no joint '{}'", name));
  return joint;
}

// Old indices in their new order: each as early as its parent lets it.
std::vector<int> new_order(const Skeleton& skeleton, const std::vector<int>& parents,
                           const std::vector<bool>& removed) {
  std::vector<int> out;
  std::vector<bool> placed(parents.size(), false);
  const std::size_t wanted = parents.size() - std::size_t(std::ranges::count(removed, true));
  while (out.size() < wanted) {
    std::size_t next = 0;
    const auto waits = [&](std::size_t j) {
      return placed[j] || removed[j] || (parents[j] >= 0 && !placed[std::size_t(parents[j])]);
    };
    while (next < parents.size() && waits(next)) ++next;
    if (next == parents.size()) {
      std::size_t left = 0;
      while (placed[left] || removed[left]) ++left;
      throw UnfitError(
          fmt::format("joint '{}' hangs on nothing that is left", skeleton.joints[left].name));
    }
    placed[next] = true;
    out.push_back(int(next));
  }
  return out;
}

void renumber(const std::vector<int>& number, const std::string& of, int& joint) {
  if (joint < 0) return;
  joint = number[std::size_t(joint)];
  if (joint < 0) throw UnfitError(fmt::format("muscle '{}' hangs on a joint that is removed", of));
}

}  // namespace

void rearrange_joints(const JointTreeChange& change, Anatomy& anatomy) {
  if (change.empty()) return;
  Skeleton& skeleton = anatomy.skeleton;
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<bool> removed(rest.size(), false);
  for (const std::string& name : change.removed)
    removed[std::size_t(joint_named(skeleton, name))] = true;
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  for (const auto& [name, parent] : change.parents)
    parents[std::size_t(joint_named(skeleton, name))] = joint_named(skeleton, parent);

  const std::vector<int> order = new_order(skeleton, parents, removed);
  std::vector<int> number(rest.size(), -1);
  for (std::size_t k = 0; k < order.size(); ++k) number[std::size_t(order[k])] = int(k);
  Skeleton out;
  for (const int old : order) {
    Joint joint = skeleton.joints[std::size_t(old)];
    const int parent = parents[std::size_t(old)];
    joint.parent = parent < 0 ? -1 : number[std::size_t(parent)];
    joint.X_PJ.translation() =
        rest[std::size_t(old)] - (parent < 0 ? Vec3(Vec3::Zero()) : rest[std::size_t(parent)]);
    out.joints.push_back(std::move(joint));
  }

  for (Muscle& muscle : anatomy.muscles)
    for (Strip& strip : muscle.strips) {
      for (PathPoint& point : strip.path)
        for (int& joint : point.joints) renumber(number, muscle.name, joint);
      for (Wrap& wrap : strip.wraps) renumber(number, muscle.name, wrap.joint);
    }
  std::set<std::string> gone;
  for (const Bone& bone : anatomy.bones)
    if (removed[std::size_t(bone.joint)]) gone.insert(bone.name);
  std::erase_if(anatomy.bones, [&](const Bone& bone) { return gone.contains(bone.name); });
  for (Bone& bone : anatomy.bones) bone.joint = number[std::size_t(bone.joint)];
  std::erase_if(anatomy.fascia, [&](const FasciaSheet& sheet) {
    return std::ranges::any_of(sheet.bones,
                               [&](const std::string& bone) { return gone.contains(bone); });
  });
  skeleton = std::move(out);
}

}  // namespace ecorche::inline v1
