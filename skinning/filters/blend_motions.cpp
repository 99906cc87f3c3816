#include "skinning/filters/blend_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/errors.h"
#include "skinning/filters/warp_time.h"

namespace ecorche::inline v1 {

void go_over_to(const std::string& name, FilteredMotion second, const Transition& transition,
                FilteredMotion& filtered) {
  const double fps = filtered.motion.fps;
  if (second.motion.fps != fps) change_rate(fps, second);
  std::vector<Pose>& frames = filtered.motion.frames;
  std::vector<Pose>& next = second.motion.frames;
  const int begin = int(std::lround(transition.at * fps)),
            over = std::max(1, int(std::lround(transition.over * fps))), end = begin + over;
  if (end > int(frames.size()) || over > int(next.size()))
    throw UnfitError(fmt::format(
        "{}: --filter blend: a transition from {:.4g} to {:.4g} s, where the motion lasts {:.4g} s "
        "and the one that follows {:.4g} s; let it begin earlier or last shorter",
        name, transition.at, transition.at + transition.over, double(frames.size()) / fps,
        double(next.size()) / fps));
  const GroundMove to = ground_place(frames[std::size_t(begin + over / 2)]) *
                        inverse(ground_place(next[std::size_t(over / 2)]));
  for (Pose& pose : next) move_pose(to, pose);
  for (int f = begin; f < end; ++f) {
    Pose& pose = frames[std::size_t(f)];
    pose = blend_poses(pose, next[std::size_t(f - begin)],
                       smooth_step(double(f - begin + 1) / (over + 1)));
  }
  frames.resize(std::size_t(end));
  frames.insert(frames.end(), next.begin() + over, next.end());
  std::vector<Contact> contacts;
  for (Contact one : filtered.contacts) {
    one.end = std::min(one.end, begin + over / 4);
    if (one.begin < one.end) contacts.push_back(one);
  }
  for (Contact one : second.contacts) {
    one.begin = begin + std::max(one.begin, over - over / 4);
    one.end += begin;
    if (one.begin < one.end) contacts.push_back(one);
  }
  filtered.contacts = std::move(contacts);
}

void mix_with(FilteredMotion second, double share, FilteredMotion& filtered) {
  std::vector<Pose>& frames = filtered.motion.frames;
  if (second.motion.fps != filtered.motion.fps) change_rate(filtered.motion.fps, second);
  if (frames.size() > 1 && second.motion.frames.size() > 1)
    fit_length(double(frames.size() - 1) / filtered.motion.fps, second);
  const std::vector<Pose>& other = second.motion.frames;
  const GroundMove to = ground_place(frames.front()) * inverse(ground_place(other.front()));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Pose pose = other[std::min(f, other.size() - 1)];
    move_pose(to, pose);
    frames[f] = blend_poses(frames[f], pose, share);
  }
  if (share >= 0.5) filtered.contacts = std::move(second.contacts);
}

}  // namespace ecorche::inline v1
