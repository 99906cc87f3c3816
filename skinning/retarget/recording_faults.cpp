#include "skinning/retarget/recording_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ecorche::inline v1 {
namespace {

constexpr double kStillTime = 0.1;  // s; shorter holds are in every motion with few keys
constexpr int kStillFrames = 3;
constexpr double kSame = 1e-9;                // of a rotation's parts: the same number in the file
constexpr double kSpikeAngle = 10 * kDegree;  // smaller steps are noise at high rates
// What no body reaches. The fastest turns that are measured: a pitcher's shoulder 7,500 deg/s, his
// elbow 2,400 (Fleisig et al. 1999, 10.1016/S0021-9290(99)00127-X). Lower: throws and kicks are
// told as faults; higher: at 30 frames a second nothing is, since a step is half a turn at most.
constexpr double kFastestTurn = 3500 * kDegree;      // rad/s
constexpr double kFastestShoulder = 9000 * kDegree;  // rad/s

double angle_between_turns(const Mat3& a, const Mat3& b) {
  return std::acos(std::clamp(0.5 * ((a.transpose() * b).trace() - 1), -1.0, 1.0));
}

// The rows of a clip's frames.
class ClipRows {
 public:
  explicit ClipRows(const MotionClip& clip) : clip_(clip) {}

  const Mat3& turn(int frame, int track) const {
    return clip_
        .rotations[std::size_t(frame) * std::size_t(clip_.rotation_tracks) + std::size_t(track)];
  }

  bool same(int a, int b) const {
    for (int t = 0; t < clip_.rotation_tracks; ++t)
      if ((turn(a, t) - turn(b, t)).cwiseAbs().maxCoeff() > kSame) return false;
    for (int t = 0; t < clip_.translation_tracks; ++t) {
      const Vec3 &p = shift(a, t), &q = shift(b, t);
      if ((p - q).cwiseAbs().maxCoeff() > kSame * (1 + p.cwiseAbs().maxCoeff())) return false;
    }
    return true;
  }

  bool empty(int frame) const {
    for (int t = 0; t < clip_.rotation_tracks; ++t)
      if (!turn(frame, t).isIdentity(kSame)) return false;
    return clip_.rotation_tracks > 4;
  }

 private:
  const Vec3& shift(int frame, int track) const {
    return clip_.translations[std::size_t(frame) * std::size_t(clip_.translation_tracks) +
                              std::size_t(track)];
  }

  const MotionClip& clip_;
};

using FaultKind = RecordingFault::Kind;

void find_runs(const MotionClip& clip, const ClipRows& rows, int begin,
               std::vector<RecordingFault>& out) {
  const int least = std::max(kStillFrames, int(std::ceil(kStillTime * clip.fps)));
  for (int f = begin; f < clip.frame_count;) {
    int last = f;
    const bool empty = rows.empty(f);
    while (last + 1 < clip.frame_count &&
           (empty ? rows.empty(last + 1) : rows.same(f, last + 1) && !rows.empty(last + 1)))
      ++last;
    const bool all = f == begin && last + 1 == clip.frame_count;
    const bool at_end = f == begin || last + 1 == clip.frame_count;
    if (!all && empty)
      out.push_back({FaultKind::empty, f, last});
    else if (!at_end && last - f + 1 >= least)
      out.push_back({FaultKind::still, f, last});
    f = last + 1;
  }
}

void find_spikes(const MotionClip& clip, const ClipRows& rows, const JointMapping& mapping,
                 int begin, std::vector<RecordingFault>& out) {
  for (const auto& [ours, joint] : mapping.rotation_joint) {
    const int track = clip.joints[std::size_t(joint)].rotation_track;
    if (track < 0) continue;
    const double fastest = ours.starts_with("shoulder") ? kFastestShoulder : kFastestTurn;
    for (int f = begin + 1; f < clip.frame_count; ++f) {
      const double angle = angle_between_turns(rows.turn(f - 1, track), rows.turn(f, track));
      if (angle > kSpikeAngle && angle * clip.fps > fastest)
        out.push_back({FaultKind::spike, f - 1, f, ours, angle * clip.fps});
    }
  }
}

std::string span_text(const RecordingFault& fault, double fps) {
  return fault.first == fault.last
             ? fmt::format("frame {}f", fault.first + 1)
             : fmt::format("frames {}f to {}f ({:.2f} s)", fault.first + 1, fault.last + 1,
                           (fault.last - fault.first + 1) / fps);
}

}  // namespace

std::vector<RecordingFault> find_faults(const MotionClip& clip, const JointMapping& mapping,
                                        int begin) {
  std::vector<RecordingFault> out;
  const ClipRows rows(clip);
  find_runs(clip, rows, begin, out);
  find_spikes(clip, rows, mapping, begin, out);
  std::stable_sort(out.begin(), out.end(), [](const RecordingFault& a, const RecordingFault& b) {
    return a.first < b.first;
  });
  return out;
}

std::vector<std::string> describe_faults(const std::string& name, double fps,
                                         const std::vector<RecordingFault>& faults) {
  std::vector<std::string> out;
  for (const FaultKind kind : {FaultKind::still, FaultKind::empty, FaultKind::spike}) {
    int count = 0;
    const RecordingFault* worst = nullptr;
    const auto size = [](const RecordingFault& fault) {
      return fault.kind == FaultKind::spike ? fault.speed : fault.last - fault.first;
    };
    for (const RecordingFault& fault : faults) {
      if (fault.kind != kind) continue;
      ++count;
      if (!worst || size(fault) > size(*worst)) worst = &fault;
    }
    if (!worst) continue;
    const std::string times = count == 1 ? "once" : fmt::format("{} times", count);
    if (kind == FaultKind::still)
      out.push_back(fmt::format("{}: {} nothing moves, the longest in {}: a drop-out, or a hold",
                                name, times, span_text(*worst, fps)));
    else if (kind == FaultKind::empty)
      out.push_back(fmt::format("{}: {} all angles are nought, the longest in {}: a drop-out", name,
                                times, span_text(*worst, fps)));
    else
      out.push_back(
          fmt::format("{}: {} a joint turns faster than any body does; the worst, {}, at {:.0f} "
                      "deg/s into frame {}f",
                      name, times, worst->joint, worst->speed / kDegree, worst->last + 1));
  }
  return out;
}

}  // namespace ecorche::inline v1
