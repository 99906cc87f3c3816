#include "skinning/membrane.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>
#include <tbb/parallel_for.h>

#include "skinning/float4.h"
#include "skinning/normals.h"

namespace ecorche {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kLeastCotan = 0.05, kMostCotan = 5;
constexpr double kHold = 1, kHoldDepth = 0.012, kLeastHold = 0.06;  // beside cotangents of about 0.6; m
constexpr double kGlideShare = 0.25, kMostGlide = 0.012;            // of the tissue's thickness; m
constexpr int kBlock = 512;  // vertices a task: tasks do not depend on the number of threads

double cotan(const Vec3& a, const Vec3& b) { return a.dot(b) / std::max(a.cross(b).norm(), 1e-12); }

Sparse cotangents(const TriMesh& skin) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(6 * skin.F.rows()));
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int i = skin.F(f, (k + 1) % 3), j = skin.F(f, (k + 2) % 3);
      const Vec3 o = skin.V.row(skin.F(f, k));
      const double w = 0.5 * cotan(Vec3(skin.V.row(i)) - o, Vec3(skin.V.row(j)) - o);
      entries.emplace_back(i, j, w);
      entries.emplace_back(j, i, w);
    }
  Sparse C(skin.V.rows(), skin.V.rows());
  C.setFromTriplets(entries.begin(), entries.end());
  for (Eigen::Index i = 0; i < C.nonZeros(); ++i) C.valuePtr()[i] = std::clamp(C.valuePtr()[i], kLeastCotan, kMostCotan);
  return C;
}

void factor(const Sparse& C, Membrane& out) {
  const Eigen::Index n = C.rows();
  Sparse A = -C;
  Sparse diagonal(n, n);
  diagonal.reserve(Eigen::VectorXi::Constant(n, 1));
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = out.hold[static_cast<std::size_t>(i)];
    for (Sparse::InnerIterator it(C, i); it; ++it) sum += it.value();
    diagonal.insert(i, i) = sum;
  }
  A += diagonal;
  const Eigen::SimplicialLDLT<Sparse> solver(A);
  const auto lower = solver.matrixL();
  const Sparse& L = lower.nestedExpression();
  out.column.push_back(0);
  for (Eigen::Index c = 0; c < n; ++c) {
    for (Sparse::InnerIterator it(L, c); it; ++it) {
      if (it.row() <= c) continue;
      out.row.push_back(static_cast<int>(it.row()));
      out.value.push_back(static_cast<float>(it.value()));
    }
    out.column.push_back(static_cast<int>(out.row.size()));
    out.inverse_diagonal.push_back(static_cast<float>(1 / solver.vectorD()[c]));
  }
  for (Eigen::Index i = 0; i < n; ++i) out.place.push_back(solver.permutationP().indices()[i]);
}

// x in the factor's order, four floats a row; the last one goes along.
void solve(const Membrane& m, float* x) {
  for (int c = 0; c < m.vertex_count; ++c) {
    const Float4 above = load4(x + 4 * c);
    for (int k = m.column[c]; k < m.column[c + 1]; ++k) {
      float* target = x + 4 * m.row[k];
      store4(target, load4(target) - m.value[k] * above);
    }
  }
  for (int c = m.vertex_count - 1; c >= 0; --c) {
    Float4 sum = load4(x + 4 * c) * m.inverse_diagonal[c];
    for (int k = m.column[c]; k < m.column[c + 1]; ++k) sum -= m.value[k] * load4(x + 4 * m.row[k]);
    store4(x + 4 * c, sum);
  }
}

using Mat3f = Eigen::Matrix3f;

// Rotation that takes rest edges to the present ones, from a guess: turns until no torque is left (Mueller et al. 2016,
// 10.1145/2994258.2994269). It cannot end in a reflection.
void turn_to(const Mat3f& A, int steps, Eigen::Quaternionf& q) {
  for (int step = 0; step < steps; ++step) {
    const Mat3f R = q.toRotationMatrix();
    Eigen::Vector3f torque = Eigen::Vector3f::Zero();
    float pull = 1e-12f;
    for (int k = 0; k < 3; ++k) {
      torque += R.col(k).cross(A.col(k));
      pull += R.col(k).dot(A.col(k));
    }
    const Eigen::Vector3f w = torque / std::abs(pull);
    const float angle = w.norm();
    if (angle < 1e-5f) return;
    const float half = 0.5f * std::min(angle, 2.5f);
    const Eigen::Vector3f v = (std::sin(half) / angle) * w;
    q = (Eigen::Quaternionf(std::cos(half), v.x(), v.y(), v.z()) * q).normalized();
  }
}

// The rotation that carries a vertex's rest normal and first edge to the present ones: a guess to start from.
Eigen::Quaternionf guess(const Eigen::Vector3f& N, const Eigen::Vector3f& E, const Eigen::Vector3f& n, const Eigen::Vector3f& e) {
  const auto frame = [](const Eigen::Vector3f& up, const Eigen::Vector3f& along) {
    Mat3f F;
    F.col(0) = up.normalized();
    F.col(1) = up.cross(along).normalized();
    F.col(2) = F.col(0).cross(F.col(1));
    return F;
  };
  const Mat3f R = frame(n, e) * frame(N, E).transpose();
  return R.allFinite() ? Eigen::Quaternionf(R).normalized() : Eigen::Quaternionf::Identity();
}

Eigen::Vector3f at(std::span<const float> a, int i) { return {a[4 * std::size_t(i)], a[4 * std::size_t(i) + 1], a[4 * std::size_t(i) + 2]}; }

void fit_turns(const Membrane& m, std::span<const float> x, bool first, MembraneScratch& s) {
  tbb::parallel_for(0, (m.vertex_count + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(m.vertex_count, (block + 1) * kBlock); ++i) {
      const Eigen::Vector3f p = at(x, i), n = at(s.normals, i), N = at(m.normal, i);
      Mat3f A = n * N.transpose();
      for (int k = m.first[i]; k < m.first[i + 1]; ++k)
        A.noalias() += (m.edge[4 * std::size_t(k) + 3] * (p - at(x, m.neighbour[k]))) * at(m.edge, k).transpose();
      Eigen::Map<Eigen::Vector4f> q(&s.turns[4 * std::size_t(i)]);
      Eigen::Quaternionf turn(q);
      if (first) {
        const int k = m.first[i];
        turn = k < m.first[i + 1] ? guess(N, at(m.edge, k), n, p - at(x, m.neighbour[k])) : Eigen::Quaternionf::Identity();
      }
      turn_to(A, first ? 8 : 4, turn);
      q = turn.coeffs();
    }
  });
}

Float4 rotate(const float* q, Float4 v) {  // q: x y z w
  const Float4 u{q[0], q[1], q[2], 0};
  const Float4 t = 2.0f * cross(u, v);
  return v + q[3] * t + cross(u, t);
}

// W (t - a) + sum c ((R_i + R_j)/2 E - (a_i - a_j)), to the factor's order.
void right_side(const Membrane& m, std::span<const float> a, MembraneScratch& s) {
  tbb::parallel_for(0, (m.vertex_count + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(m.vertex_count, (block + 1) * kBlock); ++i) {
      Float4 sum = m.hold[i] * load4(&s.targets[4 * std::size_t(i)]);
      const Float4 own = load4(&a[4 * std::size_t(i)]);
      for (int k = m.first[i]; k < m.first[i + 1]; ++k) {
        const std::size_t j = 4 * std::size_t(m.neighbour[k]);
        Float4 e = load4(&m.edge[4 * std::size_t(k)]);
        const float c = e[3];
        e[3] = 0;
        sum += c * (0.5f * (rotate(&s.turns[4 * std::size_t(i)], e) + rotate(&s.turns[j], e)) - (own - load4(&a[j])));
      }
      sum[3] = 0;
      store4(&s.right[4 * std::size_t(m.place[i])], sum);
    }
  });
}

}  // namespace

Membrane make_membrane(const TriMesh& skin, std::span<const double> tissue) {
  Membrane out;
  out.vertex_count = static_cast<int>(skin.V.rows());
  const Sparse C = cotangents(skin);
  std::vector<float> positions, normals(4 * static_cast<std::size_t>(skin.V.rows()));
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i)
    for (int k = 0; k < 4; ++k) positions.push_back(k < 3 ? static_cast<float>(skin.V(i, k)) : 1);
  vertex_normals(positions, std::span(skin.F.data(), static_cast<std::size_t>(skin.F.size())), normals);
  out.first.push_back(0);
  for (int i = 0; i < out.vertex_count; ++i) {
    float spread = 0;
    for (Sparse::InnerIterator it(C, i); it; ++it) {
      const Vec3 e = (skin.V.row(i) - skin.V.row(it.row())).transpose();
      out.neighbour.push_back(static_cast<int>(it.row()));
      for (int k = 0; k < 3; ++k) out.edge.push_back(static_cast<float>(e[k]));
      out.edge.push_back(static_cast<float>(it.value()));
      spread += static_cast<float>(0.5 * it.value() * e.squaredNorm());
    }
    out.first.push_back(static_cast<int>(out.neighbour.size()));
    for (std::size_t k = 0; k < 4; ++k) out.normal.push_back(spread * normals[4 * static_cast<std::size_t>(i) + k]);
    const double depth = tissue[static_cast<std::size_t>(i)] / kHoldDepth;
    out.hold.push_back(static_cast<float>(std::max(kLeastHold, kHold / (1 + depth * depth))));
    out.glide.push_back(static_cast<float>(std::min(kMostGlide, kGlideShare * tissue[static_cast<std::size_t>(i)])));
  }
  factor(C, out);
  return out;
}

void relax_membrane(const Membrane& m, std::span<const float> anchors, std::span<const int> triangles, int rounds, MembraneScratch& s) {
  const std::size_t size = 4 * static_cast<std::size_t>(m.vertex_count);
  for (std::vector<float>* each : {&s.turns, &s.offsets, &s.targets, &s.right, &s.normals, &s.places}) each->resize(size);
  std::fill(s.targets.begin(), s.targets.end(), 0.0f);
  std::fill(s.offsets.begin(), s.offsets.end(), 0.0f);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < size; k += 4) store4(&s.places[k], load4(&anchors[k]) + load4(&s.offsets[k]));
    vertex_normals(s.places, triangles, s.normals);
    if (round > 0)  // where the sheet has glided along its anchors, it is let stay
      for (std::size_t i = 0; i < size / 4; ++i) {
        const Float4 n = load4(&s.normals[4 * i]);
        Float4 t = load4(&s.offsets[4 * i]);
        t -= sum4(t * n) * n;
        const float length = std::sqrt(sum4(t * t)[0]), most = m.glide[i];
        if (length > most) t *= most / length;
        store4(&s.targets[4 * i], t);
      }
    fit_turns(m, s.places, round == 0, s);
    right_side(m, anchors, s);
    solve(m, s.right.data());
    for (std::size_t i = 0; i < size / 4; ++i) store4(&s.offsets[4 * i], load4(&s.right[4 * static_cast<std::size_t>(m.place[i])]));
  }
}

}  // namespace ecorche
