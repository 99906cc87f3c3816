#include "skinning/files/clip_shapes.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <span>
#include <utility>

#include "anatomy/muscles/action_line.h"
#include "skinning/files/glb_builder.h"
#include "skinning/files/slice_influences.h"
#include "skinning/files/tissue_meshes.h"
#include "skinning/morphs/join_shapes.h"

namespace ecorche::inline v1 {
namespace {

BlendedMesh blended_mesh(const TriMesh& mesh, std::span<const JointWeights> influences) {
  BlendedMesh out;
  const Points normals = gltf::GlbBuilder::unit_normals(mesh);
  out.positions.assign(mesh.V.data(), mesh.V.data() + mesh.V.size());
  out.normals.assign(normals.data(), normals.data() + normals.size());
  for (const JointWeights& weights : influences) out.influences.push_back(scaled_weights(weights));
  return out;
}

std::span<const float> rows(const PointsF& points, int begin, int end) {
  return {points.data() + 3 * begin, points.data() + 3 * end};
}

}  // namespace

ClipShapes clip_on_rows(const ClipShapes& shapes, std::span<const int> vertices) {
  return {shape_rows(shapes.skin, vertices), shapes.muscles, shapes.fascia};
}

ClipRecorder::ClipRecorder(const Character& character, const Binding& binding,
                           const ClipOptions& options)
    : joint_rest_(rest_positions(character.anatomy.skeleton)) {
  const auto influences = slice_influences(character.anatomy);
  gltf::LoftedMuscles lofted = gltf::lofted_muscles(character.anatomy);
  surface_ = std::move(lofted.surface);
  for (const MuscleSurface::Part& part : surface_.parts) {
    std::vector<JointWeights> shares;
    for (int i = part.vertex_begin; i < part.vertex_end; ++i)
      shares.push_back(influences[std::size_t(surface_.slice[i])]);
    muscles_.push_back({blended_mesh(part_mesh(surface_, part, lofted.positions), shares),
                        MorphBasis(part.vertex_end - part.vertex_begin, options.muscles)});
  }
  fascia_surface_ = make_fascia_surface(character.anatomy);
  const std::vector<JointWeights> of_fascia = fascia_influences(fascia_surface_, influences);
  for (const FasciaSurface::Part& part : fascia_surface_.parts) {
    const FasciaSheet& sheet = character.anatomy.fascia[part.sheet];
    const auto shares = std::span(of_fascia).subspan(
        std::size_t(part.vertex_begin), std::size_t(part.vertex_end - part.vertex_begin));
    fascia_.push_back({blended_mesh({sheet.V, grid_triangles(sheet.rows, sheet.columns)}, shares),
                       MorphBasis(part.vertex_end - part.vertex_begin, options.muscles)});
  }
  if (!character.own)
    skin_.push_back({blended_mesh(character.body.skin, binding.joint_weights),
                     MorphBasis(character.body.skin.V.rows(), options.skin)});
}

void ClipRecorder::add(const PosedAnatomy& posed, const SkinFrame& skin) {
  find_joint_moves(posed.X_WJ, joint_rest_, moves_);
  update_muscle_surface(surface_, posed, posed_);
  update_fascia_surface(fascia_surface_, posed, posed_fascia_);
  const auto record = [&](Recorded& one, std::span<const float> positions,
                          std::span<const float> normals, int stride) {
    const double collapsed = offsets_at_rest(one.mesh, moves_, positions, stride, one.offsets);
    if (!normals.empty()) turns_at_rest(one.mesh, moves_, normals, stride, one.normals);
    one.collapsed = std::max(one.collapsed, collapsed);
    one.basis.add(one.offsets, one.normals);
  };
  // The skin first: it takes longest. Isolated: while this thread waits, it must not begin another
  // frame.
  tbb::this_task_arena::isolate([&] {
    const std::size_t solid = skin_.size() + muscles_.size();
    tbb::parallel_for(std::size_t{0}, solid + fascia_.size(), [&](std::size_t n) {
      if (n < skin_.size()) return record(skin_[n], skin.positions, skin.normals, 4);
      if (n < solid) {
        const std::size_t m = n - skin_.size();
        const MuscleSurface::Part& part = surface_.parts[m];
        return record(muscles_[m], rows(posed_, part.vertex_begin, part.vertex_end), {}, 3);
      }
      const FasciaSurface::Part& part = fascia_surface_.parts[n - solid];
      record(fascia_[n - solid], rows(posed_fascia_, part.vertex_begin, part.vertex_end), {}, 3);
    });
  });
}

MeshShapes ClipRecorder::finish(Recorded& one) {
  MeshShapes out = one.basis.finish();
  out.max_error += one.collapsed;
  return out;
}

ClipShapes ClipRecorder::finish() {
  ClipShapes out;
  out.muscles.resize(muscles_.size());
  out.fascia.resize(fascia_.size());
  const std::size_t solid = skin_.size() + muscles_.size();
  tbb::parallel_for(std::size_t{0}, solid + fascia_.size(), [&](std::size_t n) {
    if (n < skin_.size())
      out.skin = finish(skin_[n]);
    else if (n < solid)
      out.muscles[n - skin_.size()] = finish(muscles_[n - skin_.size()]);
    else
      out.fascia[n - solid] = finish(fascia_[n - solid]);
  });
  return out;
}

}  // namespace ecorche::inline v1
