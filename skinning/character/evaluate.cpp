#include "skinning/character/evaluate.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "anatomy/compute/simd.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/posing/restore_volume.h"
#include "skinning/muscle_collision/keep_skin_over_bones.h"
#include "skinning/muscle_collision/push_muscles.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kBlock = 4096;  // vertices a task
// Newton steps that restore volumes where contact or muscles have moved the skin.
constexpr int kVolumeSteps = 2;

template <class Do>
void each_vertex(std::size_t count, const Do& act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kBlock), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s) act(s);
  });
}

void add(std::span<const float> offsets, std::span<float> positions) {
  if (offsets.size() != positions.size()) return;
  for (std::size_t k = 0; k < positions.size(); k += 4)
    store4(&positions[k], load4(&positions[k]) + load4(&offsets[k]));
}

// The stages of the mesh that relaxes, from its blended positions on.
void relax_skin(const SkinModel& model, const PosedAnatomy& posed, RelaxedSkin& skin,
                SkinLift& lift, SettleWorkspace& settle, LiftWorkspace& lifting) {
  const ElasticSkin& elastic = *model.elastic;
  const std::vector<int>& triangles = elastic.triangles;
  relax_membrane(elastic.membrane, triangles, skin.positions, settle.membrane);
  press_folds(elastic.folds, posed.X_WJ, skin, settle.folded);
  skin.normals.resize(skin.positions.size());
  vertex_normals(skin.positions, triangles, skin.normals, settle.half);
  find_openness(elastic.membrane, skin, settle.smoothing);
  restore_volumes(elastic.volumes, posed.X_WJ, skin);
  lift.lifted = false;
  lift.exposed.clear();  // muscles are pushed below a skin of this frame or of none
  if (!model.collision.empty()) {
    find_liftable(elastic.contact, skin, settle.contact);
    lift_skin_over_muscles(model.collision, posed.slices, skin, lift, lifting);
  }
  const bool separated =
      resolve_self_contact(elastic.membrane, elastic.contact, triangles, skin, settle.contact);
  for (std::size_t i = 0; i < settle.folded.size(); ++i)
    if (settle.folded[i] > SelfContactParameters{}.pressed) skin.pressed[i] = 1;
  // Over lifted skin limbs and body alone keep volumes: were the tissue about a hinge to keep its
  // own, a flexed arm would sink where its muscles have just raised it.
  const HingeVolumes hinges = lift.lifted ? HingeVolumes::free : HingeVolumes::kept;
  for (int step = 0; step < (separated || lift.lifted ? kVolumeSteps : 1); ++step)
    restore_volumes(elastic.volumes, posed.X_WJ, skin, hinges);
  if (model.collision.empty())
    vertex_normals(skin.positions, triangles, skin.normals, settle.half);
  else
    keep_skin_over_bones(model.collision, posed.X_WJ, skin, lifting);
}

// Positions and normals in the caller's order.
void write_skin(const BlendMesh& mesh, std::span<const float> positions,
                std::span<const float> normals, SkinFrame& out) {
  if (mesh.order.empty()) {
    out.positions.assign(positions.begin(), positions.end());
    out.normals.assign(normals.begin(), normals.end());
    return;
  }
  out.positions.resize(positions.size());
  out.normals.resize(positions.size());
  each_vertex(mesh.order.size(), [&](std::size_t s) {
    const std::size_t v = 4 * std::size_t(mesh.order[s]);
    store4(&out.positions[v], load4(&positions[4 * s]));
    store4(&out.normals[v], load4(&normals[4 * s]));
  });
}

// Where `place` puts the positions of the skin's vertices, in its sorted order.
template <class Place>
void fill_skin(const BlendMesh& mesh, const Place& place, CharacterState& state) {
  const bool sorted = mesh.order.empty();  // then written at once
  SkinFrame& frame = sorted ? state.skin : state.sorted;
  frame.positions.resize(4 * std::size_t(mesh.vertex_count));
  frame.normals.resize(frame.positions.size());
  place(frame.positions);
  vertex_normals(frame.positions, mesh.triangles, frame.normals, state.settle.half);
  if (!sorted) write_skin(mesh, frame.positions, frame.normals, state.skin);
}

// The refined skin of a base mesh that has settled.
void refine_skin(const SkinModel& model, CharacterState& state) {
  const BlendMesh& mesh = model.blend->mesh;
  const RefinedMap& map = *model.refined;
  const std::vector<float>& base = state.relaxed.positions;
  fill_skin(
      mesh,
      [&](std::span<float> positions) {
        each_vertex(std::size_t(mesh.vertex_count), [&](std::size_t s) {
          Float4 sum{};
          for (int k = map.first[s]; k < map.first[s + 1]; ++k)
            sum += map.weight[k] * load4(&base[4 * map.base[k]]);
          store4(&positions[4 * s], sum);
        });
        if (!map.offset.empty()) add_blended_offsets(mesh, state.blend, map.offset, positions);
      },
      state);
}

}  // namespace

const SkinFrame& evaluate_posed_skin(const SkinModel& model, std::span<const float> soft_tissue,
                                     CharacterState& state) {
  const BlendMesh& base = model.base_blend->mesh;
  RelaxedSkin& relaxed = state.relaxed;
  pose_blend(*model.blend, state.posed, state.blend);
  relaxed.positions.resize(4 * std::size_t(base.vertex_count));
  blend_skin(base, state.blend, relaxed.positions);
  add(soft_tissue, relaxed.positions);
  relax_skin(model, state.posed, relaxed, state.lift, state.settle, state.lifting);
  if (model.refined)
    refine_skin(model, state);
  else
    write_skin(base, relaxed.positions, relaxed.normals, state.skin);
  return state.skin;
}

const SkinFrame& evaluate_blended_skin(const SkinModel& model, CharacterState& state) {
  pose_blend(*model.blend, state.posed, state.blend);
  state.lift.exposed.clear();
  fill_skin(
      model.blend->mesh,
      [&](std::span<float> positions) { blend_skin(model.blend->mesh, state.blend, positions); },
      state);
  return state.skin;
}

namespace {

void pose_and_cover(const CharacterModel& model, const Pose& pose, const FrameInputs& inputs,
                    CharacterState& state) {
  pose_muscles(model.muscles, model.character.anatomy.skeleton, pose, state.posed, state.contact,
               tbb::this_task_arena::max_concurrency(), inputs.activation);
  evaluate_posed_skin(model.skin, inputs.soft_tissue, state);
}

// The relief of the muscles as they lie in the end.
void show_anatomy(const CharacterModel& model, std::span<const double> activation,
                  CharacterState& state) {
  const std::vector<int>& order = model.skin.base_blend->mesh.order;
  const std::vector<float>& openness = state.relaxed.openness;
  std::vector<float>& open = state.relief.openness;
  open.assign(openness.begin(), openness.end());
  for (std::size_t s = 0; s < order.size(); ++s) open[std::size_t(order[s])] = openness[s];
  add_relief(model.relief, state.posed, activation, state.skin, state.relief);
}

}  // namespace

const SkinFrame& evaluate_skin(const CharacterModel& model, const Pose& pose,
                               const FrameInputs& inputs, CharacterState& state) {
  if (model.relief.empty())
    pose_and_cover(model, pose, inputs, state);
  else
    evaluate(model, pose, inputs, state);
  return state.skin;
}

void evaluate(const CharacterModel& model, const Pose& pose, const FrameInputs& inputs,
              CharacterState& state) {
  pose_and_cover(model, pose, inputs, state);
  if (model.interior) {
    carry_muscles(*model.interior, state.relaxed.positions, state.relaxed.normals, state.posed,
                  state.carrying);
    restore_volumes(model.muscles.posing, {}, state.posed, state.volumes, Threads::all,
                    kMostFirstScale);
  }
  if (!model.skin.collision.empty())
    push_muscles_below_skin(model.skin.collision, model.muscles, state.relaxed, state.lift,
                            state.posed, state.push,
                            model.interior ? NeighbourContact::left : NeighbourContact::resolved);
  if (!model.relief.empty()) show_anatomy(model, inputs.activation, state);
}

}  // namespace ecorche::inline v1
