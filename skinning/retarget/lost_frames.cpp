#include "skinning/retarget/lost_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ecorche::inline v1 {
namespace {

constexpr double kMoves = 0.1 * kDegree;  // a step; less is noise
constexpr std::size_t kLeast = 5;         // joints that have to move
constexpr double kMedian = 1.7, kQuarter = 1.4;
constexpr double kSame = 1e-9;     // of a rotation's parts, and of a place: the same number
constexpr std::size_t kNamed = 8;  // frames in a line for people

struct Track {
  std::string joint;
  std::size_t track = 0;
};

class Steps {
 public:
  Steps(const MotionClip& clip, const JointMapping& mapping) : clip_(clip) {
    for (const auto& [ours, joint] : mapping.rotation_joint)
      if (const int track = clip.joints[std::size_t(joint)].rotation_track; track >= 0)
        tracks_.push_back({ours, std::size_t(track)});
    for (int f = 1; f < clip.frame_count; ++f) {
      std::vector<double>& step = angles_.emplace_back();
      for (const Track& one : tracks_) step.push_back(angle(f, one.track));
    }
  }

  // The step to a frame from the one before it.
  const std::vector<double>& to(int frame) const { return angles_[std::size_t(frame - 1)]; }
  const std::string& joint(std::size_t track) const { return tracks_[track].joint; }

  bool moves(int frame) const {
    return std::ranges::count_if(to(frame), [](double one) { return one > kMoves; }) >=
           std::ptrdiff_t(kLeast);
  }

  bool repeats(int frame) const {
    const auto same = [&](const auto& values, int tracks) {
      const auto now = values.begin() + std::ptrdiff_t(frame) * tracks;
      return std::equal(now - tracks, now, now, [](const auto& a, const auto& b) {
        return (a - b).cwiseAbs().maxCoeff() <= kSame * (1 + a.cwiseAbs().maxCoeff());
      });
    };
    return same(clip_.rotations, clip_.rotation_tracks) &&
           same(clip_.translations, clip_.translation_tracks);
  }

 private:
  double angle(int frame, std::size_t track) const {
    const auto turn = [&](int f) -> const Mat3& {
      return clip_.rotations[std::size_t(f) * std::size_t(clip_.rotation_tracks) + track];
    };
    return Quat(turn(frame - 1)).angularDistance(Quat(turn(frame)));
  }

  const MotionClip& clip_;
  std::vector<Track> tracks_;
  std::vector<std::vector<double>> angles_;
};

// How many times as far as the mean of the steps beside it a step goes, by joints that move there.
std::vector<double> ratios_of(const Steps& steps, int frame) {
  std::vector<double> out;
  const std::vector<double>&before = steps.to(frame - 1), &here = steps.to(frame),
        &after = steps.to(frame + 1);
  for (std::size_t k = 0; k < here.size(); ++k)
    if (before[k] > kMoves && after[k] > kMoves)
      out.push_back(2 * here[k] / (before[k] + after[k]));
  std::ranges::sort(out);
  return out;
}

std::string frames_text(const std::vector<UnevenStep>& steps, bool lost) {
  std::string out;
  std::size_t named = 0, count = 0;
  for (const UnevenStep& one : steps) {
    if ((one.lost > 0) != lost) continue;
    ++count;
    if (named == kNamed) continue;
    ++named;
    out += fmt::format("{}{}f", out.empty() ? "" : ", ", one.frame + 1);
  }
  return count > named ? out + fmt::format(" and {} more", count - named) : out;
}

}  // namespace

std::vector<UnevenStep> find_uneven_steps(const MotionClip& clip, const JointMapping& mapping,
                                          int begin) {
  std::vector<UnevenStep> out;
  const Steps steps(clip, mapping);
  for (int f = begin + 2; f + 1 < clip.frame_count; ++f) {
    if (!steps.moves(f - 1) || !steps.moves(f + 1)) continue;
    if (steps.repeats(f)) {
      out.push_back({.frame = f});
      continue;
    }
    const std::vector<double> ratios = ratios_of(steps, f);
    if (ratios.size() < kLeast || ratios[ratios.size() / 4] < kQuarter) continue;
    const double median = ratios[ratios.size() / 2];
    if (median < kMedian) continue;
    const auto most = std::ranges::max_element(steps.to(f));
    out.push_back({f, int(std::lround(median)) - 1,
                   steps.joint(std::size_t(most - steps.to(f).begin())), *most});
  }
  return out;
}

std::vector<std::string> describe_uneven_steps(const std::string& name,
                                               const std::vector<UnevenStep>& steps) {
  std::vector<std::string> out;
  const UnevenStep* worst = nullptr;
  int lost = 0, repeated = 0;
  for (const UnevenStep& one : steps) {
    if (one.lost == 0) {
      ++repeated;
      continue;
    }
    lost += one.lost;
    if (worst == nullptr || one.angle > worst->angle) worst = &one;
  }
  if (worst != nullptr)
    out.push_back(fmt::format(
        "{}: {} frames seem to be lost, as the whole figure goes further in a step than before and "
        "after it: before frames {}; the worst, {}, turns by {:.0f} deg into frame {}f",
        name, lost, frames_text(steps, true), worst->joint, worst->angle / kDegree,
        worst->frame + 1));
  if (repeated > 0)
    out.push_back(fmt::format("{}: {} frames are the one before once more: {}", name, repeated,
                              frames_text(steps, false)));
  return out;
}

}  // namespace ecorche::inline v1
