#include "skinning/rigs/own_motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/mesh_files/gltf_nodes.h"
#include "skinning/rigs/source_rig.h"
#include "skinning/rigs/standing_pose.h"

namespace ecorche::inline v1 {
namespace {

// Largest distance of a joint's place below its parent from the own rig's, by the bones' mean
// length.
constexpr double kSameBone = 0.02;

// The rig's joints that move vertices, by number, and those above them.
std::vector<int> moving_joints(const SourceRig& rig,
                               const std::vector<std::vector<Influence>>& weights) {
  std::vector<bool> moves(rig.joints.size(), false);
  for (const std::vector<Influence>& row : weights)
    for (const Influence& w : row) moves[std::size_t(w.joint)] = true;
  std::vector<int> out;
  for (std::size_t j = rig.joints.size(); j-- > 0;) {
    if (!moves[j]) continue;
    out.push_back(int(j));
    if (rig.joints[j].parent >= 0) moves[std::size_t(rig.joints[j].parent)] = true;
  }
  std::reverse(out.begin(), out.end());
  return out;
}

// Pieces without weights move with the joint above their node.
std::vector<std::vector<Influence>> with_held_pieces(const SourceRig& rig,
                                                     const std::vector<int>& parents) {
  std::vector<std::vector<Influence>> out = rig.weights;
  std::map<int, int> number;
  for (std::size_t j = 0; j < rig.joints.size(); ++j) number[int(rig.joints[j].node)] = int(j);
  for (const SourcePiece& piece : rig.pieces) {
    if (piece.skin >= 0) continue;
    int up = int(piece.node);
    while (up >= 0 && !number.contains(up)) up = parents[std::size_t(up)];
    if (up < 0) continue;
    for (int i = 0; i < piece.vertex_count; ++i)
      out[std::size_t(piece.first_vertex + i)] = {{number.at(up), 1.0}};
  }
  return out;
}

bool is_invertible(const Affine& X) { return std::abs(X.linear().determinant()) > 1e-30; }

// Does every bone of the motion lie below its parent as the rig's does?
bool same_bones(const SourceRig& rig, const std::vector<int>& joints, const NodeMotion& motion) {
  std::map<int, std::size_t> at;
  double size = 0, worst = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const SourceJoint& joint = rig.joints[std::size_t(joints[k])];
    at[joints[k]] = k;
    if (!is_invertible(joint.X_W) || !is_invertible(motion.standing[k])) return false;
    if (joint.parent < 0) continue;
    const Affine& above = rig.joints[std::size_t(joint.parent)].X_W;
    const Vec3 own = above.inverse() * Vec3(joint.X_W.translation());
    const Vec3 theirs =
        motion.standing[at.at(joint.parent)].inverse() * Vec3(motion.standing[k].translation());
    worst = std::max(worst, (own - theirs).norm());
    size += own.norm() / double(joints.size());
  }
  return worst <= kSameBone * size;
}

// Moments of one of our joints from where its vertices stand, by the rig's joints that move them.
using Shares = std::map<int, JointMoments>;

std::vector<Shares> shared_moments(const std::vector<std::vector<Influence>>& theirs,
                                   const std::vector<JointWeights>& ours, std::size_t joints,
                                   const Points& standing, const Points& rest) {
  std::vector<Shares> out(joints);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const Vec3 from = rest.row(Eigen::Index(i)), to = standing.row(Eigen::Index(i));
    const Eigen::Matrix4d at_rest = vertex_moment(from, from), here = vertex_moment(to, from);
    for (const Influence& a : ours[i])
      for (const Influence& b : theirs[i]) {
        if (!(a.weight * b.weight > 0)) continue;
        const double share = a.weight * a.weight * b.weight;
        JointMoments& moments = out[std::size_t(a.joint)][b.joint];
        moments.rest += share * at_rest;
        moments.here += share * here;
      }
  }
  return out;
}

// What brings the motion's scene to the rig's: what stands above the joints, turned or scaled, is
// the rig's own.
Affine scene_map(const GltfTree& own, std::size_t node, const NodeMotion& motion) {
  const int above = own.parents()[node];
  const Affine X = above < 0 ? Affine::Identity() : own.world()[std::size_t(above)];
  return X * motion.above[0].inverse();
}

}  // namespace

std::optional<OwnMotion> own_motion(std::string_view bytes, const std::string& name,
                                    const GltfMotionOptions& options, const OwnSkin& own,
                                    const Skeleton& ours, const Points& rest,
                                    const std::vector<JointWeights>& weights,
                                    std::optional<std::filesystem::path> folder) {
  const SourceRig rig = read_source_rig(*own.source, "the character's own skin");
  const GltfTree tree(GltfFile(*own.source, "the character's own skin"));
  const std::vector<std::vector<Influence>> theirs = with_held_pieces(rig, tree.parents());
  const std::vector<int> joints = moving_joints(rig, theirs);
  std::vector<NodeName> nodes;
  for (const int j : joints)
    nodes.push_back({rig.joints[std::size_t(j)].name, rig.joints[std::size_t(j)].node});
  if (nodes.empty()) return std::nullopt;
  std::optional<NodeMotion> source =
      gltf_node_motion(bytes, name, nodes, options, std::move(folder));
  if (!source || !same_bones(rig, joints, *source)) return std::nullopt;

  Affine to_world = Affine::Identity();
  to_world.linear() = own.scale * own.axes;
  to_world.translation() = own.shift;
  const Affine from_scene = to_world * scene_map(tree, nodes[0].number, *source);
  const Points standing =
      (own.scale * rig.mesh.V * own.axes.transpose()).rowwise() + own.shift.transpose();
  const std::vector<Shares> shares =
      shared_moments(theirs, weights, ours.joints.size(), standing, rest);
  OwnMotion out;
  out.warnings = std::move(source->warnings);
  out.motion.fps = source->fps;
  std::vector<Affine> moves(rig.joints.size(), Affine::Identity());
  std::vector<JointMoments> moments(ours.joints.size());
  for (const std::vector<Affine>& frame : source->frames) {
    for (std::size_t k = 0; k < joints.size(); ++k)
      moves[std::size_t(joints[k])] =
          from_scene * frame[k] * (to_world * rig.joints[std::size_t(joints[k])].X_W).inverse();
    for (std::size_t j = 0; j < moments.size(); ++j) {
      moments[j] = {};
      for (const auto& [joint, share] : shares[j]) {
        moments[j].rest += share.rest;
        moments[j].here += moves[std::size_t(joint)].matrix() * share.here;
      }
    }
    out.motion.frames.push_back(pose_by_moments(ours, moments));
    complete_pose(ours, out.motion.frames.back());
  }
  return out;
}

}  // namespace ecorche::inline v1
