#include "skinning/constraints/ballistic_flight.h"

#include <algorithm>
#include <cmath>

#include "skinning/constraints/foot_contacts.h"
#include "skinning/motion/center_of_mass.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTouching = 0.020;             // m; a lower foot is on the ground
constexpr double kShortest = 0.08;              // s; shorter flights are left as they are
constexpr double kWeak = 0.51, kStrong = 1.53;  // of gravity, fitted, that is taken for a fall
// m; largest distance from the fitted parabola, beside 5 % of its height: the mass distribution
// differs from that of the source.
constexpr double kRough = 0.02;

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
    if (end == frames || end - begin < std::max(4.0, kShortest * motion.fps)) continue;
    const double sagitta = gravity * (end - begin) * (end - begin) / (8 * motion.fps * motion.fps);
    const auto [before, rough] = fitted_fall(path, begin, end, motion.fps);
    if (before < kWeak * gravity || before > kStrong * gravity || rough > kRough + 0.05 * sagitta)
      continue;
    const int first = begin - 1;
    const double span = (end - first) / motion.fps;
    const Vec3 from = path[first],
               speed = (path[end] - from) / span + Vec3(0, 0.5 * gravity * span, 0);
    auto fall = [&](int f) {
      const double t = (f - first) / motion.fps;
      return Vec3(from + t * speed - Vec3(0, 0.5 * gravity * t * t, 0) - path[f]);
    };
    bool sinks = false;
    for (int f = begin; f < end; ++f) sinks |= lowest[f] + fall(f).y() < 0;
    if (sinks) continue;  // something else than the feet held the body, or the feet did after all
    for (int f = begin; f < end; ++f) motion.frames[f].root += fall(f);
    flights.push_back({begin, end, before});
  }
  return flights;
}

}  // namespace ecorche::inline v1
