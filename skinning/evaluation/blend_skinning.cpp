#include "skinning/evaluation/blend_skinning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "anatomy/geometry/vertex_normals.h"

namespace ecorche::inline v1 {
namespace {

// Three rows of four: the map of one bone.
struct Matrix34 {
  float m[12];
};

std::vector<Matrix34> to_rows(std::span<const Transform> bones) {
  std::vector<Matrix34> out(bones.size());
  for (std::size_t b = 0; b < bones.size(); ++b)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) out[b].m[4 * r + c] = float(bones[b].matrix()(r, c));
  return out;
}

inline void write_vertex(float* position, float* normal, const float p[3], const float n[3]) {
  const float scale = 1.0f / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + 1e-30f);
  for (int r = 0; r < 3; ++r) {
    position[r] = p[r];
    normal[r] = n[r] * scale;
  }
  position[3] = 1;
  normal[3] = 0;
}

void prepare(const BlendSkin& skin, std::span<const Transform> bones, SkinFrame& out) {
  const std::size_t n = skin.bones.size();
  if (skin.positions.size() != 3 * n || skin.normals.size() != 3 * n || skin.weights.size() != n)
    throw std::invalid_argument(
        "blend skin: positions, normals, bones and weights differ in length");
  if (bones.size() < std::size_t(skin.bone_count))
    throw std::invalid_argument("blend skin: fewer bone maps than the weights refer to");
  out.positions.resize(4 * n);
  out.normals.resize(4 * n);
}

struct DualQuat {
  float r[4], d[4];  // w x y z
};

DualQuat to_dual(const Transform& X) {
  Quat q(X.linear());
  q.normalize();
  const Vec3 t = X.translation();
  const Quat dual = Quat(0, t.x(), t.y(), t.z()) * q;
  return {
      {float(q.w()), float(q.x()), float(q.y()), float(q.z())},
      {float(0.5 * dual.w()), float(0.5 * dual.x()), float(0.5 * dual.y()), float(0.5 * dual.z())}};
}

}  // namespace

BlendSkin make_blend_skin(const TriMesh& rest, std::span<const std::vector<BoneWeight>> weights) {
  const std::size_t n = rest.V.rows();
  if (weights.size() != n)
    throw std::invalid_argument("make_blend_skin: one row of weights a vertex is needed");
  BlendSkin skin;
  std::vector<float> padded(4 * n, 1.0f), normals(4 * n);
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) padded[4 * i + std::size_t(k)] = float(rest.V(Eigen::Index(i), k));
  vertex_normals(padded, {rest.F.data(), std::size_t(rest.F.size())}, normals);
  skin.positions.resize(3 * n);
  skin.normals.resize(3 * n);
  skin.bones.assign(n, {0, 0, 0, 0});
  skin.weights.assign(n, {0, 0, 0, 0});
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      skin.positions[3 * i + k] = padded[4 * i + k];
      skin.normals[3 * i + k] = normals[4 * i + k];
    }
    std::vector<BoneWeight> row = weights[i];
    std::stable_sort(row.begin(), row.end(),
                     [](const BoneWeight& a, const BoneWeight& b) { return a.weight > b.weight; });
    row.resize(std::min<std::size_t>(row.size(), 4));
    double sum = 0;
    for (const BoneWeight& w : row) sum += w.weight;
    if (!(sum > 0)) throw std::invalid_argument("make_blend_skin: a vertex without weight");
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (row[k].bone < 0) throw std::invalid_argument("make_blend_skin: a negative bone index");
      skin.bones[i][k] = row[k].bone;
      skin.bone_count = std::max(skin.bone_count, row[k].bone + 1);
      skin.weights[i][k] = float(row[k].weight / sum);
    }
  }
  return skin;
}

void deform_linear(const BlendSkin& skin, std::span<const Transform> bones, SkinFrame& out) {
  prepare(skin, bones, out);
  const std::vector<Matrix34> rows = to_rows(bones);
  for (std::size_t i = 0; i < skin.bones.size(); ++i) {
    const float* w = skin.weights[i].data();
    const float* b[4];
    for (std::size_t k = 0; k < 4; ++k) b[k] = rows[skin.bones[i][k]].m;
    float m[12];
    for (int e = 0; e < 12; ++e)
      m[e] = w[0] * b[0][e] + w[1] * b[1][e] + w[2] * b[2][e] + w[3] * b[3][e];
    const float* X = &skin.positions[3 * i];
    const float* N = &skin.normals[3 * i];
    float p[3], n[3];
    for (int r = 0; r < 3; ++r) {
      p[r] = m[4 * r] * X[0] + m[4 * r + 1] * X[1] + m[4 * r + 2] * X[2] + m[4 * r + 3];
      n[r] = m[4 * r] * N[0] + m[4 * r + 1] * N[1] + m[4 * r + 2] * N[2];
    }
    write_vertex(&out.positions[4 * i], &out.normals[4 * i], p, n);
  }
}

void deform_dual_quaternion(const BlendSkin& skin, std::span<const Transform> bones,
                            SkinFrame& out) {
  prepare(skin, bones, out);
  std::vector<DualQuat> duals(bones.size());
  for (std::size_t b = 0; b < bones.size(); ++b) duals[b] = to_dual(bones[b]);
  for (std::size_t i = 0; i < skin.bones.size(); ++i) {
    const DualQuat& first = duals[skin.bones[i][0]];
    Eigen::Vector4f r = Eigen::Vector4f::Zero(), d = Eigen::Vector4f::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const DualQuat& q = duals[skin.bones[i][k]];
      const Eigen::Map<const Eigen::Vector4f> qr(q.r), qd(q.d);
      const float w = qr.dot(Eigen::Map<const Eigen::Vector4f>(first.r)) < 0 ? -skin.weights[i][k]
                                                                             : skin.weights[i][k];
      r += w * qr;
      d += w * qd;
    }
    const float scale = 1.0f / r.norm();
    const Eigen::Quaternionf q(r[0] * scale, r[1] * scale, r[2] * scale, r[3] * scale);
    const Eigen::Quaternionf dual(d[0] * scale, d[1] * scale, d[2] * scale, d[3] * scale);
    const Eigen::Vector3f p = q * Eigen::Map<const Eigen::Vector3f>(&skin.positions[3 * i]) +
                              2 * (dual * q.conjugate()).vec();
    const Eigen::Vector3f n = q * Eigen::Map<const Eigen::Vector3f>(&skin.normals[3 * i]);
    write_vertex(&out.positions[4 * i], &out.normals[4 * i], p.data(), n.data());
  }
}

}  // namespace ecorche::inline v1
