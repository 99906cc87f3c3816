#include "skinning/dynamics/soft_tissue.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <tbb/parallel_for.h>

#include "anatomy/compute/smooth_step.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/motion/sample_motion.h"
#include "skinning/settle/elastic_skin.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kStep = 1.0 / 480;  // s
// Damping, of critical: relaxed, and at full activation.
constexpr double kDamping = 0.3, kActiveDamping = 0.8;
constexpr double kStiffening = 2;      // of the frequency at full activation
constexpr long long kForgotten = 480;  // steps after which the past no longer shows
// Thickness of tissue, m: below the first nothing moves, above the second all of it does; and the
// frequencies there, Hz.
constexpr double kFirm = 0.012, kLoose = 0.045;
constexpr double kFast = 9, kSlow = 4;
constexpr double kMostLag = 0.3;  // of the tissue's thickness
constexpr int kBlock = 256;       // vertices a task

// The matrix exponential of the oscillator over kStep, by its roots.
struct OscillatorStep {
  double uu, uv, ua, vu, vv, va;
  OscillatorStep(double frequency, double activation) {
    const double w = 2 * std::numbers::pi * frequency * (1 + (kStiffening - 1) * activation),
                 damping = kDamping + (kActiveDamping - kDamping) * activation;
    const double damped = w * std::sqrt(1 - damping * damping),
                 fall = std::exp(-damping * w * kStep);
    const double c = std::cos(damped * kStep), s = std::sin(damped * kStep) / damped;
    uu = fall * (c + damping * w * s);
    uv = fall * s;
    vu = -w * w * uv;
    vv = fall * (c - damping * w * s);
    ua = -(1 - uu) / (w * w);  // towards -a / w^2, where it would come to rest
    va = -uv;
  }
};

// The muscles beneath each loose vertex, and the fraction of their activation that reaches it:
// little through thick fat.
void find_muscles(const BlendTables& tables, const Anatomy& anatomy, std::span<const int> loose,
                  std::vector<SoftTissueTables::Vertex>& vertices) {
  std::vector<int> muscle_of_slice;
  for (const SliceRange& range : slice_ranges(anatomy))
    muscle_of_slice.resize(range.end, range.muscle);
  const BlendMesh& mesh = tables.mesh;
  for (const VertexRun& run : mesh.runs)
    for (int e = run.begin; e < run.end; ++e) {
      const int vertex = loose[mesh.sorted_index[e]];
      if (vertex < 0) continue;
      auto& muscles = vertices[vertex].muscles;
      for (int k = 0; k < std::min(run.handles, int(muscles.size())); ++k) {
        const std::size_t entry = run.handle_entry + std::size_t((e - run.begin) * run.handles + k);
        const MuscleHandle& handle = tables.handles.handles[mesh.handle[entry]];
        muscles[k] = {muscle_of_slice[handle.anchor.first],
                      mesh.handle_weight[entry] * handle.weight};
      }
    }
}

double activation_at_vertex(const SoftTissueTables::Vertex& v, std::span<const double> activation) {
  if (activation.empty()) return 0;
  double sum = 0;
  for (const auto& [muscle, fraction] : v.muscles) sum += fraction * activation[muscle];
  return std::min(sum, 1.0);
}

void places_at(const SoftTissueTables& tables, const Skeleton& skeleton, const Motion& motion,
               long long step, SoftTissueState& state, std::vector<Vec3>& out) {
  pose_at(motion, double(step) * kStep, state.pose);
  forward_kinematics(skeleton, state.pose, state.X_WJ);
  state.bones = state.X_WJ;
  for (std::size_t j = 0; j < state.bones.size(); ++j) state.bones[j].translate(-tables.origins[j]);
  const int n = tables.vertices.size();
  out.resize(tables.vertices.size());
  tbb::parallel_for(0, (n + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const SoftTissueTables::Vertex& v = tables.vertices[i];
      Vec3 p = Vec3::Zero();
      for (const Influence& w : v.joints)
        if (w.weight > 0) p += w.weight * (state.bones[w.joint] * v.rest);
      out[i] = p;
    }
  });
}

}  // namespace

SoftTissueTables make_soft_tissue(const CharacterModel& model) {
  const Anatomy& anatomy = model.character.anatomy;
  const BlendTables& tables = *model.skin.base_blend;
  const ElasticSkin& elastic = *model.skin.elastic;
  SoftTissueTables out;
  const int vertex_count = tables.mesh.vertex_count;
  out.vertex_count = vertex_count;
  out.origins = rest_positions(anatomy.skeleton);
  std::vector<int> loose_vertex(vertex_count, -1);
  for (int s = 0; s < vertex_count; ++s) {
    const std::size_t at = s;
    const double tissue = elastic.tissue[at],
                 loose = smooth_step((tissue - kFirm) / (kLoose - kFirm));
    if (loose <= 0) continue;
    SoftTissueTables::Vertex v;
    v.place = s;
    v.joints = elastic.joint_weights[at];
    v.rest = elastic.rest[at];
    v.gain = loose;
    v.limit = kMostLag * tissue;
    v.frequency = kFast + (kSlow - kFast) * loose;
    const OscillatorStep relaxed(v.frequency, 0);
    v.uu = relaxed.uu, v.uv = relaxed.uv, v.ua = relaxed.ua, v.vu = relaxed.vu, v.vv = relaxed.vv,
    v.va = relaxed.va;
    loose_vertex[at] = out.vertices.size();
    out.vertices.push_back(v);
  }
  find_muscles(tables, anatomy, loose_vertex, out.vertices);
  return out;
}

namespace {

// At rest on what moves already, at state.step.
void begin_at_rest(const SoftTissueTables& tables, const Skeleton& skeleton, const Motion& motion,
                   SoftTissueState& state) {
  state.displacement.assign(tables.vertices.size(), Vec3::Zero());
  state.velocity = state.displacement;
  state.offsets.assign(4 * std::size_t(tables.vertex_count), 0.0f);
  places_at(tables, skeleton, motion, state.step, state, state.now);
  state.before = state.now;
  places_at(tables, skeleton, motion, state.step + 1, state, state.after);
  for (std::size_t i = 0; i < state.now.size(); ++i)
    state.before[i] = 2 * state.now[i] - state.after[i];
}

void step_once(const SoftTissueTables& tables, SoftTissueState& state) {
  tbb::parallel_for(
      std::size_t{0}, (tables.vertices.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
        for (std::size_t i = block * kBlock;
             i < std::min(tables.vertices.size(), (block + 1) * kBlock); ++i) {
          const SoftTissueTables::Vertex& v = tables.vertices[i];
          const Vec3 a = (state.after[i] - 2 * state.now[i] + state.before[i]) / (kStep * kStep),
                     u = state.displacement[i], w = state.velocity[i];
          const double activation = activation_at_vertex(v, state.activation);
          if (activation > 0) {
            const OscillatorStep s(v.frequency, activation);
            state.displacement[i] = s.uu * u + s.uv * w + s.ua * a;
            state.velocity[i] = s.vu * u + s.vv * w + s.va * a;
          } else {
            state.displacement[i] = v.uu * u + v.uv * w + v.ua * a;
            state.velocity[i] = v.vu * u + v.vv * w + v.va * a;
          }
        }
      });
}

}  // namespace

void advance_soft_tissue(const SoftTissueTables& tables, const Skeleton& skeleton,
                         const Motion& motion, const Activations& activations, double time,
                         SoftTissueState& state) {
  const long long target = std::llround(time / kStep);
  if (motion.frames.empty() || target < state.step)
    throw std::invalid_argument(
        "advance_soft_tissue: a motion with frames and a time that does not go back are needed");
  if (state.step < 0) {
    state.step = 0;
    begin_at_rest(tables, skeleton, motion, state);
  }
  for (; state.step < target; ++state.step) {
    activation_at(activations, double(state.step) * kStep, state.activation);
    step_once(tables, state);
    state.before.swap(state.now);
    state.now.swap(state.after);
    places_at(tables, skeleton, motion, state.step + 2, state, state.after);
  }
  for (std::size_t i = 0; i < tables.vertices.size(); ++i) {
    const SoftTissueTables::Vertex& v = tables.vertices[i];
    const Vec3 u = v.gain * state.displacement[i], seen = u / (1 + u.norm() / v.limit);
    for (int k = 0; k < 3; ++k) state.offsets[4 * std::size_t(v.place) + k] = float(seen[k]);
  }
}

void seek_soft_tissue(const SoftTissueTables& tables, const Skeleton& skeleton,
                      const Motion& motion, const Activations& activations, double time,
                      SoftTissueState& state) {
  const long long target = std::llround(time / kStep);
  if (!motion.frames.empty() &&
      (state.step < 0 || target < state.step || target > state.step + kForgotten)) {
    state.step = std::max(0LL, target - kForgotten);
    begin_at_rest(tables, skeleton, motion, state);
  }
  advance_soft_tissue(tables, skeleton, motion, activations, time, state);
}

}  // namespace ecorche::inline v1
