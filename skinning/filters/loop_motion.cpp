#include "skinning/filters/loop_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kShortestRound = 0.4;  // s
constexpr double kAlike = 1.3;          // times the best seam: as good, if it makes a longer round

using Features = Eigen::VectorXd;

// Of each frame: where limbs' ends and middles are and how fast, seen from where the figure stands.
std::vector<Features> frame_features(const Skeleton& skeleton, const Motion& motion) {
  constexpr double kSpeedWeight = 0.1;  // s
  constexpr std::array<const char*, 10> kSeen = {"head",    "pelvis",  "knee_l",  "knee_r",
                                                 "ankle_l", "ankle_r", "elbow_l", "elbow_r",
                                                 "wrist_l", "wrist_r"};
  std::vector<int> joints;
  for (const char* name : kSeen)
    if (const int j = find_joint(skeleton, name); j >= 0) joints.push_back(j);
  const Eigen::Index size = 3 * Eigen::Index(joints.size());
  std::vector<Features> out;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    const GroundMove from = inverse(ground_place(pose));
    Features all = Features::Zero(2 * size);
    for (std::size_t k = 0; k < joints.size(); ++k)
      all.segment<3>(3 * Eigen::Index(k)) = from * Vec3(X[std::size_t(joints[k])].translation());
    out.push_back(std::move(all));
  }
  for (std::size_t f = 1; f + 1 < out.size(); ++f)
    out[f].tail(size) =
        0.5 * kSpeedWeight * motion.fps * (out[f + 1].head(size) - out[f - 1].head(size));
  if (out.size() > 2) {
    out.front().tail(size) = out[1].tail(size);
    out.back().tail(size) = out[out.size() - 2].tail(size);
  }
  return out;
}

// Frames [begin, end) of a round; `over` more follow.
struct Round {
  int begin, end;
};

Round find_round(const Skeleton& skeleton, const Motion& motion, int over) {
  constexpr int kMostFrames = 600;  // that are compared; of longer motions every second, ...
  const std::vector<Features> seen = frame_features(skeleton, motion);
  const int count = int(seen.size()), stride = 1 + count / kMostFrames;
  const int shortest = std::max(over + 1, int(std::lround(kShortestRound * motion.fps)));
  const auto seam = [&](int b, int e) {
    double sum = 0;
    for (int k : {0, over / 2, over})
      sum += (seen[std::size_t(b + k)] - seen[std::size_t(e + k)]).squaredNorm();
    return std::sqrt(sum / 3);
  };
  double best = HUGE_VAL;
  for (int b = 0; b + shortest + over < count; b += stride)
    for (int e = b + shortest; e + over < count; e += stride) best = std::min(best, seam(b, e));
  Round out{0, count - over - 1};
  int longest = 0;
  double nearest = HUGE_VAL;
  for (int b = 0; b + shortest + over < count; b += stride)
    for (int e = b + std::max(shortest, longest); e + over < count; e += stride) {
      const double apart = seam(b, e);
      if (apart > kAlike * best) continue;
      if (e - b > longest || apart < nearest) out = {b, e}, nearest = apart;
      longest = std::max(longest, e - b);
    }
  return out;
}

// Which heels and balls stand in a frame.
using Standing = std::array<bool, 4>;
std::size_t point_of(const Contact& one) {
  return (one.side == Side::left ? 0 : 2) + (one.heel ? 0 : 1);
}

std::vector<Standing> standing_frames(const std::vector<Contact>& contacts, std::size_t frames) {
  std::vector<Standing> out(frames, Standing{});
  for (const Contact& one : contacts)
    for (int f = one.begin; f < one.end; ++f) out[std::size_t(f)][point_of(one)] = true;
  return out;
}

std::vector<Contact> contacts_of(const std::vector<Standing>& standing, double fps) {
  constexpr double kShortest = 0.06;  // s
  std::vector<Contact> out;
  for (std::size_t p = 0; p < 4; ++p)
    for (int f = 0; f < int(standing.size()); ++f) {
      if (!standing[std::size_t(f)][p]) continue;
      const int begin = f;
      while (f < int(standing.size()) && standing[std::size_t(f)][p]) ++f;
      if (f - begin >= kShortest * fps)
        out.push_back({p < 2 ? Side::left : Side::right, p % 2 == 0, begin, f, 0});
    }
  return out;
}

}  // namespace

void make_loop(const std::string& name, const Skeleton& skeleton, const LoopOptions& options,
               FilteredMotion& filtered) {
  const Motion& given = filtered.motion;
  const int count = int(given.frames.size()),
            over = std::max(1, int(std::lround(options.over * given.fps)));
  if (count < 4 * over + 2)
    throw UnfitError(
        fmt::format("{}: --filter loop: {} frames, of which {} are to lead from the end into the "
                    "beginning; take a longer part, or a shorter over",
                    name, count, over));
  const Round round = options.find ? find_round(skeleton, given, over) : Round{0, count - over - 1};
  const auto frame = [&](int f) -> const Pose& { return given.frames[std::size_t(f)]; };
  const GroundMove onward =
      ground_place(frame(round.end)) * inverse(ground_place(frame(round.begin)));
  const std::vector<Standing> stood = standing_frames(filtered.contacts, given.frames.size());
  const int frames = round.end - round.begin;
  std::vector<Pose> once;
  std::vector<Standing> standing;
  for (int f = 0; f < frames; ++f) {
    const double share = f < over ? smooth_step(double(f) / over) : 1;
    Pose tail = frame(f < over ? round.end + f : round.begin + f);
    if (f < over) move_pose(inverse(onward), tail);
    once.push_back(blend_poses(tail, frame(round.begin + f), share));
    standing.push_back(stood[std::size_t(share < 0.5 ? round.end + f : round.begin + f)]);
  }
  Motion out{given.fps, {}};
  std::vector<Standing> thrice;
  GroundMove place;
  for (int k = 0; k < 3; ++k) {
    for (Pose pose : once) {
      move_pose(place, pose);
      out.frames.push_back(std::move(pose));
    }
    thrice.insert(thrice.end(), standing.begin(), standing.end());
    place = onward * place;
  }
  filtered.contacts = contacts_of(thrice, out.fps);
  filtered.motion = std::move(out);
  filtered.loop = LoopRounds{frames, onward, options.keep_travel};
}

void close_loop(FilteredMotion& filtered) {
  const LoopRounds loop = *filtered.loop;
  std::vector<Pose>& frames = filtered.motion.frames;
  frames = std::vector<Pose>(frames.begin() + loop.frames, frames.begin() + 2 * loop.frames);
  for (int f = 0; f < loop.frames; ++f) {
    const double travelled = loop.keep_travel ? 0 : double(f) / loop.frames;
    move_pose(inverse(loop.round), frames[std::size_t(f)]);
    move_pose(power(loop.round, -travelled), frames[std::size_t(f)]);
  }
  std::vector<Contact> kept;
  for (Contact one : filtered.contacts) {
    one.begin = std::max(0, one.begin - loop.frames);
    one.end = std::min(loop.frames, one.end - loop.frames);
    if (one.begin < one.end) kept.push_back(one);
  }
  filtered.contacts = std::move(kept);
  filtered.loop.reset();
}

}  // namespace ecorche::inline v1
