#include "skinning/flesh_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <tbb/parallel_for.h>

#include "skinning/elastic_skin.h"
#include "skinning/skin_tables.h"

namespace ecorche {
namespace {

constexpr double kStep = 1.0 / 480;        // s
constexpr double kDamping = 0.3;           // of critical
constexpr double kFirm = 0.012, kLoose = 0.045;  // m of tissue: nothing is seen below, all above
constexpr double kFast = 9, kSlow = 4;     // Hz, there
constexpr double kMostShare = 0.3;         // of the tissue, that it lags at most
constexpr int kBlock = 256;

// The matrix exponential of the oscillator over kStep, by its roots.
void set_step(double frequency, FleshTables::Vertex& v) {
  const double w = 2 * std::numbers::pi * frequency, damped = w * std::sqrt(1 - kDamping * kDamping), fall = std::exp(-kDamping * w * kStep);
  const double c = std::cos(damped * kStep), s = std::sin(damped * kStep) / damped;
  v.uu = fall * (c + kDamping * w * s);
  v.uv = fall * s;
  v.vu = -w * w * v.uv;
  v.vv = fall * (c - kDamping * w * s);
  v.ua = -(1 - v.uu) / (w * w);  // towards -a / w^2, where it would come to rest
  v.va = -v.uv;
}

void places_at(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion, long long step, FleshState& state, std::vector<Vec3>& out) {
  thread_local Pose pose;
  pose_at(motion, static_cast<double>(step) * kStep, pose);
  forward_kinematics(skeleton, pose, state.X_WJ);
  state.bones = state.X_WJ;
  for (std::size_t j = 0; j < state.bones.size(); ++j) state.bones[j].translate(-tables.origins[j]);
  const int n = static_cast<int>(tables.vertices.size());
  out.resize(tables.vertices.size());
  tbb::parallel_for(0, (n + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const FleshTables::Vertex& v = tables.vertices[static_cast<std::size_t>(i)];
      Vec3 p = Vec3::Zero();
      for (const Influence& w : v.joints)
        if (w.weight > 0) p += w.weight * (state.bones[static_cast<std::size_t>(w.joint)] * v.rest);
      out[static_cast<std::size_t>(i)] = p;
    }
  });
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

FleshTables make_flesh_tables(const Binding& binding, const Skeleton& skeleton) {
  FleshTables out;
  if (!binding.tables) return out;
  const SkinTables& sheet = binding.tables->base ? *binding.tables->base : *binding.tables;
  if (!sheet.elastic) return out;
  out.vertex_count = sheet.vertex_count;
  out.origins = rest_positions(skeleton);
  for (int s = 0; s < sheet.vertex_count; ++s) {
    const std::size_t at = static_cast<std::size_t>(s);
    const double tissue = sheet.elastic->tissue[at], loose = smooth_step((tissue - kFirm) / (kLoose - kFirm));
    if (loose <= 0) continue;
    FleshTables::Vertex v;
    v.place = s;
    v.joints = sheet.elastic->joint_weights[at];
    v.rest = sheet.elastic->rest[at];
    v.gain = loose;
    v.limit = kMostShare * tissue;
    set_step(kFast + (kSlow - kFast) * loose, v);
    out.vertices.push_back(v);
  }
  return out;
}

void pose_at(const Motion& motion, double time, Pose& out) {
  const double at = std::clamp(time * motion.fps, 0.0, static_cast<double>(motion.frames.size() - 1));
  const std::size_t last = motion.frames.size() - 1, f = std::min(static_cast<std::size_t>(at), last);
  const double t = at - static_cast<double>(f);
  const Pose& a = motion.frames[f];
  if (t <= 0) {
    out = a;
    return;
  }
  const Pose& before = motion.frames[f > 0 ? f - 1 : 0];
  const Pose& b = motion.frames[f + 1];
  const Pose& after = motion.frames[std::min(f + 2, last)];
  // A uniform cubic B-spline would miss the frames; Catmull and Rom's goes through them.
  const double w0 = t * (-0.5 + t * (1 - 0.5 * t)), w1 = 1 + t * t * (-2.5 + 1.5 * t), w2 = t * (0.5 + t * (2 - 1.5 * t)), w3 = t * t * (-0.5 + 0.5 * t);
  out.root = w0 * before.root + w1 * a.root + w2 * b.root + w3 * after.root;
  out.rotations.resize(a.rotations.size());
  for (std::size_t j = 0; j < a.rotations.size(); ++j) {
    const Eigen::Vector4d middle = a.rotations[j].coeffs();
    const auto same_side = [&](const Quat& q) { return Eigen::Vector4d(q.coeffs().dot(middle) < 0 ? -q.coeffs() : q.coeffs()); };
    const Eigen::Vector4d sum = w0 * same_side(before.rotations[j]) + w1 * middle + w2 * same_side(b.rotations[j]) + w3 * same_side(after.rotations[j]);
    out.rotations[j].coeffs() = sum.normalized();
  }
}

void move_flesh(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion, double time, FleshState& state) {
  const long long target = std::llround(time / kStep);
  if (motion.frames.empty() || target < state.step) throw std::invalid_argument("move_flesh: a motion with frames and a time that does not go back are needed");
  if (state.step < 0) {
    state.step = 0;
    state.offset.assign(tables.vertices.size(), Vec3::Zero());
    state.velocity = state.offset;
    state.seen.assign(4 * static_cast<std::size_t>(tables.vertex_count), 0.0f);
    places_at(tables, skeleton, motion, 0, state, state.now);
    state.before = state.now;
    places_at(tables, skeleton, motion, 1, state, state.after);
    for (std::size_t i = 0; i < state.now.size(); ++i) state.before[i] = 2 * state.now[i] - state.after[i];  // it was moving already
  }
  for (; state.step < target; ++state.step) {
    for (std::size_t i = 0; i < tables.vertices.size(); ++i) {
      const FleshTables::Vertex& v = tables.vertices[i];
      const Vec3 a = (state.after[i] - 2 * state.now[i] + state.before[i]) / (kStep * kStep), u = state.offset[i], w = state.velocity[i];
      state.offset[i] = v.uu * u + v.uv * w + v.ua * a;
      state.velocity[i] = v.vu * u + v.vv * w + v.va * a;
    }
    state.before.swap(state.now);
    state.now.swap(state.after);
    places_at(tables, skeleton, motion, state.step + 2, state, state.after);
  }
  for (std::size_t i = 0; i < tables.vertices.size(); ++i) {
    const FleshTables::Vertex& v = tables.vertices[i];
    const Vec3 u = v.gain * state.offset[i], seen = u / (1 + u.norm() / v.limit);
    for (int k = 0; k < 3; ++k) state.seen[4 * static_cast<std::size_t>(v.place) + static_cast<std::size_t>(k)] = static_cast<float>(seen[k]);
  }
}

}  // namespace ecorche
