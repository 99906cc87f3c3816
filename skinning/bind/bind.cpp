#include "skinning/bind/bind.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "skinning/bind/hinge_gain.h"
#include "skinning/bind/joint_weights.h"
#include "skinning/bind/limb_sections.h"
#include "skinning/bind/muscle_handles.h"
#include "skinning/bind/muscle_offsets.h"
#include "skinning/bind/pack_mesh.h"
#include "skinning/bind/skin_depth.h"
#include "skinning/bind/skin_weights.h"
#include "skinning/bind/weight_rules.h"

namespace ecorche::inline v1 {
namespace {

void check(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin) {
  if (skin.F.rows() == 0) throw UnfitError("skin: has no triangles; a surface is needed");
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i)
    if (!skin.V.row(i).allFinite())
      throw UnfitError(fmt::format("skin: vertex {} is not finite", i));
  if (skin.F.minCoeff() < 0 || skin.F.maxCoeff() >= skin.V.rows())
    throw UnfitError("skin: a triangle refers to no vertex");
  if (std::none_of(anatomy.bones.begin(), anatomy.bones.end(),
                   [](const Bone& b) { return b.mesh.F.rows() > 0; }))
    throw UnfitError("anatomy: has no bones to bind a skin to");
  if (rest.X_WJ.size() != anatomy.skeleton.joints.size())
    throw std::invalid_argument("bind_skin: the rest pose is of another anatomy");
}

void check_refined(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                   const Refinement& refinement, const TriMesh& fine) {
  check(anatomy, rest, base);
  check(anatomy, rest, fine);
  if (refinement.map.rows() != fine.V.rows() || refinement.map.cols() != base.V.rows())
    throw std::invalid_argument(
        "bind_skin: the refinement does not lead from the base skin to the fine one");
}

SkinDepth depth_of(const Anatomy& anatomy, const AnatomySurfaces& surfaces, const TriMesh& skin) {
  SkinDepth out = measure_skin_depth(surfaces, skin);
  part_lips(anatomy, skin, out);
  return out;
}

// Weights of blend frames, pairs with gain 1; and the four joint weights as they are before pairs
// are added.
struct FrameWeights {
  FrameTables tables;
  SkinWeights skin;
  std::vector<JointWeights> joints;
};

FrameWeights find_frame_weights(const Anatomy& anatomy, const TriMesh& skin, const SkinDepth& depth,
                                const BindOptions& options, const PaintedWeights& painted) {
  const Skeleton& skeleton = anatomy.skeleton;
  FrameWeights out;
  FrameTables& tables = out.tables;
  tables.origins = rest_positions(skeleton);
  for (const Joint& joint : skeleton.joints) {
    tables.parents.push_back(joint.parent);
    tables.long_axes.push_back(joint.axes.col(2));
  }
  std::vector<WeightRow>& rows = out.skin.frames;
  rows = diffuse_joint_weights(skeleton, skin, depth, options.blend_width);
  let_scapula_glide(skeleton, skin, rows);
  release_thigh(skeleton, skin, rows);
  thin_weights(rows, kLeastWeight, kMostJoints);
  for (std::size_t k = 0; k < painted.vertices.size(); ++k)
    rows[painted.vertices[k]] = painted.weights[k];
  spread_twist(skeleton, skin, painted.vertices, rows, tables.twists);
  let_arm_skin_slide(skeleton, skin, tables, rows);
  let_thigh_skin_slide(skeleton, skin, tables, rows);
  out.joints = four_joint_weights(rows, tables);
  tables.pairs = add_frame_pairs(skeleton, skin, tables, rows);
  return out;
}

struct Bound {
  BlendTables tables;  // without the mesh
  SkinWeights weights;
};

Bound find_weights(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                   const SkinDepth& depth, const BindOptions& options,
                   const PaintedWeights& painted) {
  FrameWeights found = find_frame_weights(anatomy, skin, depth, options, painted);
  Bound out;
  out.tables.slice_count = rest.slices.size();
  out.tables.frames = std::move(found.tables);
  out.tables.handles.lift_limit = options.lift_limit;
  out.weights = std::move(found.skin);
  const FrameTables& frames = out.tables.frames;
  const std::vector<LimbSection> sections = limb_sections(anatomy.skeleton, skin, found.joints);
  apply_hinge_gains(frames,
                    find_hinge_gains(anatomy.skeleton, skin, sections, frames, out.weights.frames),
                    out.weights.frames);
  if (options.muscle_share > 0 && !rest.slices.empty()) {
    HandleTables& tables = out.tables.handles;
    out.weights.handles = place_muscle_handles(anatomy, rest, skin, depth, out.weights.frames,
                                               options.handle_spacing, tables);
    for (MuscleHandle& handle : tables.handles) handle.weight *= options.muscle_share;
    level_handles(rest, tables);
  }
  return out;
}

Binding make_binding(const TriMesh& skin, std::vector<Anchor> anchors, const SkinWeights& weights,
                     const FrameTables& frames) {
  return {int(skin.V.rows()), std::move(anchors), four_joint_weights(weights.frames, frames)};
}

std::shared_ptr<const BlendTables> with_mesh(BlendTables tables, const TriMesh& skin,
                                             const SkinWeights& weights) {
  tables.mesh = pack_mesh(skin, tables.frames.origins[0], weights);
  return std::make_shared<const BlendTables>(std::move(tables));
}

}  // namespace

BoundSkin bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                    const BindOptions& options, const PaintedWeights& painted) {
  check(anatomy, rest, skin);
  SkinDepth depth = depth_of(anatomy, AnatomySurfaces(anatomy, rest), skin);
  Bound bound = find_weights(anatomy, rest, skin, depth, options, painted);
  BoundSkin out;
  out.binding = make_binding(skin, std::move(depth.anchors), bound.weights, bound.tables.frames);
  out.blend = with_mesh(std::move(bound.tables), skin, bound.weights);
  out.depth = std::move(depth.depth);
  out.radius = std::move(depth.radius);
  return out;
}

BoundRefinedSkin bind_refined_skin(const Anatomy& anatomy, const PosedAnatomy& rest,
                                   const TriMesh& base, const Refinement& refinement,
                                   const TriMesh& fine, const BindOptions& options,
                                   const PaintedWeights& painted) {
  check_refined(anatomy, rest, base, refinement, fine);
  const AnatomySurfaces surfaces(anatomy, rest);
  SkinDepth depth = depth_of(anatomy, surfaces, base);
  Bound bound = find_weights(anatomy, rest, base, depth, options, painted);
  const SkinWeights finer = refine_weights(refinement, bound.weights, bound.tables.frames,
                                           int(bound.tables.handles.handles.size()));
  BoundRefinedSkin out;
  out.binding = make_binding(fine, find_anchors(surfaces, fine), finer, bound.tables.frames);
  out.blend = with_mesh(bound.tables, fine, finer);
  out.base.binding =
      make_binding(base, std::move(depth.anchors), bound.weights, bound.tables.frames);
  out.base.blend = with_mesh(std::move(bound.tables), base, bound.weights);
  out.base.depth = std::move(depth.depth);
  out.base.radius = std::move(depth.radius);
  return out;
}

Binding bind_for_export(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                        const BindOptions& options, const PaintedWeights& painted) {
  check(anatomy, rest, skin);
  SkinDepth depth = depth_of(anatomy, AnatomySurfaces(anatomy, rest), skin);
  const FrameWeights found = find_frame_weights(anatomy, skin, depth, options, painted);
  return make_binding(skin, std::move(depth.anchors), found.skin, found.tables);
}

Binding bind_for_export(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                        const Refinement& refinement, const TriMesh& fine,
                        const BindOptions& options, const PaintedWeights& painted) {
  check_refined(anatomy, rest, base, refinement, fine);
  const AnatomySurfaces surfaces(anatomy, rest);
  const SkinDepth depth = depth_of(anatomy, surfaces, base);
  const FrameWeights found = find_frame_weights(anatomy, base, depth, options, painted);
  const SkinWeights finer = refine_weights(refinement, found.skin, found.tables, 0);
  return make_binding(fine, find_anchors(surfaces, fine), finer, found.tables);
}

}  // namespace ecorche::inline v1
