#include "morph/placement/own_parts.h"

#include <utility>

namespace ecorche::inline v1 {
namespace {

bool same_points(const Points& a, const Points& b) { return a.rows() == b.rows() && a == b; }

}  // namespace

OwnParts::OwnParts(const Anatomy& own, const Anatomy& built_in, const SkeletonWarp& warp)
    : own_(own), built_in_(built_in), warp_(warp) {
  const int known = int(built_in.skeleton.joints.size());
  for (int j = 0; j < int(own.skeleton.joints.size()); ++j) {
    const int parent = own.skeleton.joints[std::size_t(j)].parent;
    carriers_.push_back(j < known ? j : carrier(parent));
  }
}

void OwnParts::add_to(Anatomy& out) const {
  if (&own_ == &built_in_) return;
  const std::vector<Vec3> rest = rest_positions(own_.skeleton);
  std::vector<Vec3> placed = rest_positions(out.skeleton);
  for (std::size_t j = placed.size(); j < rest.size(); ++j) {
    Joint joint = own_.skeleton.joints[j];
    const std::size_t with = std::size_t(carriers_[j]);
    placed.push_back(carry(rest[j], int(j)));
    joint.X_PJ.translation() = placed[j] - placed[std::size_t(joint.parent)];
    joint.axes = out.skeleton.joints[with].axes * built_in_.skeleton.joints[with].axes.transpose() *
                 joint.axes;
    out.skeleton.joints.push_back(std::move(joint));
  }
  std::vector<Bone> bones;
  for (const Bone& bone : own_.bones) {
    const int known = find_bone(built_in_, bone.name);
    if (known >= 0 && same_points(built_in_.bones[std::size_t(known)].mesh.V, bone.mesh.V)) {
      bones.push_back(out.bones[std::size_t(known)]);
      continue;
    }
    bones.push_back(bone);
    Points& V = bones.back().mesh.V;
    for (Eigen::Index i = 0; i < V.rows(); ++i) V.row(i) = carry(V.row(i), bone.joint);
  }
  out.bones = std::move(bones);
}

}  // namespace ecorche::inline v1
