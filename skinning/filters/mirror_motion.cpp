#include "skinning/filters/mirror_motion.h"

#include <string>
#include <utility>
#include <vector>

namespace ecorche::inline v1 {
namespace {

// #joints: the joint on the other side; the joint itself in the middle.
std::vector<std::size_t> other_sides(const Skeleton& skeleton) {
  std::vector<std::size_t> out;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    std::string name = skeleton.joints[j].name;
    if (name.ends_with("_l"))
      name.back() = 'r';
    else if (name.ends_with("_r"))
      name.back() = 'l';
    const int other = find_joint(skeleton, name);
    out.push_back(other < 0 ? j : std::size_t(other));
  }
  return out;
}

Vec3 mirrored(const Vec3& v) { return {-v.x(), v.y(), v.z()}; }

}  // namespace

void mirror_motion(const Skeleton& skeleton, FilteredMotion& filtered) {
  std::vector<Pose>& frames = filtered.motion.frames;
  if (frames.empty()) return;
  const std::vector<std::size_t> other = other_sides(skeleton);
  const GroundMove place = ground_place(frames.front()), back = inverse(place);
  const auto across = [](const GroundMove& move) {
    return GroundMove{-move.yaw, mirrored(move.shift)};
  };
  for (Pose& pose : frames) {
    Pose given = std::move(pose);
    move_pose(back, given);
    pose.root = mirrored(given.root);
    pose.rotations.resize(given.rotations.size());
    for (std::size_t j = 0; j < other.size(); ++j) {
      const Quat& q = given.rotations[other[j]];
      pose.rotations[j] = Quat(q.w(), q.x(), -q.y(), -q.z());
    }
    move_pose(place, pose);
  }
  for (Contact& one : filtered.contacts)
    one.side = one.side == Side::left ? Side::right : Side::left;
  filtered.belt = place.turned(mirrored(back.turned(filtered.belt)));
  if (filtered.loop)
    filtered.loop->round = place * across(back * filtered.loop->round * place) * back;
}

}  // namespace ecorche::inline v1
