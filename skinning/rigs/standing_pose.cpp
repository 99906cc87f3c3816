#include "skinning/rigs/standing_pose.h"

#include <numbers>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/cross_matrix.h"
#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

// m^2: vertices spread by less about their centre leave a joint with its parent.
constexpr double kFirm = 0.004 * 0.004;
// m: a joint that turns by 1 rad from what its own vertices say costs as much as the whole skin
// that far off. Larger: hands and feet stay off their places; smaller: vertebrae bend to and fro.
constexpr double kStiff = 0.006;
constexpr int kStandingRounds = 3;

// Each joint's rotation in the world, by its own vertices.
std::vector<Mat3> own_rotations(const Skeleton& skeleton,
                                const std::vector<JointMoments>& moments) {
  std::vector<Mat3> out(skeleton.joints.size());
  for (std::size_t j = 0; j < out.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Mat3 above = parent < 0 ? Mat3::Identity() : out[std::size_t(parent)];
    const Eigen::Matrix4d& m = moments[j].here;
    const double weight = m(3, 3);
    out[j] = above;
    if (!(weight > 1e-9)) continue;
    const Vec3 here = m.topRightCorner<3, 1>() / weight;
    const Eigen::RowVector3d rest = m.bottomLeftCorner<1, 3>() / weight;
    out[j] = nearest_rotation(m.topLeftCorner<3, 3>() / weight - here * rest + kFirm * above);
  }
  return out;
}

// Of the vertices of a joint and those after it, as the pose has them: sums of their shares,
// places q, q q^T, and q t^T and t of where they ought to be.
struct Sums {
  double weight = 0;
  Vec3 q = Vec3::Zero(), t = Vec3::Zero();
  Mat3 qq = Mat3::Zero(), qt = Mat3::Zero();

  void add(const Sums& other) {
    weight += other.weight;
    q += other.q;
    t += other.t;
    qq += other.qq;
    qt += other.qt;
  }
};

Sums posed_sums(const Transform& X_WJ, const Vec3& origin, const JointMoments& m) {
  const Eigen::Matrix4d X = (X_WJ * Eigen::Translation3d(-origin)).matrix();
  const Eigen::Matrix4d qq = X * m.rest * X.transpose(), qt = X * m.here.transpose();
  return {m.rest(3, 3), qq.topRightCorner<3, 1>(), m.here.topRightCorner<3, 1>(),
          qq.topLeftCorner<3, 3>(), qt.topLeftCorner<3, 3>()};
}

// One step: small turns of all joints about their places, and of the root's place. `off`: how far
// each joint has turned from its own rotation below its parent, world.
Eigen::VectorXd find_step(const Skeleton& skeleton, const std::vector<Transform>& X_WJ,
                          const std::vector<Sums>& below, const std::vector<Vec3>& off) {
  const Eigen::Index count = Eigen::Index(skeleton.joints.size());
  const double stiff = kStiff * kStiff * below[0].weight;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3 * count + 3, 3 * count + 3);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * count + 3);
  for (Eigen::Index b = 0; b < count; ++b) {
    const Sums& s = below[std::size_t(b)];
    const Vec3 p = X_WJ[std::size_t(b)].translation();
    // sum of share (q - p) x (q - t)
    const Vec3 q_by_t(s.qt(1, 2) - s.qt(2, 1), s.qt(2, 0) - s.qt(0, 2), s.qt(0, 1) - s.qt(1, 0));
    g.segment<3>(3 * b) = -q_by_t + p.cross(s.t - s.q) + stiff * off[std::size_t(b)];
    H.block<3, 3>(3 * count, 3 * b) = -cross_matrix(s.q - s.weight * p);
    for (int a = int(b); a >= 0; a = skeleton.joints[std::size_t(a)].parent) {
      const Vec3 above = X_WJ[std::size_t(a)].translation();
      // of [q - above]^T [q - p] as cross products
      const Mat3 outer =
          s.qq - s.q * above.transpose() - p * s.q.transpose() + s.weight * p * above.transpose();
      const Mat3 block = outer.trace() * Mat3::Identity() - outer;
      H.block<3, 3>(3 * a, 3 * b) = block;
      H.block<3, 3>(3 * b, 3 * a) = block.transpose();
    }
    H.block<3, 3>(3 * b, 3 * b).diagonal().array() += stiff;
  }
  H.bottomRightCorner<3, 3>() = below[0].weight * Mat3::Identity();
  H.topRightCorner(3 * count, 3) = H.bottomLeftCorner(3, 3 * count).transpose();
  g.tail<3>() = below[0].q - below[0].t;
  return solve_ldlt<Eigen::Dynamic>(H, -g);
}

Quat turn_by(const Vec3& vector) {
  const double angle = vector.norm();
  return angle > 0 ? Quat(Eigen::AngleAxisd(angle, vector / angle)) : Quat::Identity();
}

Vec3 turn_vector(const Quat& q) {
  const Eigen::AngleAxisd turn(q);
  return (turn.angle() > std::numbers::pi ? turn.angle() - 2 * std::numbers::pi : turn.angle()) *
         turn.axis();
}

void give_way(const Skeleton& skeleton, const std::vector<JointMoments>& moments, Pose& pose) {
  const std::size_t count = skeleton.joints.size();
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const std::vector<Quat> own = pose.rotations;
  std::vector<Transform> X_WJ;
  std::vector<Sums> below(count);
  std::vector<Vec3> off(count);
  for (int round = 0; round < kStandingRounds; ++round) {
    forward_kinematics(skeleton, pose, X_WJ);
    for (std::size_t j = 0; j < count; ++j) {
      below[j] = posed_sums(X_WJ[j], origins[j], moments[j]);
      off[j] = X_WJ[j].linear() * turn_vector(own[j].conjugate() * pose.rotations[j]);
    }
    for (std::size_t j = count; j-- > 1;)
      if (const int parent = skeleton.joints[j].parent; parent >= 0)
        below[std::size_t(parent)].add(below[j]);
    if (!(below[0].weight > 0)) return;
    const Eigen::VectorXd step = find_step(skeleton, X_WJ, below, off);
    for (std::size_t j = 0; j < count; ++j) {
      const Vec3 turn = X_WJ[j].linear().transpose() * step.segment<3>(3 * Eigen::Index(j));
      pose.rotations[j] = (pose.rotations[j] * turn_by(turn)).normalized();
    }
    pose.root += step.tail<3>();
  }
}

}  // namespace

Eigen::Matrix4d vertex_moment(const Vec3& a, const Vec3& b) {
  const Eigen::Vector4d left = a.homogeneous(), right = b.homogeneous();
  return left * right.transpose();
}

Pose pose_by_moments(const Skeleton& skeleton, const std::vector<JointMoments>& moments) {
  const std::vector<Mat3> world = own_rotations(skeleton, moments);
  Pose out;
  out.root = rest_pose(skeleton).root;
  for (std::size_t j = 0; j < world.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Mat3 above = parent < 0 ? Mat3::Identity() : world[std::size_t(parent)];
    out.rotations.push_back(Quat(Mat3(above.transpose() * world[j])).normalized());
  }
  give_way(skeleton, moments, out);
  return out;
}

Pose standing_pose(const Skeleton& skeleton, const Points& rest, const Points& standing,
                   const std::vector<JointWeights>& weights) {
  std::vector<JointMoments> moments(skeleton.joints.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Vec3 from = rest.row(Eigen::Index(i)), to = standing.row(Eigen::Index(i));
    const Eigen::Matrix4d at_rest = vertex_moment(from, from), here = vertex_moment(to, from);
    for (const Influence& w : weights[i]) {
      const double share = w.weight * w.weight;
      moments[std::size_t(w.joint)].rest += share * at_rest;
      moments[std::size_t(w.joint)].here += share * here;
    }
  }
  return pose_by_moments(skeleton, moments);
}

}  // namespace ecorche::inline v1
