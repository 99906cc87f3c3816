#include "morph/placement/bone_warp.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/smooth_step.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kEnd = 0.16;  // of the length: the joint's end, scaled evenly
// of the length: the share that a joint surface's tilt fades out over
constexpr double kTilted = 0.3;
constexpr double kRamp = 0.14;  // of the length: from the end's scale to the shaft's

// Integral from 0 of a slope that is 1 up to kEnd, falls smoothly to 0 over kRamp and stays there.
double end_share(double t) {
  if (t <= kEnd) return t;
  if (t >= kEnd + kRamp) return kEnd + kRamp / 2;
  const double u = (t - kEnd) / kRamp;
  return kEnd + kRamp * (u - u * u * u + u * u * u * u / 2);
}

// Position along the long axis: slope `end` at both ends, such that 0 -> 0 and 1 -> total.
double along(double t, double end, double total) {
  const double share = 2 * end_share(1);
  const double middle = (total - end * share) / (1 - share);
  const double near = end_share(t), far = end_share(1) - end_share(1 - t);
  return end * (near + far) + middle * (t - near - far);
}

}  // namespace

Vec3 BoneMap::operator()(const Vec3& x) const {
  const Vec3 u = frame.transpose() * (x - origin);
  const double t = length > 0 ? u.y() / length : 0.5;
  const double c = std::clamp(t, -0.3, 1.3) - 0.5;
  const double bend = t > 0 && t < 1 ? 16 * t * t * (1 - t) * (1 - t) : 0;
  const double wx =
      std::exp(shape[log_width_x] + shape[taper_x] * c + shape[flare_x] * (4 * c * c - 1.0 / 3));
  const double wz =
      std::exp(shape[log_width_z] + shape[taper_z] * c + shape[flare_z] * (4 * c * c - 1.0 / 3));
  const double scale = std::exp(shape[log_length]);
  Vec3 v;
  v.x() = wx * u.x() + shape[bow_x] * bend;
  v.z() = wz * u.z() + shape[bow_z] * bend + shape[shear_z] * c;
  if (shape[tuck_z] != 0)
    v.z() -= shape[tuck_z] * smooth_step(1.4 - 2.2 * t) * smooth_step(u.z() / depth);
  v.y() = shaft
              ? length * along(t, std::exp(0.5 * (shape[log_width_x] + shape[log_width_z])), scale)
              : scale * u.y();
  v.y() += u.x() * (shape[tilt_near] * smooth_step(1 - t / kTilted) +
                    shape[tilt_far] * smooth_step(1 - (1 - t) / kTilted));
  return target_origin + target_frame * v;
}

void BoneMap::move(Way way, double step) {
  if (way <= shift_z) {
    target_origin[way] += step;
  } else if (way <= turn_z) {
    target_frame = (Eigen::AngleAxisd(step, Vec3::Unit(way - turn_x)) * target_frame).eval();
  } else {
    shape[way] += step;
  }
}

Vec3 derivative(const BoneMap& map, BoneMap::Way way, const Vec3& x) {
  if (way <= BoneMap::shift_z) return Vec3::Unit(way);
  if (way <= BoneMap::turn_z)
    return Vec3::Unit(way - BoneMap::turn_x).cross(map(x) - map.target_origin);
  constexpr double kStep = 1e-5;
  BoneMap low = map, high = map;
  low.shape[way] -= kStep;
  high.shape[way] += kStep;
  return (high(x) - low(x)) / (2 * kStep);
}

}  // namespace ecorche::inline v1
