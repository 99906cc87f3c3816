#include "morph/registration/still_hands.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kStiff = 0.005;    // m, root mean square that a hand which has moved as one is off
constexpr double kSeenShare = 0.6;  // of a hand's vertices
constexpr double kWrist = 0.04;     // m, from the forearm on, over which the piece takes over

struct Rigid {
  Mat3 turn = Mat3::Identity();
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double rms = 0;  // m

  Vec3 operator()(const Vec3& p) const { return turn * (p - from) + to; }
};

// Least squares.
Rigid rigid_motion(const Points& rest, const Points& posed, const std::vector<int>& vertices) {
  Rigid out;
  const double share = 1 / double(vertices.size());
  for (const int i : vertices) {
    out.from += share * rest.row(i).transpose();
    out.to += share * posed.row(i).transpose();
  }
  Mat3 moment = Mat3::Zero();
  for (const int i : vertices)
    moment += (posed.row(i).transpose() - out.to) * (rest.row(i) - out.from.transpose());
  out.turn = nearest_rotation(moment);
  for (const int i : vertices)
    out.rms += share * (posed.row(i).transpose() - out(rest.row(i).transpose())).squaredNorm();
  out.rms = std::sqrt(out.rms);
  return out;
}

}  // namespace

Registration with_still_hands(Registration registration, const std::vector<VertexPart>& parts) {
  const Points& rest = registration.body.skin.V;
  for (const Side side : {Side::left, Side::right}) {
    std::vector<int> hand;
    Vec3 wrist = Vec3::Zero();
    double seen = 0, forearm = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].side != side || parts[i].part != BodyPart::hand) continue;
      hand.push_back(int(i));
      seen += registration.seen[i] ? 1 : 0;
    }
    if (hand.empty()) continue;
    // The wrist: where triangles join the hand to the forearm.
    const Triangles& F = registration.body.skin.F;
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const VertexPart &a = parts[std::size_t(F(f, k))],
                         &b = parts[std::size_t(F(f, (k + 1) % 3))];
        if (a.side != side || a.part != BodyPart::hand || b.part != BodyPart::forearm) continue;
        wrist += rest.row(F(f, k)).transpose();
        forearm += 1;
      }
    }
    const Rigid motion = rigid_motion(rest, registration.posed, hand);
    if (forearm == 0 || (motion.rms < kStiff && seen > kSeenShare * double(hand.size()))) continue;
    wrist /= forearm;
    for (const int i : hand) {
      const Vec3 own = registration.posed.row(i);
      const double t = std::clamp((rest.row(i).transpose() - wrist).norm() / kWrist, 0.0, 1.0);
      const double share = t * t * (3 - 2 * t);
      registration.posed.row(i) =
          ((1 - share) * own + share * motion(rest.row(i).transpose())).transpose();
      const Quat before(registration.turn[std::size_t(i)]), after(motion.turn);
      registration.turn[std::size_t(i)] = before.slerp(share, after).toRotationMatrix();
    }
  }
  return registration;
}

}  // namespace ecorche::inline v1
