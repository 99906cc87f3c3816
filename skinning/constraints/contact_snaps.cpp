#include "skinning/constraints/contact_snaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "skinning/constraints/span_speed.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kFaster = 1.5, kByMore = 0.8;      // m/s; than anywhere in the motion
constexpr double kFasterHere = 3, kByMoreHere = 2;  // m/s; than around the contact
constexpr double kAround = 0.15;                    // s: corrections fade around a contact
constexpr std::size_t kSeen = 4;                    // knee and ankle, left and right

// Speeds, m/s, by frame of what leads from the span before to the next one.
using Speeds = std::vector<std::array<double, kSeen>>;

Speeds leg_speeds(const Skeleton& skeleton, const Motion& motion) {
  const std::array<int, kSeen> seen = {joint_of(skeleton, "knee_l"), joint_of(skeleton, "ankle_l"),
                                       joint_of(skeleton, "knee_r"), joint_of(skeleton, "ankle_r")};
  std::vector<std::array<Vec3, kSeen>> path;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    std::array<Vec3, kSeen>& here = path.emplace_back();
    for (std::size_t k = 0; k < kSeen; ++k)
      here[k] = X[std::size_t(seen[k])].translation() - X[0].translation();
  }
  Speeds out;
  for (std::size_t f = 1; f < path.size(); ++f) {
    std::array<double, kSeen>& speeds = out.emplace_back();
    for (std::size_t k = 0; k < kSeen; ++k) speeds[k] = span_speed(path, f, k, motion.fps);
  }
  return out;
}

}  // namespace

std::vector<bool> snapping_contacts(const Skeleton& skeleton, const Motion& before,
                                    const Motion& planted, const std::vector<Contact>& contacts) {
  std::vector<bool> out(contacts.size(), false);
  const Speeds free = leg_speeds(skeleton, before), held = leg_speeds(skeleton, planted);
  std::array<double, kSeen> top{};
  for (const auto& speeds : free)
    for (std::size_t k = 0; k < kSeen; ++k) top[k] = std::max(top[k], speeds[k]);
  const int around = 1 + int(std::lround(kAround * before.fps));
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const int begin = std::max(0, contacts[c].begin - around),
              end = std::min(int(free.size()), contacts[c].end + around);
    const std::size_t first = contacts[c].side == Side::left ? 0 : 2;
    for (std::size_t k = first; k < first + 2; ++k) {
      double with = 0, without = 0;
      for (int f = begin; f < end; ++f) {
        with = std::max(with, held[std::size_t(f)][k]);
        without = std::max(without, free[std::size_t(f)][k]);
      }
      const auto beyond = [&](double usual, double factor, double more) {
        return with > factor * usual && with > usual + more;
      };
      if (beyond(top[k], kFaster, kByMore) || beyond(without, kFasterHere, kByMoreHere))
        out[c] = true;
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
