#include "anatomy/posing/moment_arms.h"

#include <stdexcept>
#include <string>

#include "anatomy/posing/posed_line.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTurn = 0.01;  // rad, to either side

// A strip where its batch has it.
struct LinePlace {
  int strip = 0;  // of PosingData
  int node = 0, rows = 0;
  double length_factor = 1;
};

// All strips, in flat order.
std::vector<LinePlace> line_places(const PosingData& data) {
  std::vector<LinePlace> out(std::size_t(data.strips));
  for (const PosingBatch& batch : data.batches)
    for (int lane = 0; lane < batch.strips; ++lane) {
      const int index = batch.strip[lane];
      out[data.strip[index].strip] = {index, batch.node + lane * batch.rows, batch.rows,
                                      batch.lanes.length_factor[lane]};
    }
  return out;
}

double line_length(const PosingData& data, const LinePlace& place,
                   const std::vector<Transform>& X_WJ) {
  Double4 points[kMaxStripSlices];
  lay_strip(data, data.strip[place.strip], place.node, place.rows, X_WJ, points);
  double length = 0;
  for (int k = 1; k < place.rows; ++k)
    length += (points[k] - points[k - 1]).matrix().head<3>().norm();
  return length * place.length_factor;
}

Pose turned_pose(const Skeleton& skeleton, const Pose& pose, const TurnAxis& axis, double angle) {
  Pose out = pose;
  Quat& q = out.rotations[axis.joint];
  q = q * Quat(Eigen::AngleAxisd(angle, axis.direction));
  complete_pose(skeleton, out);
  return out;
}

// The patella that goes with a knee, or -1.
int follower_of(const Skeleton& skeleton, int joint) {
  const std::string& name = skeleton.joints[joint].name;
  return name.starts_with("knee") ? find_joint(skeleton, "patella" + name.substr(4)) : -1;
}

// What a turn carries: 0 nothing, 1 with the joint, 2 with its patella. #joints
std::vector<char> carried_by(const Skeleton& skeleton, int joint) {
  std::vector<char> out(skeleton.joints.size(), 0);
  const int follower = follower_of(skeleton, joint);
  for (std::size_t j = 0; j < out.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    out[j] = int(j) == joint ? 1 : int(j) == follower ? 2 : parent >= 0 ? out[parent] : 0;
  }
  return out;
}

bool changes(const PosingData& data, const PosingStrip& strip, const std::vector<char>& carried) {
  const char first = carried[data.points[strip.point].first];
  for (int i = 0; i < strip.points; ++i) {
    const PosingPoint& p = data.points[strip.point + i];
    if (carried[p.first] != first || (p.second >= 0 && carried[p.second] != first)) return true;
  }
  for (int w = 0; w < strip.wraps; ++w)
    if (carried[data.wraps[strip.wrap + w].joint] != first) return true;
  return false;
}

}  // namespace

struct MomentArms::Plan {
  std::shared_ptr<const PosingData> data;
  Skeleton skeleton;
  std::vector<TurnAxis> axes;
  std::vector<LinePlace> places;
  std::vector<MomentArm> pairs;
};

MomentArms::MomentArms(const PosingTable& table, const Skeleton& skeleton,
                       std::vector<TurnAxis> axes) {
  if (!table.data || int(skeleton.joints.size()) != table.data->joints)
    throw std::invalid_argument("MomentArms: a table of another skeleton");
  auto plan = std::make_unique<Plan>(
      Plan{table.data, skeleton, std::move(axes), line_places(*table.data), {}});
  for (std::size_t a = 0; a < plan->axes.size(); ++a) {
    const int joint = plan->axes[a].joint;
    if (joint < 0 || joint >= plan->data->joints)
      throw std::invalid_argument("MomentArms: an axis of no joint");
    const std::vector<char> carried = carried_by(skeleton, joint);
    for (std::size_t s = 0; s < plan->places.size(); ++s)
      if (changes(*plan->data, plan->data->strip[plan->places[s].strip], carried))
        plan->pairs.push_back({int(a), int(s)});
  }
  plan_ = std::move(plan);
}

MomentArms::~MomentArms() = default;

const std::vector<MomentArm>& MomentArms::pairs() const { return plan_->pairs; }

void MomentArms::find(const Pose& pose, std::vector<double>& lengths,
                      std::vector<float>& arms) const {
  const Plan& plan = *plan_;
  std::vector<Transform> less, more;
  forward_kinematics(plan.skeleton, pose, less);
  lengths.resize(plan.places.size());
  for (std::size_t s = 0; s < lengths.size(); ++s)
    lengths[s] = line_length(*plan.data, plan.places[s], less);
  arms.resize(plan.pairs.size());
  int axis = -1;
  for (std::size_t k = 0; k < arms.size(); ++k) {
    const MomentArm& pair = plan.pairs[k];
    if (pair.axis != axis) {
      axis = pair.axis;
      forward_kinematics(plan.skeleton, turned_pose(plan.skeleton, pose, plan.axes[axis], -kTurn),
                         less);
      forward_kinematics(plan.skeleton, turned_pose(plan.skeleton, pose, plan.axes[axis], kTurn),
                         more);
    }
    arms[k] = float((line_length(*plan.data, plan.places[pair.strip], less) -
                     line_length(*plan.data, plan.places[pair.strip], more)) /
                    (2 * kTurn));
  }
}

}  // namespace ecorche::inline v1
