#include "skinning/motion/sample_motion.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace ecorche::inline v1 {

namespace {

// The frames about a place on the curve, and what each of them weighs there.
struct CurvePlace {
  std::array<std::size_t, 4> frames{};
  std::array<double, 4> weights{};
  bool whole = false;  // on the second of them

  CurvePlace(std::size_t count, double frame) {
    const std::size_t last = count - 1;
    const double at = std::clamp(frame, 0.0, double(last));
    const std::size_t f = std::min(std::size_t(at), last);
    const double t = at - double(f);
    whole = t <= 0;
    frames = {f > 0 ? f - 1 : 0, f, std::min(f + 1, last), std::min(f + 2, last)};
    // A uniform cubic B-spline would miss the frames; Catmull and Rom's goes through them.
    weights = {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t),
               t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
  }

  template <class Value>
  Value mean(const Value& before, const Value& a, const Value& b, const Value& after) const {
    return weights[0] * before + weights[1] * a + weights[2] * b + weights[3] * after;
  }
};

}  // namespace

void pose_at(const Motion& motion, double time, Pose& out) {
  pose_at_frame(motion, time * motion.fps, out);
}

void pose_at_frame(const Motion& motion, double frame, Pose& out) {
  const CurvePlace at(motion.frames.size(), frame);
  const std::vector<Pose>& poses = motion.frames;
  if (at.whole) {
    out = poses[at.frames[1]];
    return;
  }
  const auto [before, a, b, after] = at.frames;
  out.root = at.mean(poses[before].root, poses[a].root, poses[b].root, poses[after].root);
  out.rotations.resize(poses[a].rotations.size());
  for (std::size_t j = 0; j < out.rotations.size(); ++j) {
    const Eigen::Vector4d middle = poses[a].rotations[j].coeffs();
    const auto same_side = [&](std::size_t f) {
      const Quat& q = poses[f].rotations[j];
      return Eigen::Vector4d(q.coeffs().dot(middle) < 0 ? -q.coeffs() : q.coeffs());
    };
    out.rotations[j].coeffs() =
        at.mean(same_side(before), middle, same_side(b), same_side(after)).normalized();
  }
}

Vec3 place_at_frame(std::span<const Vec3> path, double frame) {
  const CurvePlace at(path.size(), frame);
  const auto [before, a, b, after] = at.frames;
  return at.whole ? path[a] : at.mean(path[before], path[a], path[b], path[after]);
}

}  // namespace ecorche::inline v1
