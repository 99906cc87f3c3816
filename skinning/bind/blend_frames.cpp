#include "skinning/bind/blend_frames.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kPairs = 128;  // a task

void write_columns(const Mat3& R, const Vec3& t, float* out) {
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) out[4 * c + r] = float(R(r, c));
    out[4 * c + 3] = 0;
  }
  for (int r = 0; r < 3; ++r) out[12 + r] = float(t[r]);
  out[15] = 0;
}

// Half-way rotation, in the sense in which the chain of joints has turned.
Mat3 half_way(const Quat& a, const Quat& b) {
  Quat h;
  h.coeffs() = a.coeffs() + b.coeffs();
  const double n = h.norm();
  if (n < 1e-9) return a.toRotationMatrix();
  h.coeffs() /= n;
  return h.toRotationMatrix();
}

// local = swing * twist, the twist about `axis`; both by the shorter arc, which their product need
// not be.
struct SwingTwist {
  Quat swing, twist;
};

SwingTwist split(const Quat& local, const Vec3& axis) {
  SwingTwist out{local, Quat::Identity()};
  const double along = local.vec().dot(axis), n = std::hypot(local.w(), along);
  if (n > 1e-9) {
    const double sign = local.w() < 0 ? -1 : 1;
    out.twist = Quat(sign * local.w() / n, sign * axis.x() * along / n, sign * axis.y() * along / n,
                     sign * axis.z() * along / n);
    out.swing = local * out.twist.conjugate();
  }
  if (out.swing.w() < 0) out.swing.coeffs() *= -1;
  return out;
}

}  // namespace

void chain_rotations(const FrameTables& tables, std::span<const Transform> X_WJ,
                     std::vector<Quat>& rotations) {
  const std::size_t joints = tables.joint_count();
  rotations.resize(std::size_t(tables.first_pair()));
  for (std::size_t j = 0; j < joints; ++j) {
    const int parent = tables.parents[j];
    const Mat3 R = X_WJ[j].linear();
    if (parent < 0) {
      rotations[j] = Quat(R);
      continue;
    }
    const std::size_t p = parent;
    const SwingTwist local =
        split(Quat(Mat3(X_WJ[p].linear().transpose() * R)), tables.long_axes[j]);
    rotations[j] = rotations[p] * (local.swing * local.twist);
  }
  for (std::size_t k = 0; k < tables.twists.size(); ++k) {
    const TwistFrame& twist = tables.twists[k];
    const std::size_t p = twist.parent;
    const Mat3 local = X_WJ[p].linear().transpose() * X_WJ[twist.joint].linear();
    rotations[joints + k] = rotations[p] * split(Quat(local), twist.axis).swing;
  }
  for (std::size_t k = 0; k < tables.slides.size(); ++k)
    rotations[std::size_t(tables.first_slide()) + k] =
        rotations[std::size_t(tables.slides[k].limb)];
}

void pose_blend_frames(const FrameTables& tables, std::span<const Transform> X_WJ,
                       FrameWorkspace& frames) {
  const std::size_t joints = tables.joint_count();
  frames.joints.resize(std::size_t(tables.first_pair()));
  frames.maps.resize(16 * std::size_t(tables.frame_count()));
  chain_rotations(tables, X_WJ, frames.rotations);
  const Vec3 rest_root = tables.origins[0], root = X_WJ[0].translation();
  for (std::size_t j = 0; j < joints; ++j) {
    const Mat3 R = X_WJ[j].linear();
    frames.joints[j].linear() = R;
    frames.joints[j].translation() =
        X_WJ[j].translation() - root - R * (tables.origins[j] - rest_root);
  }
  for (std::size_t k = 0; k < tables.twists.size(); ++k) {
    const TwistFrame& twist = tables.twists[k];
    const std::size_t j = twist.joint;
    const Mat3 R = frames.rotations[joints + k].toRotationMatrix();
    frames.joints[joints + k].linear() = R;
    frames.joints[joints + k].translation() =
        X_WJ[j].translation() - root - R * (tables.origins[j] - rest_root);
  }
  for (std::size_t k = 0; k < tables.slides.size(); ++k) {
    const SlideFrame& slide = tables.slides[k];
    const Transform& limb = frames.joints[std::size_t(slide.limb)];
    const Transform& carrier = frames.joints[std::size_t(slide.carrier)];
    const Vec3 axis = limb.linear() * slide.axis;
    const Mat3 along = axis * axis.transpose();
    Transform& out = frames.joints[std::size_t(tables.first_slide()) + k];
    out.linear() = limb.linear() + along * (carrier.linear() - limb.linear());
    out.translation() = limb.translation() + along * (carrier.translation() - limb.translation());
  }
  for (std::size_t c = 0; c < frames.joints.size(); ++c)
    write_columns(frames.joints[c].linear(), frames.joints[c].translation(), &frames.maps[16 * c]);
  const auto pose_pair = [&](std::size_t k) {
    const FramePair& pair = tables.pairs[k];
    const Transform& A = frames.joints[pair.a];
    const Transform& B = frames.joints[pair.b];
    const Vec3 center = pair.center - rest_root;
    const Mat3 H = half_way(frames.rotations[pair.a], frames.rotations[pair.b]);
    const Vec3 t = 0.5 * (A * center + B * center) - H * center;
    write_columns(2 * H - (A.linear() + B.linear()), 2 * t - (A.translation() + B.translation()),
                  &frames.maps[16 * (frames.joints.size() + k)]);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tables.pairs.size(), kPairs),
                    [&](const auto& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) pose_pair(k);
                    });
}

}  // namespace ecorche::inline v1
