#include "viewer/follow_camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "anatomy/compute/smooth_step.h"
#include "viewer/camera.h"

namespace ecorche {
namespace {

float ease(double t) { return float(smooth_step(t)); }

// Gaussian weights for shifts of 0 .. reach; they sum to 1 over -reach .. reach.
std::vector<float> gaussian_weights(double sigma_frames) {
  const int reach = std::ceil(3 * sigma_frames);
  std::vector<float> weights(reach + 1, 1);
  float sum = 1;
  for (int k = 1; k <= reach; ++k) {
    weights[k] = std::exp(float(-0.5 * k * k / (sigma_frames * sigma_frames)));
    sum += 2 * weights[k];
  }
  for (float& w : weights) w /= sum;
  return weights;
}

// The path is reflected about its first and last points, so that the camera does not lag there.
std::vector<Vec3f> smooth_path(const std::vector<Vec3f>& path, const std::vector<float>& weights) {
  const int n = int(path.size()), reach = int(weights.size()) - 1;
  auto at = [&](int f) -> Vec3f {
    if (f < 0) return 2 * path[0] - path[std::min(-f, n - 1)];
    if (f >= n) return 2 * path[n - 1] - path[std::max(2 * (n - 1) - f, 0)];
    return path[f];
  };
  std::vector<Vec3f> out(path.size(), Vec3f::Zero());
  for (int f = 0; f < n; ++f)
    for (int k = -reach; k <= reach; ++k) out[f] += weights[std::abs(k)] * at(f + k);
  return out;
}

// Smooth upper bound of `values`: the weighted mean of a running maximum over the same window.
std::vector<float> smooth_above(const std::vector<float>& values,
                                const std::vector<float>& weights) {
  const int n = int(values.size()), reach = int(weights.size()) - 1;
  std::vector<float> largest(values.size()), out(values.size(), 0);
  for (int f = 0; f < n; ++f)
    largest[f] = *std::max_element(values.begin() + std::max(f - reach, 0),
                                   values.begin() + std::min(f + reach + 1, n));
  for (int f = 0; f < n; ++f)
    for (int k = -reach; k <= reach; ++k)
      out[f] += weights[std::abs(k)] * largest[std::clamp(f + k, 0, n - 1)];
  return out;
}

Vec3f middle(const std::vector<Vec3f>& points) {
  Eigen::AlignedBox3f box;
  for (const Vec3f& p : points) box.extend(p);
  return box.center();
}

}  // namespace

std::vector<Camera> follow(std::span<const std::vector<Vec3f>> figures, double fps,
                           const FollowCamera& options) {
  const int n = figures.size();
  std::vector<Camera> cameras(n);
  if (n == 0) return cameras;
  const std::vector<float> weights = gaussian_weights(std::max(1e-3, options.smoothing * fps));
  std::vector<Vec3f> path;
  for (const auto& points : figures) path.push_back(middle(points));
  path = smooth_path(path, weights);

  std::vector<Vec3f> directions;
  std::vector<float> distances;
  for (int f = 0; f < n; ++f) {
    // The lead grows with speed up to 1 m/s, and is 0 when the figure stands.
    const int before = std::max(f - 1, 0), after = std::min(f + 1, n - 1);
    Vec3f speed = (path[after] - path[before]) * float(fps) / float(std::max(1, after - before));
    speed.y() = 0;
    Camera& camera = cameras[f];
    camera.target = path[f] + float(options.lead) * speed / std::max(1.0f, speed.norm());
    const double share = n > 1 ? double(f) / (n - 1) : 0;
    const float turn =
        ease((share - options.turn_begin) / std::max(1e-9, options.turn_end - options.turn_begin));
    const float azimuth =
        options.begin_azimuth + turn * (options.end_azimuth - options.begin_azimuth);
    directions.push_back(away_from({azimuth, options.elevation}));
    distances.push_back(distance_to_see(figures[f], camera.target, directions[f], options.fov_y,
                                        options.aspect, options.margin));
  }
  distances = smooth_above(distances, weights);
  for (int f = 0; f < n; ++f) {
    Camera& camera = cameras[f];
    camera.eye = camera.target + distances[f] * directions[f];
    camera.eye.y() = std::max(camera.eye.y(), 0.3f);
    camera.fov_y = options.fov_y;
    camera.near_plane = 0.3f;
    camera.far_plane = 200;
  }
  return cameras;
}

}  // namespace ecorche
