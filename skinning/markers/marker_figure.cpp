#include "skinning/markers/marker_figure.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "anatomy/compute/cross_matrix.h"
#include "skinning/markers/lay_markers.h"
#include "skinning/motion/require_joint.h"
#include "skinning/motion/shoulder_rhythm.h"

namespace ecorche::inline v1 {
namespace {

// Of kFigureSizes.
enum Size {
  kPelvisWidth,
  kPelvisHeight,
  kTrunkLength,
  kTrunkWidth,
  kHead,
  kUpperArm,
  kForearm,
  kHand,
  kThigh,
  kShank,
  kFoot
};

struct SizeRule {
  const char* joint;  // and all beyond it, until another rule
  std::array<int, 3> sizes;
};
constexpr std::array<SizeRule, 10> kSizeRules = {
    {{"pelvis", {kPelvisWidth, kPelvisHeight, kPelvisHeight}},
     {"l5", {kTrunkWidth, kTrunkLength, kTrunkWidth}},
     {"clavicle", {kTrunkWidth, kTrunkWidth, kTrunkWidth}},
     {"c7", {kHead, kHead, kHead}},
     {"shoulder", {kUpperArm, kUpperArm, kUpperArm}},
     {"elbow", {kForearm, kForearm, kForearm}},
     {"wrist", {kHand, kHand, kHand}},
     {"hip", {kThigh, kThigh, kThigh}},
     {"knee", {kShank, kShank, kShank}},
     {"ankle", {kFoot, kFoot, kFoot}}}};

Quat turn_by(const Vec3& v) {
  const double angle = v.norm();
  if (angle < 1e-12) return Quat(1, 0.5 * v.x(), 0.5 * v.y(), 0.5 * v.z()).normalized();
  return Quat(Eigen::AngleAxisd(angle, v / angle));
}

Vec3 turn_vector(Quat q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  return sine < 1e-12 ? Vec3(2 * q.vec()) : Vec3(2 * std::atan2(sine, q.w()) / sine * q.vec());
}

// How a turn by v moves, in axes of the outer frame, when v grows: the left Jacobian of rotations.
Mat3 growth_of_turn(const Vec3& v) {
  const double angle = v.norm();
  const Mat3 C = cross_matrix(v);
  if (angle < 1e-6) return Mat3::Identity() + 0.5 * C;
  return Mat3::Identity() + (1 - std::cos(angle)) / (angle * angle) * C +
         (angle - std::sin(angle)) / (angle * angle * angle) * C * C;
}

class FigureMaker {
 public:
  explicit FigureMaker(const Skeleton& skeleton) {
    out_.skeleton = skeleton;
    out_.turn_of.assign(skeleton.joints.size(), -1);
    for (const Joint& joint : skeleton.joints) out_.offsets.push_back(joint.X_PJ.translation());
  }

  MarkerFigure make() {
    add_free("pelvis", -1);
    const auto deg = [](double x, double y, double z) -> Vec3 { return kDegree * Vec3(x, y, z); };
    add_shared({"l5", "l4", "l3", "l2", "l1", "t12", "t11", "thorax"}, {0, 1, 2}, deg(20, 15, 15));
    add_shared({"c7", "c6", "c5", "c4", "c3", "c2", "c1", "head"}, {0, 1, 2}, deg(20, 15, 20));
    const int thorax = joint_of(out_.skeleton, "thorax");
    for (const std::size_t s : {0, 1}) {
      const std::string side = s == 0 ? "_l" : "_r";
      out_.clavicle[s] = joint_of(out_.skeleton, "clavicle" + side);
      out_.scapula[s] = joint_of(out_.skeleton, "scapula" + side);
      out_.shoulder[s] = joint_of(out_.skeleton, "shoulder" + side);
      out_.elbow[s] = joint_of(out_.skeleton, "elbow" + side);
      add_shared({"clavicle" + side}, {0, 1}, deg(10, 10, 1));
      out_.turns.back().usual.setZero();  // where the rhythm has it
      add_free("shoulder" + side, thorax);
      add_hinge("elbow" + side, {0}, deg(60, 1, 1));
      add_shared({"forearm" + side}, {2}, deg(1, 1, 40));
      add_shared({"wrist" + side}, {0, 1}, deg(20, 8, 1));
      add_free("hip" + side, 0);
      add_hinge("knee" + side, {0, 2}, deg(60, 1, 4));
      add_shared({"ankle" + side}, {0}, deg(20, 1, 1));
      add_shared({"subtalar" + side}, {2}, deg(1, 1, 8));
      add_toes(side);
    }
    set_size_rules();
    return std::move(out_);
  }

 private:
  void add(FigureTurn turn) {
    turn.first = out_.coordinates;
    for (const int j : turn.joints) out_.turn_of[j] = int(out_.turns.size());
    out_.coordinates += turn.free ? 3 + 3 * (turn.parent < 0) : int(turn.components.size());
    if (turn.free && turn.parent < 0) turn.first += 3;  // behind the root's place
    turn.slot = turn.free ? free_++ : shared_++;
    out_.turns.push_back(std::move(turn));
  }

  void add_free(const std::string& joint, int parent) {
    FigureTurn turn;
    turn.free = true;
    turn.parent = parent;
    turn.joints = {joint_of(out_.skeleton, joint)};
    turn.spread = Vec3::Constant(60 * kDegree);
    add(std::move(turn));
  }

  void add_shared(const std::vector<std::string>& joints, const std::vector<int>& components,
                  const Vec3& spread) {
    FigureTurn turn;
    turn.components = components;
    turn.spread = spread;
    Vec3 range = Vec3::Zero();
    for (const std::string& name : joints) {
      const Joint& joint = out_.skeleton.joints[joint_of(out_.skeleton, name)];
      turn.joints.push_back(find_joint(out_.skeleton, name));
      turn.low += joint.min - joint.zero;
      turn.high += joint.max - joint.zero;
      range += joint.max - joint.min;
    }
    for (const int j : turn.joints)
      turn.shares.push_back(
          (out_.skeleton.joints[j].max - out_.skeleton.joints[j].min).cwiseQuotient(range));
    if (turn.joints.size() == 1)
      turn.usual = -out_.skeleton.joints[turn.joints[0]].zero;  // the anatomical zero
    for (int k = 0; k < 3; ++k)
      if (std::ranges::find(components, k) == components.end()) turn.usual[k] = 0;
    add(std::move(turn));
  }

  // Straight is as far as it goes: markers of sets without a point at the joint do not tell how
  // much of a bend is the joint's and how much is where they were stuck.
  void add_hinge(const std::string& joint, const std::vector<int>& components, const Vec3& spread) {
    add_shared({joint}, components, spread);
    out_.turns.back().low[0] = out_.turns.back().usual[0];
  }

  // All toes bend alike.
  void add_toes(const std::string& side) {
    FigureTurn turn;
    turn.components = {0};
    turn.spread = Vec3::Constant(15 * kDegree);
    turn.low = Vec3::Constant(-50 * kDegree);
    turn.high = Vec3::Constant(40 * kDegree);
    for (const char* toe : {"mtp1", "mtp2", "mtp3", "mtp4", "mtp5"}) {
      turn.joints.push_back(joint_of(out_.skeleton, toe + side));
      turn.shares.push_back(Vec3::Ones());
    }
    add(std::move(turn));
  }

  void set_size_rules() {
    for (std::size_t j = 0; j < out_.skeleton.joints.size(); ++j) {
      const Joint& joint = out_.skeleton.joints[j];
      std::array<int, 3> sizes =
          joint.parent < 0 ? kSizeRules[0].sizes : out_.sizes_of[std::size_t(joint.parent)];
      for (const SizeRule& rule : kSizeRules)
        if (joint.name == rule.joint || joint.name == std::string(rule.joint) + "_l" ||
            joint.name == std::string(rule.joint) + "_r")
          sizes = rule.sizes;
      out_.sizes_of.push_back(sizes);
    }
  }

  MarkerFigure out_;
  int free_ = 0, shared_ = 0;
};

Vec3 scaled(const MarkerFigure& figure, int joint, const Vec3& v) {
  const std::array<int, 3>& k = figure.sizes_of[joint];
  return {figure.sizes[k[0]] * v.x(), figure.sizes[k[1]] * v.y(), figure.sizes[k[2]] * v.z()};
}

// Girdle and upper arm of a side.
void set_arm(const MarkerFigure& figure, const FigurePose& at, std::size_t side, Pose& pose) {
  const int clavicle = figure.clavicle[side], shoulder = figure.shoulder[side];
  const FigureTurn &girdle = figure.turns[figure.turn_of[clavicle]],
                   &upper = figure.turns[figure.turn_of[shoulder]];
  const Quat& arm = at.free[upper.slot];
  const Vec3 rest = figure.offsets[figure.elbow[side]];
  const Girdle rhythm = girdle_rhythm(side == 0 ? Side::left : Side::right, rest, arm * rest);
  const Quat beyond = turn_by(figure.skeleton.joints[clavicle].axes * at.shared[girdle.slot]);
  pose.rotations[clavicle] = beyond * rhythm.clavicle;
  pose.rotations[figure.scapula[side]] = rhythm.clavicle.conjugate() * rhythm.scapula;
  pose.rotations[shoulder] = (beyond * rhythm.scapula).conjugate() * arm;
}

}  // namespace

MarkerFigure make_figure(const Skeleton& skeleton) { return FigureMaker(skeleton).make(); }

void set_sizes(const FigureSizes& sizes, MarkerFigure& figure) {
  figure.sizes = sizes;
  for (std::size_t j = 1; j < figure.offsets.size(); ++j)
    figure.skeleton.joints[j].X_PJ.translation() =
        scaled(figure, figure.skeleton.joints[j].parent, figure.offsets[j]);
}

FigurePose attention(const MarkerFigure& figure) {
  const Pose pose = attention_pose(figure.skeleton);
  FigurePose out;
  out.root = pose.root;
  for (const FigureTurn& turn : figure.turns) {
    if (!turn.free) {
      out.shared.push_back(turn.usual);
      continue;
    }
    out.free.push_back(pose.rotations[turn.joints[0]]);
  }
  return out;
}

void figure_kinematics(const MarkerFigure& figure, const FigurePose& at, Pose& pose,
                       std::vector<Transform>& X) {
  pose.root = at.root;
  pose.rotations.assign(figure.offsets.size(), Quat::Identity());
  for (const FigureTurn& turn : figure.turns) {
    if (turn.free) {
      pose.rotations[turn.joints[0]] = at.free[turn.slot];
      continue;
    }
    for (std::size_t k = 0; k < turn.joints.size(); ++k)
      pose.rotations[turn.joints[k]] = turn_by(figure.skeleton.joints[turn.joints[k]].axes *
                                               turn.shares[k].cwiseProduct(at.shared[turn.slot]));
  }
  for (const std::size_t side : {0, 1}) set_arm(figure, at, side, pose);
  complete_pose(figure.skeleton, pose);
  forward_kinematics(figure.skeleton, pose, X);
}

void move_figure(const MarkerFigure& figure, const Eigen::VectorXd& step, FigurePose& at) {
  at.root += step.head<3>();
  for (const FigureTurn& turn : figure.turns) {
    if (turn.free)
      at.free[turn.slot] = (turn_by(step.segment<3>(turn.first)) * at.free[turn.slot]).normalized();
    else
      for (std::size_t k = 0; k < turn.components.size(); ++k)
        at.shared[turn.slot][turn.components[k]] += step[turn.first + int(k)];
  }
}

void figure_difference(const MarkerFigure& figure, const FigurePose& from, const FigurePose& to,
                       Eigen::VectorXd& out) {
  out.setZero(figure.coordinates);
  for (const FigureTurn& turn : figure.turns) {
    if (turn.free) {
      out.segment<3>(turn.first) =
          turn_vector(to.free[turn.slot] * from.free[turn.slot].conjugate());
      continue;
    }
    for (std::size_t k = 0; k < turn.components.size(); ++k)
      out[turn.first + int(k)] =
          to.shared[turn.slot][turn.components[k]] - from.shared[turn.slot][turn.components[k]];
  }
}

void point_derivatives(const MarkerFigure& figure, const FigurePose& at,
                       const std::vector<Transform>& X, int joint, const Vec3& local,
                       const Vec3& offset, Eigen::Ref<Eigen::Matrix3Xd> by_coordinate,
                       Eigen::Matrix<double, 3, int(kFigureSizes.size())>* by_size) {
  const auto add_size = [&](int frame, const Vec3& v) {
    for (int k = 0; k < 3; ++k)
      by_size->col(figure.sizes_of[frame][std::size_t(k)]) += v[k] * X[frame].linear().col(k);
  };
  if (by_size) by_size->setZero(), add_size(joint, local);
  const Vec3 p = figure_point(figure, X, joint, local, offset);
  int carried = -1;  // a shoulder on the way
  by_coordinate.leftCols<3>().setIdentity();
  for (int j = joint; j >= 0; j = figure.skeleton.joints[j].parent) {
    const int parent = figure.skeleton.joints[j].parent;
    if (by_size && parent >= 0) add_size(parent, figure.offsets[j]);
    if (figure.turn_of[j] >= 0) {
      const FigureTurn& turn = figure.turns[figure.turn_of[j]];
      // An arm keeps its turn against the thorax when the girdle moves: it carries the shoulder.
      const bool girdle = j == figure.clavicle[0] || j == figure.clavicle[1];
      const Vec3 arm =
          (girdle && carried >= 0 ? Vec3(X[carried].translation()) : p) - X[j].translation();
      if (j == figure.shoulder[0] || j == figure.shoulder[1]) carried = j;
      if (turn.free) {
        for (int k = 0; k < 3; ++k)
          by_coordinate.col(turn.first + k) =
              (turn.parent < 0 ? Vec3(Vec3::Unit(k)) : Vec3(X[turn.parent].linear().col(k)))
                  .cross(arm);
      } else {
        const std::size_t at_joint =
            std::size_t(std::ranges::find(turn.joints, j) - turn.joints.begin());
        const Mat3& axes = figure.skeleton.joints[j].axes;
        const Vec3& share = turn.shares[at_joint];
        const Mat3 moved = X[parent].linear() *
                           growth_of_turn(axes * share.cwiseProduct(at.shared[turn.slot])) * axes;
        for (std::size_t k = 0; k < turn.components.size(); ++k) {
          const int component = turn.components[k];
          by_coordinate.col(turn.first + int(k)) +=
              share[component] * moved.col(component).cross(arm);
        }
      }
    }
  }
}

Vec3 figure_point(const MarkerFigure& figure, const std::vector<Transform>& X, int joint,
                  const Vec3& local, const Vec3& offset) {
  return X[joint] * Vec3(scaled(figure, joint, local) + offset);
}

}  // namespace ecorche::inline v1
