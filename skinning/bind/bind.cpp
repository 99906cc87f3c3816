#include "skinning/bind/bind.h"

#include <algorithm>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "anatomy/errors.h"
#include "skinning/bind/blend_frames.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/hinge_gain.h"
#include "skinning/bind/joint_weights.h"
#include "skinning/bind/muscle_handles.h"
#include "skinning/bind/muscle_offsets.h"
#include "skinning/bind/pack_tables.h"
#include "skinning/bind/painted_weights.h"
#include "skinning/bind/skin_depth.h"
#include "skinning/bind/weight_rules.h"
#include "skinning/settle/elastic_skin.h"

namespace ecorche {
namespace {

constexpr double kLeastShare = 0.015;
constexpr int kMostShares = 6, kMostPairs = 4, kMostNodes = 3;

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

// Twist carriers count for their joint, pairs for nothing; the four largest are kept.
std::array<Influence, 4> four_joints(const ShareRow& row, const SkinTables& tables) {
  ShareRow joints;
  for (Influence w : row) {
    if (w.joint >= tables.joint_count + int(tables.twists.size())) continue;
    if (w.joint >= tables.joint_count) w.joint = tables.twists[w.joint - tables.joint_count].joint;
    const auto it = std::find_if(joints.begin(), joints.end(),
                                 [&](const Influence& o) { return o.joint == w.joint; });
    if (it == joints.end())
      joints.push_back(w);
    else
      it->weight += w.weight;
  }
  std::stable_sort(joints.begin(), joints.end(),
                   [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  joints.resize(4);
  double sum = 0;
  for (const Influence& w : joints) sum += w.weight;
  std::array<Influence, 4> out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = {joints[k].joint, joints[k].weight / sum};
  return out;
}

std::vector<std::array<Influence, 4>> four_joints(const std::vector<ShareRow>& rows,
                                                  const SkinTables& tables) {
  std::vector<std::array<Influence, 4>> out;
  out.reserve(rows.size());
  for (const ShareRow& row : rows) out.push_back(four_joints(row, tables));
  return out;
}

// A blend of rows with the blend's weights, for every row of the map. `first` .. `last`: the
// carriers that are taken.
std::vector<ShareRow> blend_rows(const Refinement& refinement, const std::vector<ShareRow>& base,
                                 int first, int last) {
  std::vector<ShareRow> rows(refinement.map.rows());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    ShareRow& row = rows[i];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(refinement.map,
                                                                        Eigen::Index(i));
         it; ++it)
      for (const Influence& w : base[it.col()]) {
        if (w.joint < first || w.joint >= last) continue;
        const auto at = std::find_if(row.begin(), row.end(),
                                     [&](const Influence& o) { return o.joint == w.joint; });
        if (at == row.end())
          row.push_back({w.joint, it.value() * w.weight});
        else
          at->weight += it.value() * w.weight;
      }
    std::sort(row.begin(), row.end(),
              [](const Influence& x, const Influence& y) { return x.joint < y.joint; });
    std::erase_if(row, [](const Influence& w) {
      return w.weight < 1e-4;
    });  // the map's small negative entries among them
  });
  return rows;
}

// What moves each vertex: carriers, and the nodes whose lifts it takes.
struct Movers {
  std::vector<ShareRow> rows, node_rows;
};

// Those of the fine vertices: the same blend of the base vertices' as their positions.
Movers refine_movers(const Refinement& refinement, const Movers& base, const SkinTables& tables) {
  const int first_pair = tables.joint_count + int(tables.twists.size()),
            all = carrier_count(tables);
  Movers fine{blend_rows(refinement, base.rows, 0, first_pair), {}};
  for (ShareRow& row : fine.rows) {
    double sum = 0;
    for (const Influence& w : row) sum += w.weight;
    for (Influence& w : row) w.weight /= sum;
  }
  thin_shares(fine.rows, 0.5 * kLeastShare, kMostShares);
  std::vector<ShareRow> pairs = blend_rows(refinement, base.rows, first_pair, all);
  thin_shares(pairs, 0.5 * kLeastShare, kMostPairs);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    fine.rows[i].insert(fine.rows[i].end(), pairs[i].begin(), pairs[i].end());
  if (!base.node_rows.empty()) {
    fine.node_rows = blend_rows(refinement, base.node_rows, 0, int(tables.nodes.size()));
    thin_shares(fine.node_rows, 0.5 * kLeastShare, kMostNodes);
  }
  return fine;
}

Movers find_movers(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                   const SkinSurvey& survey, const BindOptions& options,
                   const PaintedWeights& painted, SkinTables& tables) {
  tables.joint_count = anatomy.skeleton.joints.size();
  tables.slice_count = rest.slices.size();
  tables.origins = rest_positions(anatomy.skeleton);
  for (const Joint& joint : anatomy.skeleton.joints) {
    tables.parents.push_back(joint.parent);
    tables.long_axes.push_back(joint.axes.col(2));
  }
  tables.lift_limit = options.lift_limit;
  Movers out{diffuse_shares(anatomy.skeleton, skin, survey, options.blend_width), {}};
  let_scapula_glide(anatomy.skeleton, skin, out.rows);
  thin_shares(out.rows, kLeastShare, kMostShares);
  for (std::size_t k = 0; k < painted.vertices.size(); ++k)
    out.rows[painted.vertices[k]] = painted.shares[k];
  spread_twist(anatomy.skeleton, skin, painted.vertices, out.rows, tables.twists);
  const std::vector<std::array<Influence, 4>> four = four_joints(out.rows, tables);
  tables.pairs = add_pairs(anatomy.skeleton, skin, tables.twists, out.rows);
  if (!options.moves) return out;  // what follows is for pairs and nodes
  const std::vector<LimbSection> sections = limb_sections(anatomy.skeleton, skin, four);
  apply_hinge_gains(tables, find_hinge_gains(anatomy.skeleton, skin, sections, tables, out.rows),
                    out.rows);
  if (options.muscle_share > 0 && !rest.slices.empty()) {
    out.node_rows =
        place_nodes(anatomy, rest, skin, survey, out.rows, options.node_spacing, tables);
    for (MuscleNode& node : tables.nodes) node.weight *= options.muscle_share;
    level_nodes(rest, tables);
  }
  return out;
}

// Lays the mesh out, and makes it elastic.
void lay_out_elastic(const Anatomy& anatomy, const TriMesh& skin, const SkinSurvey& survey,
                     const Movers& movers, SkinTables& tables) {
  lay_out(skin, movers.rows, movers.node_rows, tables);
  tables.elastic =
      make_elastic_skin(anatomy.skeleton, skin, survey, four_joints(movers.rows, tables),
                        tables.order, tables.triangles);
}

// Each fine vertex takes the blend of the base vertices' offsets that its place is the blend of
// their places.
void follow_base(const Refinement& refinement, std::shared_ptr<const SkinTables> base,
                 SkinTables& fine) {
  std::vector<int> place(base->vertex_count);
  for (int s = 0; s < base->vertex_count; ++s)
    place[base->order.empty() ? std::size_t(s) : std::size_t(base->order[s])] = s;
  fine.follow_first.push_back(0);
  for (int s = 0; s < fine.vertex_count; ++s) {
    const int v = fine.order.empty() ? s : fine.order[s];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(refinement.map, v); it;
         ++it) {
      fine.follow.push_back(place[it.col()]);
      fine.follow_weight.push_back(float(it.value()));
    }
    fine.follow_first.push_back(int(fine.follow.size()));
  }
  fine.base = std::move(base);
}

Binding finish(const TriMesh& skin, std::vector<Anchor> anchors, const Movers& movers,
               std::shared_ptr<SkinTables> tables, bool moves) {
  Binding binding;
  binding.vertex_count = skin.V.rows();
  binding.anchors = std::move(anchors);
  binding.joint_weights = four_joints(movers.rows, *tables);
  if (moves) binding.tables = std::move(tables);
  return binding;
}

}  // namespace

Binding bind_skin(const Anatomy& anatomy, const Body& body, const BindOptions& options) {
  PosedAnatomy rest;
  pose_anatomy(make_posing_table(anatomy), anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  return bind_skin(anatomy, rest, body.skin, options);
}

Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                  const BindOptions& options) {
  return bind_skin(anatomy, rest, skin, PaintedWeights{}, options);
}

Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                  const PaintedWeights& painted, const BindOptions& options) {
  check(anatomy, rest, skin);
  SkinSurvey survey = survey_skin(Surroundings(anatomy, rest), skin);
  auto tables = std::make_shared<SkinTables>();
  const Movers movers = find_movers(anatomy, rest, skin, survey, options, painted, *tables);
  if (options.moves) lay_out_elastic(anatomy, skin, survey, movers, *tables);
  return finish(skin, std::move(survey.anchors), movers, std::move(tables), options.moves);
}

Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                  const Refinement& refinement, const TriMesh& fine, const BindOptions& options) {
  return bind_skin(anatomy, rest, base, refinement, fine, PaintedWeights{}, options);
}

Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                  const Refinement& refinement, const TriMesh& fine, const PaintedWeights& painted,
                  const BindOptions& options) {
  check(anatomy, rest, base);
  check(anatomy, rest, fine);
  if (refinement.map.rows() != fine.V.rows() || refinement.map.cols() != base.V.rows())
    throw std::invalid_argument(
        "bind_skin: the refinement does not lead from the base skin to the fine one");
  const Surroundings inside(anatomy, rest);
  auto tables = std::make_shared<SkinTables>();
  const SkinSurvey survey = survey_skin(inside, base);
  const Movers movers = find_movers(anatomy, rest, base, survey, options, painted, *tables);
  const Movers finer = refine_movers(refinement, movers, *tables);
  if (options.moves) {
    auto base_tables = std::make_shared<SkinTables>(*tables);
    lay_out(fine, finer.rows, finer.node_rows, *tables);
    lay_out_elastic(anatomy, base, survey, movers, *base_tables);
    follow_base(refinement, std::move(base_tables), *tables);
  }
  return finish(fine, find_anchors(inside, fine), finer, std::move(tables), options.moves);
}

}  // namespace ecorche
