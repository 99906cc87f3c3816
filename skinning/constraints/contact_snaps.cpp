#include "skinning/constraints/contact_snaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "anatomy/chain_kinematics.h"
#include "skinning/constraints/span_speed.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kFaster = 1.5, kByMore = 0.8;      // m/s; than anywhere in the motion
constexpr double kFasterHere = 3, kByMoreHere = 2;  // m/s; than around the contact
constexpr double kAround = 0.15;                    // s: corrections fade around a contact
constexpr double kShortest = 0.06;                  // s; of what is left of a contact
constexpr std::size_t kSeen = 4;                    // knee and ankle, left and right

// Speeds, m/s, by frame of what leads from the span before to the next one.
using Speeds = std::vector<std::array<double, kSeen>>;

Speeds leg_speeds(const Skeleton& skeleton, const Motion& motion) {
  const std::array<int, kSeen> seen = {joint_of(skeleton, "knee_l"), joint_of(skeleton, "ankle_l"),
                                       joint_of(skeleton, "knee_r"), joint_of(skeleton, "ankle_r")};
  const std::vector<int> joints = joints_up_from(skeleton, {seen[1], seen[3]});
  std::vector<std::array<Vec3, kSeen>> path;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    chain_kinematics(skeleton, joints, pose, X);
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

std::vector<std::vector<int>> contact_snaps(const Skeleton& skeleton, const Motion& before,
                                            const Motion& planted,
                                            const std::vector<Contact>& contacts) {
  std::vector<std::vector<int>> out(contacts.size());
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
      double without = 0;
      for (int f = begin; f < end; ++f) without = std::max(without, free[std::size_t(f)][k]);
      for (int f = begin; f < end; ++f) {
        const double with = held[std::size_t(f)][k];
        const auto beyond = [&](double usual, double factor, double more) {
          return with > factor * usual && with > usual + more;
        };
        if (beyond(top[k], kFaster, kByMore) || beyond(without, kFasterHere, kByMoreHere))
          out[c].push_back(f);
      }
    }
  }
  return out;
}

std::vector<Contact> contacts_between_snaps(const std::vector<Contact>& contacts,
                                            const std::vector<std::vector<int>>& snaps,
                                            double around, double fps) {
  const bool whole = std::isinf(around);
  const int reach = whole ? 0 : 1 + int(std::lround(around * fps));
  const double shortest = kShortest * fps;
  std::vector<Contact> out;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Contact& given = contacts[c];
    if (snaps[c].empty()) out.push_back(given);
    if (snaps[c].empty() || whole) continue;
    std::vector<char> stands(std::size_t(given.end - given.begin), 1);
    for (const int snap : snaps[c]) {
      const int at = std::clamp(snap, given.begin, given.end - 1);
      for (int f = std::max(given.begin, at - reach); f < std::min(given.end, at + reach + 1); ++f)
        stands[std::size_t(f - given.begin)] = 0;
    }
    for (int begin = given.begin; begin < given.end;) {
      int end = begin;
      while (end < given.end && stands[std::size_t(end - given.begin)] != 0) ++end;
      if (end - begin >= shortest) {
        Contact part = given;
        part.begin = begin, part.end = end;
        if (begin > given.begin) part.early = 0;
        if (end < given.end) part.late = 0;
        out.push_back(part);
      }
      begin = end + 1;
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
