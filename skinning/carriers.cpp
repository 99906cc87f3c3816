#include "skinning/carriers.h"

#include <cmath>

namespace ecorche {
namespace {

void write_columns(const Mat3& R, const Vec3& t, float* out) {
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) out[4 * c + r] = static_cast<float>(R(r, c));
    out[4 * c + 3] = 0;
  }
  for (int r = 0; r < 3; ++r) out[12 + r] = static_cast<float>(t[r]);
  out[15] = 0;
}

// Half-way rotation by the shorter arc.
Mat3 half_way(const Quat& a, const Quat& b) {
  Quat h;
  h.coeffs() = a.coeffs() + (a.dot(b) < 0 ? -1.0 : 1.0) * b.coeffs();
  const double n = h.norm();
  if (n < 1e-9) return a.toRotationMatrix();
  h.coeffs() /= n;
  return h.toRotationMatrix();
}

// The part of a rotation that is left when its turn about `axis` is taken out: local = result * turn.
Quat without_twist(const Quat& local, const Vec3& axis) {
  const double along = local.vec().dot(axis);
  const double n = std::hypot(local.w(), along);
  if (n < 1e-9) return local;
  const Quat turn(local.w() / n, axis.x() * along / n, axis.y() * along / n, axis.z() * along / n);
  return local * turn.conjugate();
}

}  // namespace

int carrier_count(const SkinTables& tables) {
  return tables.joint_count + static_cast<int>(tables.twists.size() + tables.pairs.size());
}

void pose_carriers(const SkinTables& tables, std::span<const Transform> X_WJ, std::vector<Transform>& frames, std::vector<Quat>& turns,
                   std::vector<float>& out) {
  const std::size_t joints = static_cast<std::size_t>(tables.joint_count);
  frames.resize(joints + tables.twists.size());
  out.resize(16 * static_cast<std::size_t>(carrier_count(tables)));
  const Vec3 rest_root = tables.origins[0], root = X_WJ[0].translation();
  for (std::size_t j = 0; j < joints; ++j) {
    const Mat3 R = X_WJ[j].linear();
    frames[j].linear() = R;
    frames[j].translation() = X_WJ[j].translation() - root - R * (tables.origins[j] - rest_root);
  }
  for (std::size_t k = 0; k < tables.twists.size(); ++k) {
    const TwistCarrier& twist = tables.twists[k];
    const std::size_t j = static_cast<std::size_t>(twist.joint);
    const Mat3 parent = X_WJ[static_cast<std::size_t>(twist.parent)].linear();
    const Quat local(Mat3(parent.transpose() * X_WJ[j].linear()));
    const Mat3 R = parent * without_twist(local, twist.axis).toRotationMatrix();
    frames[joints + k].linear() = R;
    frames[joints + k].translation() = X_WJ[j].translation() - root - R * (tables.origins[j] - rest_root);
  }
  turns.resize(frames.size());
  for (std::size_t c = 0; c < frames.size(); ++c) {
    write_columns(frames[c].linear(), frames[c].translation(), &out[16 * c]);
    turns[c] = Quat(Mat3(frames[c].linear()));
  }
  for (std::size_t k = 0; k < tables.pairs.size(); ++k) {
    const PairCarrier& pair = tables.pairs[k];
    const Transform& A = frames[static_cast<std::size_t>(pair.a)];
    const Transform& B = frames[static_cast<std::size_t>(pair.b)];
    const Vec3 center = pair.center - rest_root;
    const Mat3 H = half_way(turns[static_cast<std::size_t>(pair.a)], turns[static_cast<std::size_t>(pair.b)]);
    const Vec3 t = 0.5 * (A * center + B * center) - H * center;
    write_columns(2 * H - (A.linear() + B.linear()), 2 * t - (A.translation() + B.translation()), &out[16 * (frames.size() + k)]);
  }
}

}  // namespace ecorche
