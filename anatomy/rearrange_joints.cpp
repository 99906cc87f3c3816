#include "anatomy/rearrange_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

int joint_named(const Skeleton& skeleton, const std::string& name) {
  const int joint = find_joint(skeleton, name);
  if (joint < 0) throw UnfitError(fmt::format("the skeleton has no joint '{}'", name));
  return joint;
}

// Old indices in their new order: each as early as its parent lets it.
std::vector<int> new_order(const Skeleton& skeleton, const std::vector<int>& parents) {
  std::vector<int> out;
  std::vector<bool> placed(parents.size(), false);
  while (out.size() < parents.size()) {
    std::size_t next = 0, left = parents.size();
    for (; next < parents.size(); ++next) {
      if (placed[next]) continue;
      left = std::min(left, next);
      if (parents[next] < 0 || placed[std::size_t(parents[next])]) break;
    }
    if (next == parents.size())
      throw UnfitError(
          fmt::format("joint '{}' hangs on what hangs on it", skeleton.joints[left].name));
    placed[next] = true;
    out.push_back(int(next));
  }
  return out;
}

}  // namespace

void rearrange_joints(const JointParents& wanted, Anatomy& anatomy) {
  if (wanted.empty()) return;
  Skeleton& skeleton = anatomy.skeleton;
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  for (const auto& [name, parent] : wanted)
    parents[std::size_t(joint_named(skeleton, name))] = joint_named(skeleton, parent);

  const std::vector<int> order = new_order(skeleton, parents);
  std::vector<int> number(rest.size());
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
  skeleton = std::move(out);

  for (Bone& bone : anatomy.bones) bone.joint = number[std::size_t(bone.joint)];
  renumber_joints(number, anatomy.muscles);
}

void renumber_joints(std::span<const int> number, std::vector<Muscle>& muscles) {
  for (Muscle& muscle : muscles)
    for (Strip& strip : muscle.strips) {
      for (PathPoint& point : strip.path)
        for (int* joint : {&point.joints[0], &point.joints[1], &point.placing_joint})
          if (*joint >= 0) *joint = number[std::size_t(*joint)];
      for (Wrap& wrap : strip.wraps) wrap.joint = number[std::size_t(wrap.joint)];
    }
}

}  // namespace ecorche::inline v1
