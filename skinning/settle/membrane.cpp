#include "skinning/settle/membrane.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "anatomy/compute/simd_lanes.h"
#include "anatomy/geometry/vertex_normals.h"

namespace ecorche::inline v1 {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr MembraneParameters kParametersMembrane;
constexpr int kBlock = 64;  // eights of vertices a task: independent of the number of threads

double cotan(const Vec3& a, const Vec3& b) { return a.dot(b) / std::max(a.cross(b).norm(), 1e-12); }

Sparse cotangents(const TriMesh& skin) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(6 * skin.F.rows());
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
  for (Eigen::Index i = 0; i < C.nonZeros(); ++i)
    C.valuePtr()[i] = std::clamp(C.valuePtr()[i], kParametersMembrane.least_cotan,
                                 kParametersMembrane.most_cotan);
  return C;
}

Sparse system(const Sparse& C, std::span<const float> stiffness) {
  Sparse diagonal(C.rows(), C.rows());
  diagonal.reserve(Eigen::VectorXi::Constant(C.rows(), 1));
  for (Eigen::Index i = 0; i < C.rows(); ++i) {
    double sum = stiffness[i];
    for (Sparse::InnerIterator it(C, i); it; ++it) sum += it.value();
    diagonal.insert(i, i) = sum;
  }
  Sparse A = -C;
  A += diagonal;
  return A;
}

int eights_of(const Membrane& m) { return int(m.slot_begin.size()) - 1; }

// Component `k` of a vertex's own in what lies component by component.
float& part_of(std::vector<float>& eights, std::size_t components, std::size_t vertex,
               std::size_t k) {
  return eights[8 * components * (vertex / 8) + 8 * k + vertex % 8];
}

// Rows: along the normal, across the edge, and the third.
Mat3 frame_of(const Vec3& normal, const Vec3& edge) {
  const Vec3 across = normal.cross(edge);
  if (across.norm() < 1e-12) return Mat3::Identity();
  const Vec3 up = normal.normalized(), along = across.normalized(), third = up.cross(along);
  Mat3 out;
  out << up, along, third;
  return out.transpose();
}

// Rotations that take rest edges to the present ones, from a guess: the sum of r_c . a_c over the
// columns of rotation and matrix is made as large as it can be, by Newton's method for small turns.
// Where that sum is no hill there, the step is the shorter one that always climbs (Mueller et al.
// 2016, 10.1145/2994258.2994269). They cannot end in a reflection.
void step_rotation(const Wide33& A, int steps, Wide4& q) {
  constexpr float kStill = 1e-8f;  // rad^2, of half the angle: the next step would be far smaller
  constexpr float kLeastHill = 0.02f;  // of the sum's cube
  for (int step = 0; step < steps; ++step) {
    const Wide33 R = matrix(q);
    const auto mixed = [&](Float8 Wide3::*r, Float8 Wide3::*a) {
      return R.col[0].*r * A.col[0].*a + R.col[1].*r * A.col[1].*a + R.col[2].*r * A.col[2].*a;
    };
    const Float8 xx = mixed(&Wide3::x, &Wide3::x), yy = mixed(&Wide3::y, &Wide3::y),
                 zz = mixed(&Wide3::z, &Wide3::z);
    const Float8 xy = mixed(&Wide3::x, &Wide3::y), yx = mixed(&Wide3::y, &Wide3::x),
                 xz = mixed(&Wide3::x, &Wide3::z), zx = mixed(&Wide3::z, &Wide3::x),
                 yz = mixed(&Wide3::y, &Wide3::z), zy = mixed(&Wide3::z, &Wide3::y);
    const Wide3 torque{yz - zy, zx - xz, xy - yx};
    const Float8 pull = xx + yy + zz, size = pull < 0 ? -pull : pull;
    // The hill's curvature: symmetric, diagonal a b c, the others d (yz) e (xz) f (xy).
    const Float8 a = yy + zz, b = xx + zz, c = xx + yy, d = -0.5f * (yz + zy),
                 e = -0.5f * (xz + zx), f = -0.5f * (xy + yx);
    const Float8 A0 = b * c - d * d, A1 = d * e - c * f, A2 = d * f - b * e,
                 det = a * A0 + f * A1 + e * A2;
    const auto hill = (a > 0) & (A0 > 0) & (det > kLeastHill * pull * pull * pull) & (pull > 0);
    const Float8 inverse = 0.5f / (hill ? det : all_eight(1)), shorter = 0.5f / (size + 1e-12f);
    const Wide3 newton{A0 * torque.x + A1 * torque.y + A2 * torque.z,
                       A1 * torque.x + (a * c - e * e) * torque.y + (e * f - a * d) * torque.z,
                       A2 * torque.x + (e * f - a * d) * torque.y + (a * b - f * f) * torque.z};
    const Wide3 w{hill ? inverse * newton.x : shorter * torque.x,
                  hill ? inverse * newton.y : shorter * torque.y,
                  hill ? inverse * newton.z : shorter * torque.z};  // half the angle
    const Wide3 u = xyz(q), v = q.w * w + u + cross(w, u);
    q = normalized(Wide4{v.x, v.y, v.z, q.w - dot(w, u)});
    if (lanes_that(dot(w, w) >= kStill) == 0) return;
  }
}

// The rotations that carry rest normal and first edge to the present ones: guesses to start from.
Wide4 guess(const float* rest, const Wide3& n, const Wide3& e) {
  const Wide3 up = normalized(n), along = normalized(cross(n, e)), third = cross(up, along);
  Wide33 R;
  for (int c = 0; c < 3; ++c) {
    const Wide3 row = load3(rest + 24 * c);
    R.col[c] = row.x * up + row.y * along + row.z * third;
  }
  return quaternion(R);
}

template <class Each>
void for_eights(const Membrane& m, const Each& each) {
  const int eights = eights_of(m);
  tbb::parallel_for(0, (eights + kBlock - 1) / kBlock, [&](int block) {
    for (int b = block * kBlock; b < std::min(eights, (block + 1) * kBlock); ++b) each(b);
  });
}

void fit_rotations(const Membrane& m, bool first, MembraneWorkspace& s) {
  for_eights(m, [&](int b) {
    const std::size_t at = 32 * std::size_t(b);
    const Wide3 p = xyz(load_eight(&s.places[at])), n = xyz(load_eight(&s.normals[at]));
    const float* N = &m.normal[24 * b];
    Wide33 A;
    for (int c = 0; c < 3; ++c) A.col[c] = load8(N + 8 * c) * n;
    Wide3 pull{};
    for (int k = m.slot_begin[b]; k < m.slot_begin[b + 1]; ++k) {
      const float* edge = &m.slot_edge[32 * k];
      const Wide3 way = p - xyz(gather_eight(s.places.data(), &m.slot[8 * k]));
      for (int c = 0; c < 3; ++c) A.col[c] = A.col[c] + load8(edge + 8 * c) * way;
      if (first) pull = pull + load8(edge + 24) * way;
    }
    Wide4 q;
    if (first) {
      float* out = &s.pull[24 * b];
      store8(out, pull.x);
      store8(out + 8, pull.y);
      store8(out + 16, pull.z);
      const Wide3 e = p - xyz(gather_eight(s.places.data(), &m.guide[8 * b]));
      q = guess(&m.frame[72 * b], n, e);
    } else {
      q = load_eight(&s.rotations[at]);
    }
    step_rotation(
        A, first ? kParametersMembrane.first_rotation_steps : kParametersMembrane.rotation_steps,
        q);
    store_eight(&s.rotations[at], q);
  });
}

// W (t - a) + sum c ((R_i + R_j)/2 E - (a_i - a_j)), to the factor's order. Where the sheet has
// slipped along its anchors, it is let stay: t.
void right_side(const Membrane& m, MembraneWorkspace& s) {
  for_eights(m, [&](int b) {
    const std::size_t at = 32 * std::size_t(b);
    const Wide3 n = xyz(load_eight(&s.normals[at])), gone = xyz(load_eight(&s.offsets[at])),
                along = gone - dot(gone, n) * n;
    const Float8 length = root(dot(along, along)), most = load8(&m.slip[8 * b]);
    const Wide3 target = (length > most ? most / length : all_eight(1)) * along;
    Wide3 turned = rotate(load_eight(&s.rotations[at]), load3(&m.edges[24 * b]));
    for (int k = m.slot_begin[b]; k < m.slot_begin[b + 1]; ++k)
      turned = turned + rotate(gather_eight(s.rotations.data(), &m.slot[8 * k]),
                               load3(&m.slot_edge[32 * k]));
    const Wide3 sum =
        load8(&m.stiffness[8 * b]) * target + all_eight(0.5f) * turned - load3(&s.pull[24 * b]);
    each_row(Wide4{sum.x, sum.y, sum.z, Float8{}}, [&](int lane, Float4 row) {
      const int vertex = 8 * b + lane;
      if (vertex < m.vertex_count) store4(&s.right[4 * m.factor.place[vertex]], row);
    });
  });
}

void lay_out_eights(const Sparse& C, const TriMesh& skin, Membrane& out) {
  for (int begin = 0; begin < out.vertex_count; begin += 8) {
    out.slot_begin.push_back(int(out.slot.size() / 8));
    int most = 0;
    const int end = std::min(out.vertex_count, begin + 8);
    for (int i = begin; i < end; ++i) most = std::max(most, out.first[i + 1] - out.first[i]);
    for (int k = 0; k < most; ++k) {
      const std::size_t slot = out.slot.size() / 8;
      out.slot_edge.resize(out.slot_edge.size() + 32, 0.0f);
      for (int i = begin; i < begin + 8; ++i) {
        out.slot.push_back(i);
        const int at = i < end ? out.first[i] + k : 0;
        if (i >= end || at >= out.first[i + 1]) continue;
        const int j = out.slot.back() = out.neighbour[at];
        const double c = C.coeff(i, j);
        const Vec3 e = c * (skin.V.row(i) - skin.V.row(j)).transpose();
        for (std::size_t x = 0; x < 3; ++x) {
          out.slot_edge[32 * slot + 8 * x + (i - begin)] = float(e[x]);
          part_of(out.edges, 3, std::size_t(i), x) += float(e[x]);
        }
        out.slot_edge[32 * slot + 24 + (i - begin)] = float(c);
      }
    }
  }
  out.slot_begin.push_back(int(out.slot.size() / 8));
}

}  // namespace

Membrane make_membrane(const TriMesh& skin, std::span<const double> looseness) {
  Membrane out;
  out.vertex_count = skin.V.rows();
  const std::size_t n = looseness.size(), padded = (n + 7) / 8 * 8;
  const Sparse C = cotangents(skin);
  std::vector<float> positions, normals(4 * n);
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i)
    for (int k = 0; k < 4; ++k) positions.push_back(k < 3 ? float(skin.V(i, k)) : 1);
  vertex_normals(positions, std::span(skin.F.data(), std::size_t(skin.F.size())), normals);
  out.normal.resize(3 * padded);
  out.edges.resize(3 * padded);
  out.frame.resize(9 * padded);
  out.stiffness.resize(padded);
  out.slip.resize(padded);
  out.guide.resize(padded);
  out.first.push_back(0);
  for (std::size_t i = 0; i < n; ++i) {
    double spread = 0;
    Vec3 first_edge = Vec3::Zero();
    out.guide[i] = int(i);
    for (Sparse::InnerIterator it(C, Eigen::Index(i)); it; ++it) {
      const Vec3 e = (skin.V.row(i) - skin.V.row(it.row())).transpose();
      if (out.first.back() == int(out.neighbour.size())) {
        first_edge = e;
        out.guide[i] = int(it.row());
      }
      out.neighbour.push_back(int(it.row()));
      spread += 0.5 * it.value() * e.squaredNorm();
    }
    out.first.push_back(int(out.neighbour.size()));
    const Vec3 normal(normals[4 * i], normals[4 * i + 1], normals[4 * i + 2]);
    const Mat3 frame = frame_of(normal, first_edge);
    for (std::size_t k = 0; k < 3; ++k) part_of(out.normal, 3, i, k) = float(spread * normal[k]);
    for (std::size_t k = 0; k < 9; ++k) part_of(out.frame, 9, i, k) = float(frame.data()[k]);
    const double depth = looseness[i] / kParametersMembrane.half_depth;
    out.stiffness[i] = float(std::max(kParametersMembrane.least_stiffness,
                                      kParametersMembrane.stiffness / (1 + depth * depth)));
    out.slip[i] = float(
        std::min(kParametersMembrane.most_slip, kParametersMembrane.slip_fraction * looseness[i]));
  }
  for (std::size_t i = n; i < padded; ++i) out.guide[i] = int(i);
  lay_out_eights(C, skin, out);
  out.factor = factor_supernodal(system(C, out.stiffness));
  return out;
}

void relax_membrane(const Membrane& m, std::span<const int> triangles, std::span<float> positions,
                    MembraneWorkspace& s) {
  const std::size_t size = 4 * std::size_t(m.vertex_count), padded = 32 * std::size_t(eights_of(m));
  for (std::vector<float>* each : {&s.rotations, &s.offsets, &s.normals, &s.places})
    each->resize(padded);
  s.pull.resize(padded / 4 * 3);
  s.right.resize(4 * work_rows(m.factor));
  std::fill(s.offsets.begin(), s.offsets.end(), 0.0f);
  std::copy(positions.begin(), positions.end(), s.places.begin());
  for (int round = 0; round < kParametersMembrane.rounds; ++round) {
    vertex_normals(s.places, triangles, s.normals, s.half);
    fit_rotations(m, round == 0, s);
    right_side(m, s);
    solve_supernodal(m.factor, s.right.data());
    for_eights(m, [&](int b) {
      for (std::size_t i = 8 * std::size_t(b); i < std::min(size / 4, 8 * std::size_t(b) + 8);
           ++i) {
        const Float4 before = load4(&s.offsets[4 * i]);
        const Float4 offset = before + kParametersMembrane.over_relaxation *
                                           (load4(&s.right[4 * m.factor.place[i]]) - before);
        store4(&s.offsets[4 * i], offset);
        store4(&s.places[4 * i], load4(&positions[4 * i]) + offset);
      }
    });
  }
  for (std::size_t k = 0; k < positions.size(); k += 4)
    store4(&positions[k], load4(&positions[k]) + load4(&s.offsets[k]));
}

}  // namespace ecorche::inline v1
