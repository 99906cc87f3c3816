#include "skinning/motion/sample_motion.h"

#include <algorithm>

namespace ecorche::inline v1 {

void pose_at(const Motion& motion, double time, Pose& out) {
  pose_at_frame(motion, time * motion.fps, out);
}

void pose_at_frame(const Motion& motion, double frame, Pose& out) {
  const double at = std::clamp(frame, 0.0, double(motion.frames.size() - 1));
  const std::size_t last = motion.frames.size() - 1, f = std::min(std::size_t(at), last);
  const double t = at - double(f);
  const Pose& a = motion.frames[f];
  if (t <= 0) {
    out = a;
    return;
  }
  const Pose& before = motion.frames[f > 0 ? f - 1 : 0];
  const Pose& b = motion.frames[f + 1];
  const Pose& after = motion.frames[std::min(f + 2, last)];
  // A uniform cubic B-spline would miss the frames; Catmull and Rom's goes through them.
  const double w0 = t * (-0.5 + t * (1 - 0.5 * t)), w1 = 1 + t * t * (-2.5 + 1.5 * t),
               w2 = t * (0.5 + t * (2 - 1.5 * t)), w3 = t * t * (-0.5 + 0.5 * t);
  out.root = w0 * before.root + w1 * a.root + w2 * b.root + w3 * after.root;
  out.rotations.resize(a.rotations.size());
  for (std::size_t j = 0; j < a.rotations.size(); ++j) {
    const Eigen::Vector4d middle = a.rotations[j].coeffs();
    const auto same_side = [&](const Quat& q) {
      return Eigen::Vector4d(q.coeffs().dot(middle) < 0 ? -q.coeffs() : q.coeffs());
    };
    const Eigen::Vector4d sum = w0 * same_side(before.rotations[j]) + w1 * middle +
                                w2 * same_side(b.rotations[j]) + w3 * same_side(after.rotations[j]);
    out.rotations[j].coeffs() = sum.normalized();
  }
}

}  // namespace ecorche::inline v1
