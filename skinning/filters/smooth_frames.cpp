#include "skinning/filters/smooth_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ecorche::inline v1 {
namespace {

// A frame of a motion that goes on point-symmetrically beyond its ends.
struct Continued {
  const std::vector<Pose>& frames;

  // The frame itself, or the one that mirrors it about `end`.
  int inside(int f, int& end) const {
    const int last = int(frames.size()) - 1;
    end = f < 0 ? 0 : f > last ? last : -1;
    return end < 0 ? f : std::clamp(2 * end - f, 0, last);
  }
  Vec3 root(int f) const {
    int end = -1;
    const Vec3& here = frames[std::size_t(inside(f, end))].root;
    return end < 0 ? here : Vec3(2 * frames[std::size_t(end)].root - here);
  }
  Quat rotation(int f, std::size_t j) const {
    int end = -1;
    const Quat& here = frames[std::size_t(inside(f, end))].rotations[j];
    if (end < 0) return here;
    const Quat& edge = frames[std::size_t(end)].rotations[j];
    return edge * here.conjugate() * edge;
  }
};

}  // namespace

void smooth_frames(double width, Motion& motion) {
  const int count = int(motion.frames.size()), reach = int(std::floor(0.5 * width * motion.fps));
  if (reach < 1 || count < 2) return;
  const std::vector<Pose> given = motion.frames;
  const Continued at{given};
  for (int f = 0; f < count; ++f) {
    Pose& out = motion.frames[std::size_t(f)];
    Vec3 root = Vec3::Zero();
    std::vector<Eigen::Vector4d> turns(out.rotations.size(), Eigen::Vector4d::Zero());
    double total = 0;
    for (int k = -reach; k <= reach; ++k) {
      const double weight = 1 + std::cos(std::numbers::pi * k / (reach + 1));
      total += weight;
      root += weight * at.root(f + k);
      for (std::size_t j = 0; j < turns.size(); ++j) {
        const Eigen::Vector4d q = at.rotation(f + k, j).coeffs();
        const bool same = q.dot(given[std::size_t(f)].rotations[j].coeffs()) >= 0;
        turns[j] += (same ? weight : -weight) * q;
      }
    }
    out.root = root / total;
    for (std::size_t j = 0; j < turns.size(); ++j)
      out.rotations[j].coeffs() = turns[j].normalized();
  }
}

}  // namespace ecorche::inline v1
