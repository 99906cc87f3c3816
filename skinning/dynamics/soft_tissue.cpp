#include "skinning/dynamics/soft_tissue.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <tbb/parallel_for.h>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/motion/sample_motion.h"
#include "skinning/settle/elastic_skin.h"

namespace ecorche {
namespace {

constexpr double kStep = 1.0 / 480;                      // s
constexpr double kDamping = 0.3, kWorkingDamping = 0.8;  // of critical; at full effort
constexpr double kStiffening = 2;                        // of the frequency at full effort
constexpr long long kForgotten = 480;            // steps after which the past no longer shows
constexpr double kFirm = 0.012, kLoose = 0.045;  // m of tissue: nothing is seen below, all above
constexpr double kFast = 9, kSlow = 4;           // Hz, there
constexpr double kMostShare = 0.3;               // of the tissue, that it lags at most
constexpr int kBlock = 256;

// The matrix exponential of the oscillator over kStep, by its roots.
struct FleshStep {
  double uu, uv, ua, vu, vv, va;
  FleshStep(double frequency, double effort) {
    const double w = 2 * std::numbers::pi * frequency * (1 + (kStiffening - 1) * effort),
                 damping = kDamping + (kWorkingDamping - kDamping) * effort;
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

// The muscles that each vertex of the sheet lies over, and how much of their effort reaches it:
// little through thick fat.
void find_muscles(const SkinTables& sheet, const Anatomy& anatomy, std::span<const int> loose,
                  std::vector<FleshTables::Vertex>& vertices) {
  std::vector<int> muscle_of_slice;
  for (const SliceRange& range : slice_ranges(anatomy))
    muscle_of_slice.resize(range.end, range.muscle);
  for (const VertexRun& run : sheet.runs)
    for (int e = run.begin; e < run.end; ++e) {
      const int vertex = loose[sheet.place[e]];
      if (vertex < 0) continue;
      auto& muscles = vertices[vertex].muscles;
      for (int k = 0; k < std::min(run.nodes, int(muscles.size())); ++k) {
        const std::size_t entry = run.node_entry + std::size_t((e - run.begin) * run.nodes + k);
        const MuscleNode& node = sheet.nodes[sheet.node[entry]];
        muscles[k] = {muscle_of_slice[node.anchor.first], sheet.node_weight[entry] * node.weight};
      }
    }
}

double effort_at(const FleshTables::Vertex& v, std::span<const double> efforts) {
  if (efforts.empty()) return 0;
  double sum = 0;
  for (const auto& [muscle, share] : v.muscles) sum += share * efforts[muscle];
  return std::min(sum, 1.0);
}

void places_at(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion,
               long long step, FleshState& state, std::vector<Vec3>& out) {
  thread_local Pose pose;
  pose_at(motion, double(step) * kStep, pose);
  forward_kinematics(skeleton, pose, state.X_WJ);
  state.bones = state.X_WJ;
  for (std::size_t j = 0; j < state.bones.size(); ++j) state.bones[j].translate(-tables.origins[j]);
  const int n = tables.vertices.size();
  out.resize(tables.vertices.size());
  tbb::parallel_for(0, (n + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const FleshTables::Vertex& v = tables.vertices[i];
      Vec3 p = Vec3::Zero();
      for (const Influence& w : v.joints)
        if (w.weight > 0) p += w.weight * (state.bones[w.joint] * v.rest);
      out[i] = p;
    }
  });
}

}  // namespace

FleshTables make_flesh_tables(const Binding& binding, const Anatomy& anatomy) {
  FleshTables out;
  if (!binding.tables) return out;
  const SkinTables& sheet = binding.tables->base ? *binding.tables->base : *binding.tables;
  if (!sheet.elastic) return out;
  out.vertex_count = sheet.vertex_count;
  out.origins = rest_positions(anatomy.skeleton);
  std::vector<int> loose_vertex(sheet.vertex_count, -1);
  for (int s = 0; s < sheet.vertex_count; ++s) {
    const std::size_t at = s;
    const double tissue = sheet.elastic->tissue[at],
                 loose = smooth_step((tissue - kFirm) / (kLoose - kFirm));
    if (loose <= 0) continue;
    FleshTables::Vertex v;
    v.place = s;
    v.joints = sheet.elastic->joint_weights[at];
    v.rest = sheet.elastic->rest[at];
    v.gain = loose;
    v.limit = kMostShare * tissue;
    v.frequency = kFast + (kSlow - kFast) * loose;
    const FleshStep relaxed(v.frequency, 0);
    v.uu = relaxed.uu, v.uv = relaxed.uv, v.ua = relaxed.ua, v.vu = relaxed.vu, v.vv = relaxed.vv,
    v.va = relaxed.va;
    loose_vertex[at] = out.vertices.size();
    out.vertices.push_back(v);
  }
  find_muscles(sheet, anatomy, loose_vertex, out.vertices);
  return out;
}

namespace {

// At rest on what moves already, at state.step.
void begin_flesh(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion,
                 FleshState& state) {
  state.offset.assign(tables.vertices.size(), Vec3::Zero());
  state.velocity = state.offset;
  state.seen.assign(4 * std::size_t(tables.vertex_count), 0.0f);
  places_at(tables, skeleton, motion, state.step, state, state.now);
  state.before = state.now;
  places_at(tables, skeleton, motion, state.step + 1, state, state.after);
  for (std::size_t i = 0; i < state.now.size(); ++i)
    state.before[i] = 2 * state.now[i] - state.after[i];
}

void step_flesh(const FleshTables& tables, FleshState& state) {
  tbb::parallel_for(
      std::size_t{0}, (tables.vertices.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
        for (std::size_t i = block * kBlock;
             i < std::min(tables.vertices.size(), (block + 1) * kBlock); ++i) {
          const FleshTables::Vertex& v = tables.vertices[i];
          const Vec3 a = (state.after[i] - 2 * state.now[i] + state.before[i]) / (kStep * kStep),
                     u = state.offset[i], w = state.velocity[i];
          const double effort = effort_at(v, state.efforts);
          if (effort > 0) {
            const FleshStep s(v.frequency, effort);
            state.offset[i] = s.uu * u + s.uv * w + s.ua * a;
            state.velocity[i] = s.vu * u + s.vv * w + s.va * a;
          } else {
            state.offset[i] = v.uu * u + v.uv * w + v.ua * a;
            state.velocity[i] = v.vu * u + v.vv * w + v.va * a;
          }
        }
      });
}

}  // namespace

void move_flesh(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion,
                const Activations& efforts, double time, FleshState& state) {
  const long long target = std::llround(time / kStep);
  if (motion.frames.empty() || target < state.step)
    throw std::invalid_argument(
        "move_flesh: a motion with frames and a time that does not go back are needed");
  if (state.step < 0) {
    state.step = 0;
    begin_flesh(tables, skeleton, motion, state);
  }
  for (; state.step < target; ++state.step) {
    activation_at(efforts, double(state.step) * kStep, state.efforts);
    step_flesh(tables, state);
    state.before.swap(state.now);
    state.now.swap(state.after);
    places_at(tables, skeleton, motion, state.step + 2, state, state.after);
  }
  for (std::size_t i = 0; i < tables.vertices.size(); ++i) {
    const FleshTables::Vertex& v = tables.vertices[i];
    const Vec3 u = v.gain * state.offset[i], seen = u / (1 + u.norm() / v.limit);
    for (int k = 0; k < 3; ++k) state.seen[4 * std::size_t(v.place) + k] = float(seen[k]);
  }
}

void seek_flesh(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion,
                const Activations& efforts, double time, FleshState& state) {
  const long long target = std::llround(time / kStep);
  if (!motion.frames.empty() &&
      (state.step < 0 || target < state.step || target > state.step + kForgotten)) {
    state.step = std::max(0LL, target - kForgotten);
    begin_flesh(tables, skeleton, motion, state);
  }
  move_flesh(tables, skeleton, motion, efforts, time, state);
}

}  // namespace ecorche
