#include "morph/placement/head_turn.h"

#include <Eigen/Geometry>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/compute/smooth_step.h"

namespace ecorche::inline v1 {

Vec3 HeadTurn::operator()(const Vec3& x) const {
  if (high <= low || x.y() <= low) return x;
  const double share = smooth_step((x.y() - low) / (high - low));
  const Vec3 turn = share * rotation;
  const double angle = turn.norm();
  Vec3 out = x - centre;
  if (angle > 0) out = Eigen::AngleAxisd(angle, turn / angle) * out;
  return out + centre + share * shift * Vec3::UnitX();
}

HeadTurn find_head_turn(const Points& skin, const std::vector<int>& mirror,
                        const std::vector<int>& head, double plane, double low, double high) {
  HeadTurn out{low, high};
  if (head.empty()) return out;
  Points own(Eigen::Index(head.size()), 3), image = own;
  for (std::size_t k = 0; k < head.size(); ++k) {
    const auto other = skin.row(mirror[std::size_t(head[k])]);
    own.row(Eigen::Index(k)) = skin.row(head[k]);
    image.row(Eigen::Index(k)) << 2 * plane - other.x(), other.y(), other.z();
  }
  const Vec3 a = image.colwise().mean().transpose(), b = own.colwise().mean().transpose();
  const Mat3 moments =
      (own.rowwise() - b.transpose()).transpose() * (image.rowwise() - a.transpose());
  const Mat3 turn = nearest_rotation(moments);
  const Eigen::AngleAxisd whole(turn);
  // A mirror image nods as much as its original: what is left is to the side and about the
  // vertical.
  const Vec3 rotation = whole.angle() / 2 * whole.axis();
  out.rotation = Vec3(0, rotation.y(), rotation.z());
  out.centre = Vec3(plane, b.y(), b.z());
  out.shift = ((turn * (out.centre - a) + b) - out.centre).x() / 2;
  return out;
}

Points straightened(const HeadTurn& turn, const Points& skin) {
  constexpr int kRounds = 20;  // each leaves a fifth of the error or less
  Points out = skin;
  for (Eigen::Index i = 0; i < skin.rows(); ++i) {
    if (skin(i, 1) < turn.low - std::abs(turn.shift)) continue;
    const Vec3 wanted = skin.row(i);
    Vec3 x = wanted;
    for (int round = 0; round < kRounds; ++round) x -= turn(x) - wanted;
    out.row(i) = x;
  }
  return out;
}

}  // namespace ecorche::inline v1
