#include "skinning/bind.h"

#include <algorithm>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "skinning/build_tables.h"
#include "skinning/hinge_gain.h"
#include "skinning/joint_shares.h"
#include "skinning/muscle_lift.h"
#include "skinning/muscle_nodes.h"
#include "skinning/share_rules.h"
#include "skinning/skin_survey.h"
#include "skinning/skin_tables.h"

namespace ecorche {
namespace {

constexpr double kLeastShare = 0.015;
constexpr int kMostShares = 6;

void check(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin) {
  if (skin.F.rows() == 0) throw UnfitError("skin: has no triangles; a surface is needed");
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i)
    if (!skin.V.row(i).allFinite()) throw UnfitError(fmt::format("skin: vertex {} is not finite", i));
  if (skin.F.minCoeff() < 0 || skin.F.maxCoeff() >= skin.V.rows()) throw UnfitError("skin: a triangle refers to no vertex");
  if (std::none_of(anatomy.bones.begin(), anatomy.bones.end(), [](const Bone& b) { return b.mesh.F.rows() > 0; }))
    throw UnfitError("anatomy: has no bones to bind a skin to");
  if (rest.X_WJ.size() != anatomy.skeleton.joints.size()) throw std::invalid_argument("bind_skin: the rest pose is of another anatomy");
}

// Twist carriers count for their joint; the four largest are kept.
std::array<Influence, 4> four_joints(const ShareRow& row, const SkinTables& tables) {
  ShareRow joints;
  for (Influence w : row) {
    if (w.joint >= tables.joint_count) w.joint = tables.twists[static_cast<std::size_t>(w.joint - tables.joint_count)].joint;
    const auto it = std::find_if(joints.begin(), joints.end(), [&](const Influence& o) { return o.joint == w.joint; });
    if (it == joints.end()) joints.push_back(w);
    else it->weight += w.weight;
  }
  std::stable_sort(joints.begin(), joints.end(), [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  joints.resize(4);
  double sum = 0;
  for (const Influence& w : joints) sum += w.weight;
  std::array<Influence, 4> out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = {joints[k].joint, joints[k].weight / sum};
  return out;
}

// Shares of the fine vertices: the same blend of base vertices as their positions; the map's small negative entries are cut off.
std::vector<ShareRow> refine_rows(const Refinement& refinement, const std::vector<ShareRow>& base) {
  std::vector<ShareRow> rows(static_cast<std::size_t>(refinement.map.rows()));
  std::vector<double> shares;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    shares.clear();
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(refinement.map, static_cast<Eigen::Index>(i)); it; ++it)
      for (const Influence& w : base[static_cast<std::size_t>(it.col())]) {
        if (static_cast<std::size_t>(w.joint) >= shares.size()) shares.resize(static_cast<std::size_t>(w.joint) + 1, 0.0);
        shares[static_cast<std::size_t>(w.joint)] += it.value() * w.weight;
      }
    double sum = 0;
    for (std::size_t j = 0; j < shares.size(); ++j) {
      if (shares[j] < 1e-4) continue;
      rows[i].push_back({static_cast<int>(j), shares[j]});
      sum += shares[j];
    }
    for (Influence& w : rows[i]) w.weight /= sum;
  }
  return rows;
}

Binding finish(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin, const SkinSurvey& survey, std::vector<ShareRow> rows,
               const BindOptions& options) {
  auto tables = std::make_shared<SkinTables>();
  tables->joint_count = static_cast<int>(anatomy.skeleton.joints.size());
  tables->slice_count = static_cast<int>(rest.slices.size());
  tables->origins = rest_positions(anatomy.skeleton);
  for (const Joint& joint : anatomy.skeleton.joints) {
    tables->parents.push_back(joint.parent);
    tables->long_axes.push_back(joint.axes.col(2));
  }
  tables->lift_limit = options.lift_limit;
  let_scapula_glide(anatomy.skeleton, skin, rows);
  thin_shares(rows, kLeastShare, kMostShares);
  spread_twist(anatomy.skeleton, skin, rows, tables->twists);

  Binding binding;
  binding.vertex_count = static_cast<int>(skin.V.rows());
  binding.anchors = survey.anchors;
  for (const ShareRow& row : rows) binding.joint_weights.push_back(four_joints(row, *tables));
  tables->pairs = add_pairs(anatomy.skeleton, skin, tables->twists, rows);
  const std::vector<LimbSection> sections = limb_sections(anatomy.skeleton, skin, binding);
  apply_hinge_gains(*tables, find_hinge_gains(anatomy.skeleton, skin, sections, *tables, rows), rows);
  std::vector<ShareRow> node_rows;
  if (options.muscle_share > 0 && !rest.slices.empty()) {
    node_rows = place_nodes(anatomy, rest, skin, survey, rows, options.node_spacing, *tables);
    for (MuscleNode& node : tables->nodes) node.weight *= options.muscle_share;
    level_nodes(rest, *tables);
  }
  lay_out(skin, rows, node_rows, *tables);
  binding.tables = std::move(tables);
  return binding;
}

}  // namespace

Binding bind_skin(const Anatomy& anatomy, const Body& body, const BindOptions& options) {
  PosedAnatomy rest;
  pose_anatomy(make_posing_table(anatomy), anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  return bind_skin(anatomy, rest, body.skin, options);
}

Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin, const BindOptions& options) {
  check(anatomy, rest, skin);
  const SkinSurvey survey = survey_skin(Surroundings(anatomy, rest), skin);
  return finish(anatomy, rest, skin, survey, diffuse_shares(anatomy.skeleton, skin, survey, options.blend_width), options);
}

Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base, const Refinement& refinement, const TriMesh& fine,
                  const BindOptions& options) {
  check(anatomy, rest, base);
  check(anatomy, rest, fine);
  if (refinement.map.rows() != fine.V.rows() || refinement.map.cols() != base.V.rows())
    throw std::invalid_argument("bind_skin: the refinement does not lead from the base skin to the fine one");
  const Surroundings inside(anatomy, rest);
  const std::vector<ShareRow> base_rows = diffuse_shares(anatomy.skeleton, base, survey_skin(inside, base), options.blend_width);
  return finish(anatomy, rest, fine, survey_skin(inside, fine), refine_rows(refinement, base_rows), options);
}

}  // namespace ecorche
