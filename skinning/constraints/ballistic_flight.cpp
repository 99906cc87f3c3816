#include "skinning/constraints/ballistic_flight.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/smooth_step.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/motion/center_of_mass.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTouching = 0.020;             // m; a lower foot is on the ground
constexpr double kEdge = 0.15;                  // of a flight, at its beginning and its end
constexpr double kShortest = 0.08;              // s; shorter flights are left as they are
constexpr double kWeak = 0.51, kStrong = 1.53;  // of gravity, fitted, that is taken for a fall
// m; largest distance from the fitted parabola, beside 5 % of its height: the mass distribution
// differs from that of the source.
constexpr double kRough = 0.02;
// Beyond these bounds, by parts of them, less and less is corrected, so that a flight at a bound
// does not leap for a trifle.
constexpr double kShortEase = 0.25, kPullEase = 0.1, kRoughEase = 0.5;

// Least-squares fall over frames [begin, end): gravity and the largest distance from the parabola.
std::pair<double, double> fitted_fall(const std::vector<Vec3>& path, int begin, int end,
                                      double fps) {
  Eigen::MatrixXd A(end - begin, 3);
  Eigen::VectorXd y(end - begin);
  for (int f = begin; f < end; ++f) {
    const double t = (f - begin) / fps;
    A.row(f - begin) << 1, t, t * t;
    y[f - begin] = path[f].y();
  }
  const Eigen::Vector3d c = (A.transpose() * A).ldlt().solve(A.transpose() * y);
  return {-2 * c[2], (A * c - y).cwiseAbs().maxCoeff()};
}

}  // namespace

std::vector<Flight> make_flights_ballistic(const Skeleton& skeleton, double sole_height,
                                           double gravity, Motion& motion) {
  std::vector<Flight> flights;
  const int frames = motion.frames.size();
  const CenterOfMass center(skeleton);
  const FootShape left = foot_shape(skeleton, Side::left, sole_height),
                  right = foot_shape(skeleton, Side::right, sole_height);
  std::vector<double> lowest;  // point of the soles
  std::vector<Vec3> path;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    path.push_back(center(X));
    double low = HUGE_VAL;
    for (const FootShape* foot : {&left, &right}) {
      const FootPoints p = foot_points(skeleton, *foot, X);
      low = std::min({low, p.heel.y(), p.ball.y(), p.tip.y()});
    }
    lowest.push_back(low);
  }
  auto standing = [&](int f) { return lowest[f] < kTouching; };
  for (int begin = 1; begin < frames; ++begin) {
    if (standing(begin) || !standing(begin - 1)) continue;
    int end = begin;
    while (end < frames && !standing(end)) ++end;
    const double shortest = std::max(4.0, kShortest * motion.fps);
    if (end == frames || end - begin < (1 - kShortEase) * shortest) continue;
    const double sagitta = gravity * (end - begin) * (end - begin) / (8 * motion.fps * motion.fps);
    // Feet that leave the ground or meet it still push: the middle tells whether it is a fall.
    const int edge = int(std::lround(kEdge * (end - begin)));
    const double before = fitted_fall(path, begin + edge, end - edge, motion.fps).first,
                 rough = fitted_fall(path, begin, end, motion.fps).second;
    const double pull = before / gravity, roughest = kRough + 0.05 * sagitta;
    double share = smooth_step((1 - kShortEase) * shortest, shortest, end - begin) *
                   smooth_step((1 - kPullEase) * kWeak, kWeak, pull) *
                   (1 - smooth_step(kStrong, (1 + kPullEase) * kStrong, pull)) *
                   (1 - smooth_step(roughest, (1 + kRoughEase) * roughest, rough));
    if (share <= 0) continue;
    const int first = begin - 1;
    const double span = (end - first) / motion.fps;
    const Vec3 from = path[first],
               speed = (path[end] - from) / span + Vec3(0, 0.5 * gravity * span, 0);
    auto fall = [&](int f) {
      const double t = (f - first) / motion.fps;
      return Vec3(from + t * speed - Vec3(0, 0.5 * gravity * t * t, 0) - path[f]);
    };
    // Where soles would sink, something else than feet held the body, or feet did after all.
    for (int f = begin; f < end; ++f)
      if (const double sinks = -share * fall(f).y(); sinks > lowest[f])
        share *= std::max(0.0, lowest[f] / sinks);
    for (int f = begin; f < end; ++f) motion.frames[f].root += share * fall(f);
    if (share == 1) flights.push_back({begin, end, before});
  }
  return flights;
}

}  // namespace ecorche::inline v1
