#include "morph/registration/limb_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/compute/parallel_ranges.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::array<double, 6> kHandRolls{0, -60, 60, -120, 120, 180};  // degrees
constexpr std::array<double, 3> kHandBends{0, -45, 45};
constexpr std::array<double, 3> kFootRolls{0, -30, 30};
constexpr std::array<double, 4> kFootBends{0, 35, 70, -25};
constexpr double kReach = 0.04;       // m, of normals
constexpr double kFar = 0.04;         // m, distances that all count alike
constexpr double kBetter = 0.97;      // of the misfit as it was, that another turn must come to
constexpr double kTurnCost = 1e-3;    // of a squared deviation, as a misfit
constexpr double kExplained = 0.02;   // m, of another part, normals counted in
constexpr double kRoom = 1.1;         // of its length, about its joint, where its points may be
constexpr Eigen::Index kFewest = 40;  // points of the scan that tell something
constexpr int kSamples = 300;
constexpr double kBeyond = 0.015;    // m past the joint
constexpr double kSeenShare = 0.15;  // of the points that a whole hand or foot would have

constexpr FitStage kRough{.rounds = 6,
                          .samples = 400,
                          .width = 0.06,
                          .reach = kReach,
                          .across = 0.5,
                          .shape = false,
                          .scale = false,
                          .pose_prior = 1,
                          .shape_prior = 1};
constexpr FitStage kClose{.rounds = 6,
                          .samples = 400,
                          .width = 0.025,
                          .reach = kReach,
                          .across = 0.3,
                          .shape = false,
                          .scale = false,
                          .pose_prior = 1,
                          .shape_prior = 1};

struct LimbEnd {
  BodyPart part = BodyPart::hand;
  Side side = Side::left;
  int twist = -1, end = -1;
  std::vector<int> joints;    // that turn
  Vec3 bend = Vec3::UnitX();  // axis across, at rest
  BodySamples samples;
};

// Vertices of one end, evenly by area, and the axis that it bends about: of a hand across its long
// axis within the palm.
LimbEnd limb_end(const ArticulatedBody& body, bool hand, Side side) {
  LimbEnd out;
  out.part = hand ? BodyPart::hand : BodyPart::foot;
  out.side = side;
  const auto segment = [&](const char* name) {
    return find_segment(body, std::string(name) + side_suffix(side));
  };
  out.twist = segment(hand ? "forearm_twist" : "shank_twist");
  out.end = segment(hand ? "hand" : "foot");
  out.joints = {out.twist, out.end};
  for (const char* name : {"thumb", "fingers", "toes"})
    if (const int j = segment(name); body.joints[std::size_t(j)].parent == out.end)
      out.joints.push_back(j);
  std::vector<int> own;
  for (std::size_t i = 0; i < body.parts.size(); ++i)
    if (body.parts[i].part == out.part && body.parts[i].side == side && body.area[i] > 0)
      own.push_back(int(i));
  const std::size_t step = std::max<std::size_t>(1, own.size() / kSamples);
  double sum = 0;
  for (std::size_t k = 0; k < own.size(); k += step) {
    out.samples.vertices.push_back(own[k]);
    out.samples.weights.push_back(body.area[std::size_t(own[k])]);
    sum += out.samples.weights.back();
  }
  for (double& weight : out.samples.weights) weight /= sum;
  if (hand) {
    Points about(Eigen::Index(own.size()), 3);
    for (std::size_t k = 0; k < own.size(); ++k) about.row(Eigen::Index(k)) = body.mean.row(own[k]);
    about.rowwise() -= about.colwise().mean().eval();
    const auto axes = symmetric_eigen<3>(Mat3(about.transpose() * about));
    const Vec3 thin = axes.values[0] < axes.values[2] ? axes.vectors.col(0) : axes.vectors.col(2);
    out.bend = thin.cross(body.joints[std::size_t(out.end)].axis).normalized();
  }
  return out;
}

// How far from its joint it reaches, m.
double room(const ArticulatedPose& pose, const LimbEnd& end) {
  double out = 0;
  for (const int v : end.samples.vertices)
    out = std::max(out, (pose.shape.skin.row(v) - pose.shape.centres.row(end.end)).norm());
  return kRoom * pose.scale * out;
}

// Both hands where they are near each other, else one; feet alike: the scan does not tell whose its
// points are.
std::vector<std::vector<LimbEnd>> groups(const ArticulatedBody& body, const ArticulatedPose& pose,
                                         bool hand) {
  LimbEnd left = limb_end(body, hand, Side::left), right = limb_end(body, hand, Side::right);
  const double apart =
      pose.scale *
      (pose.places[std::size_t(left.end)] - pose.places[std::size_t(right.end)]).norm();
  if (apart < room(pose, left) + room(pose, right)) return {{left, right}};
  return {{left}, {right}};
}

BodySamples joined(const std::vector<LimbEnd>& group) {
  BodySamples out;
  for (const LimbEnd& end : group) {
    out.vertices.insert(out.vertices.end(), end.samples.vertices.begin(),
                        end.samples.vertices.end());
    for (const double weight : end.samples.weights)
      out.weights.push_back(weight / double(group.size()));
  }
  return out;
}

SurfacePoints posed_surface(const ArticulatedBody& body, const ArticulatedPose& pose,
                            const std::vector<int>& vertices) {
  SurfacePoints out{posed_points(body, pose, vertices), Points(Eigen::Index(vertices.size()), 3)};
  for (std::size_t k = 0; k < vertices.size(); ++k)
    out.normals.row(Eigen::Index(k)) =
        (blended_turn(body, pose, vertices[k]) * pose.shape.normals.row(vertices[k]).transpose())
            .normalized();
  return out;
}

// Points of the scan about their joints that no other part explains.
ScanTarget about_them(const ArticulatedFit& fit, const ArticulatedPose& pose,
                      const std::vector<LimbEnd>& group) {
  const ArticulatedBody& body = fit.body;
  std::vector<int> own, others;
  for (std::size_t i = 0; i < body.outer.size(); i += 2) {
    if (!body.outer[i]) continue;
    const bool is = std::any_of(group.begin(), group.end(), [&](const LimbEnd& end) {
      return body.parts[i].part == end.part && body.parts[i].side == end.side;
    });
    (is ? own : others).push_back(int(i));
  }
  const PointTree own_tree(posed_surface(body, pose, own), kReach),
      other_tree(posed_surface(body, pose, others), kReach);
  const SurfacePoints& scan = fit.scan.surface;
  std::vector<char> is(std::size_t(scan.points.rows()), 0);
  parallel_for_ranges(is.size(), 256, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 p = scan.points.row(Eigen::Index(i)), n = scan.normals.row(Eigen::Index(i));
      if (std::none_of(group.begin(), group.end(), [&](const LimbEnd& end) {
            const Vec3 centre = pose.scale * pose.places[std::size_t(end.end)] + pose.shift;
            return (p - centre).norm() < room(pose, end);
          }))
        continue;
      const double other = other_tree.nearest(p, n).distance;
      is[i] = other > kExplained || own_tree.nearest(p, n).distance < other;
    }
  });
  const Eigen::Index count = Eigen::Index(std::count(is.begin(), is.end(), 1));
  ScanTarget out{{Points(count, 3), Points(count, 3)}, {}, fit.scan.one_sided};
  for (std::size_t i = 0; i < is.size(); ++i) {
    if (!is[i]) continue;
    const Eigen::Index at = Eigen::Index(out.spread.size());
    out.surface.points.row(at) = scan.points.row(Eigen::Index(i));
    out.surface.normals.row(at) = scan.normals.row(Eigen::Index(i));
    out.spread.push_back(int(at));
  }
  return out;
}

// Whether the scan goes on beyond the joint, as far as the limb's end should be seen there.
bool is_seen(const ArticulatedFit& fit, const ArticulatedPose& pose, const LimbEnd& end) {
  const ArticulatedBody& body = fit.body;
  double own = 0, all = 0;
  for (std::size_t i = 0; i < body.area.size(); ++i) {
    all += body.area[i];
    if (body.parts[i].part == end.part && body.parts[i].side == end.side) own += body.area[i];
  }
  const SurfacePoints& scan = fit.scan.surface;
  const double share = fit.scan.one_sided ? 0.5 : 1;
  const double expected = share * double(scan.points.rows()) * own / all;
  const auto place = [&](int joint) -> Vec3 {
    return pose.scale * pose.places[std::size_t(joint)] + pose.shift;
  };
  const Vec3 joint = place(end.end), along = (joint - place(end.twist)).normalized();
  const double reach = room(pose, end);
  int beyond = 0;
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const Vec3 way = scan.points.row(i).transpose() - joint;
    beyond += way.norm() < reach && way.dot(along) > kBeyond;
  }
  return beyond > kSeenShare * expected;
}

// Turned by degrees about the limb and across, fingers and toes straight.
ArticulatedState turned(const ArticulatedBody& body, const LimbEnd& end, double roll, double bend,
                        ArticulatedState state) {
  if (roll == 0 && bend == 0) return state;
  Mat3& twist = state.turns[std::size_t(end.twist)];
  twist = Eigen::AngleAxisd(roll * kDegree, body.joints[std::size_t(end.twist)].axis) * twist;
  for (const int j : end.joints)
    if (j != end.twist) state.turns[std::size_t(j)].setIdentity();
  state.turns[std::size_t(end.end)] =
      Eigen::AngleAxisd(bend * kDegree, end.bend).toRotationMatrix();
  return state;
}

std::span<const double> hand_or_foot(const LimbEnd& end, std::span<const double> hand,
                                     std::span<const double> foot) {
  return end.part == BodyPart::hand ? hand : foot;
}

double turn_cost(const ArticulatedBody& body, const LimbEnd& end, const ArticulatedState& state) {
  double sum = 0;
  for (const int j : end.joints)
    sum += squared_turn(body.joints[std::size_t(j)], state.turns[std::size_t(j)]);
  return kTurnCost * sum;
}

}  // namespace

std::vector<int> turn_limb_ends(const ArticulatedFit& fit, ArticulatedState& state) {
  const ArticulatedBody& body = fit.body;
  std::vector<int> unseen;
  const RestShape shape = rest_shape(body, state.z);
  const std::vector<Mat3> rest(body.joints.size(), Mat3::Identity());
  const auto turn = [&](const LimbEnd& end, const BodySamples& samples, const ScanTarget& target,
                        const PointTree& tree) {
    const ArticulatedFit own{body, target, fit.hints, end.joints};
    std::vector<ArticulatedState> tries;
    for (const double roll : hand_or_foot(end, kHandRolls, kFootRolls))
      for (const double bend : hand_or_foot(end, kHandBends, kFootBends))
        tries.push_back(turned(body, end, roll, bend, state));
    std::vector<double> misfits(tries.size());
    parallel_for_ranges(tries.size(), 1, Threads::all, [&](std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        fit_articulated(own, kRough, samples, tree, rest, tries[k]);
        fit_articulated(own, kClose, samples, tree, rest, tries[k]);
        misfits[k] =
            two_way_misfit(own, samples, tree, shape, tries[k], int(target.spread.size()), kFar) +
            turn_cost(body, end, tries[k]);
      }
    });
    const std::size_t best =
        std::size_t(std::min_element(misfits.begin(), misfits.end()) - misfits.begin());
    state.turns = tries[misfits[best] < kBetter * misfits[0] ? best : 0].turns;
  };
  for (const bool hand : {true, false}) {
    const ArticulatedPose pose = articulate(body, shape, state);
    for (const Side side : {Side::left, Side::right}) {
      const LimbEnd end = limb_end(body, hand, side);
      if (is_seen(fit, pose, end)) continue;
      for (const int j : end.joints) state.turns[std::size_t(j)].setIdentity();
      unseen.insert(unseen.end(), end.joints.begin(), end.joints.end());
    }
    for (const std::vector<LimbEnd>& group : groups(body, pose, hand)) {
      const ScanTarget target = about_them(fit, pose, group);
      if (target.surface.points.rows() < kFewest) continue;
      if (std::any_of(group.begin(), group.end(), [&](const LimbEnd& end) {
            return std::find(unseen.begin(), unseen.end(), end.end) != unseen.end();
          }))
        continue;
      const PointTree tree(target.surface, kReach);
      const BodySamples samples = joined(group);
      for (std::size_t sweep = 0; sweep < group.size(); ++sweep)
        for (const LimbEnd& end : group) turn(end, samples, target, tree);
    }
  }
  return unseen;
}

}  // namespace ecorche::inline v1
