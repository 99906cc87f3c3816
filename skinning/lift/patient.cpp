#include "skinning/lift/patient.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/nearest_surface.h"
#include "skinning/motion/center_of_mass.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

// Gyration radius of a segment over the distance from its joint to its centre: a rod's that turns
// about its end has 0.58 of twice that distance.
constexpr double kGyration = 0.62;
constexpr double kSmallestGyration = 0.03;  // m
// Share of the thigh and of the lower leg, from the knee on, that counts as the knee.
constexpr double kKneeOfThigh = 0.25, kKneeOfLowerLeg = 0.18;

PassiveJoint single_joint(const Skeleton& skeleton, const std::string& name, int axes,
                          double stiffness, double damping) {
  return {{joint_of(skeleton, name)}, {Vec3::Ones()}, axes, stiffness, damping};
}

// A chain that bends as one: every joint takes its share by its range.
PassiveJoint chain(const Skeleton& skeleton, const std::vector<std::string>& names,
                   double stiffness, double damping) {
  PassiveJoint out{{}, {}, 3, stiffness, damping};
  Vec3 sum = Vec3::Zero();
  for (const std::string& name : names) {
    const int j = joint_of(skeleton, name);
    const Vec3 range = skeleton.joints[std::size_t(j)].max - skeleton.joints[std::size_t(j)].min;
    out.joints.push_back(j);
    out.shares.push_back(range);
    sum += range;
  }
  for (Vec3& share : out.shares) share = share.cwiseQuotient(sum);
  return out;
}

std::vector<PassiveJoint> make_groups(const Skeleton& skeleton) {
  std::vector<PassiveJoint> out{
      chain(skeleton, {"l5", "l4", "l3", "l2", "l1", "t12", "t11", "thorax"}, 30, 8),
      chain(skeleton, {"c7", "c6", "c5", "c4", "c3", "c2", "c1", "head"}, 5, 1.5)};
  for (const std::string s : {"_l", "_r"}) {
    // Arms are kept folded on the belly by a little effort.
    out.push_back(single_joint(skeleton, "shoulder" + s, 3, 120, 8));
    out.push_back(single_joint(skeleton, "elbow" + s, 1, 40, 2));
    out.push_back(single_joint(skeleton, "hip" + s, 3, 10, 5));
    out.push_back(single_joint(skeleton, "knee" + s, 1, 5, 3));
    out.push_back(single_joint(skeleton, "ankle" + s, 1, 5, 1));
  }
  return out;
}

std::vector<BodySegment> make_segments(const Skeleton& skeleton, double mass) {
  std::vector<BodySegment> out;
  double total = 0;
  const CenterOfMass table(skeleton);
  for (const CenterOfMass::Segment& each : table.segments()) total += each.mass;
  for (const CenterOfMass::Segment& each : table.segments()) {
    BodySegment segment{skeleton.joints[std::size_t(each.joint)].name, each.joint,
                        mass * each.mass / total, each.centre, Mat3::Zero()};
    const double gyration = std::max(kSmallestGyration, kGyration * each.centre.norm());
    segment.inertia = segment.mass * gyration * gyration * Mat3::Identity();
    out.push_back(segment);
  }
  return out;
}

// Regions of the skin by the joint that carries it, and the knees out of thigh and lower leg.
class Regions {
 public:
  explicit Regions(const Skeleton& skeleton) : skeleton_(skeleton), at_(rest_positions(skeleton)) {}

  std::string of(int joint, const Vec3& place) const {
    std::string name = skeleton_.joints[std::size_t(joint)].name;
    std::string side;
    if (name.ends_with("_l") || name.ends_with("_r")) {
      side = name.substr(name.size() - 2);
      name.resize(name.size() - 2);
    }
    if (name == "hip")
      return (along("hip" + side, "knee" + side, place) > 1 - kKneeOfThigh ? "knee" : "thigh") +
             side;
    if (name == "patella") return "knee" + side;
    if (name == "knee")
      return (along("knee" + side, "ankle" + side, place) < kKneeOfLowerLeg ? "knee"
                                                                            : "lower_leg") +
             side;
    if (name == "shoulder") return "upper_arm" + side;
    if (name == "elbow" || name == "forearm") return "forearm" + side;
    if (under(joint, "wrist" + side)) return "hand" + side;
    if (under(joint, "ankle" + side)) return "foot" + side;
    if (under(joint, "c7")) return "head";
    if (under(joint, "thorax")) return "upper_back";
    if (under(joint, "l5")) return "lower_back";
    return "buttocks";
  }

 private:
  bool under(int joint, const std::string& name) const {
    const int above = find_joint(skeleton_, name);
    for (int j = joint; j >= 0; j = skeleton_.joints[std::size_t(j)].parent)
      if (j == above) return true;
    return false;
  }
  // Share of the way from one joint to the next.
  double along(const std::string& from, const std::string& to, const Vec3& place) const {
    const Vec3& a = at_[std::size_t(joint_of(skeleton_, from))];
    const Vec3 way = at_[std::size_t(joint_of(skeleton_, to))] - a;
    return (place - a).dot(way) / way.squaredNorm();
  }

  const Skeleton& skeleton_;
  std::vector<Vec3> at_;
};

TriMesh posed_bones(const Anatomy& anatomy, const Pose& pose) {
  std::vector<Transform> X_WJ;
  forward_kinematics(anatomy.skeleton, pose, X_WJ);
  const std::vector<Vec3> rest = rest_positions(anatomy.skeleton);
  TriMesh out = joined_bones(anatomy);
  Eigen::Index first = 0;
  for (const Bone& bone : anatomy.bones) {
    const Transform& X = X_WJ[std::size_t(bone.joint)];
    const Vec3 shift = X.translation() - X.linear() * rest[std::size_t(bone.joint)];
    auto rows = out.V.middleRows(first, bone.mesh.V.rows());
    rows = ((rows * X.linear().transpose()).rowwise() + shift.transpose()).eval();
    first += bone.mesh.V.rows();
  }
  return out;
}

int largest_weight(const JointWeights& weights) {
  return std::ranges::max_element(weights, {}, &Influence::weight)->joint;
}

}  // namespace

Patient make_patient(const Anatomy& anatomy, const TriMesh& skin,
                     const std::vector<JointWeights>& weights, double mass,
                     const FleshOptions& tissue) {
  if (Eigen::Index(weights.size()) != skin.V.rows())
    throw std::invalid_argument("make_patient: weights of another skin");
  Patient out;
  out.skeleton = anatomy.skeleton;
  out.segments = make_segments(anatomy.skeleton, mass);
  out.groups = make_groups(anatomy.skeleton);
  out.skin = skin;
  out.weights = weights;
  out.area = vertex_areas(skin);
  out.tissue = tissue;
  out.limbs = make_collision_tables(anatomy.skeleton, measure_proxies(anatomy.skeleton, skin.V));
  const Regions regions(out.skeleton);
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i) {
    const Vec3 place = skin.V.row(i).transpose();
    out.carrier.push_back(largest_weight(weights[std::size_t(i)]));
    const std::string region = regions.of(out.carrier.back(), place);
    const auto known = std::ranges::find(out.regions, region);
    out.region.push_back(int(known - out.regions.begin()));
    if (known == out.regions.end()) out.regions.push_back(region);
  }
  measure_tissue(anatomy, rest_pose(out.skeleton), skin.V, out);
  return out;
}

void measure_tissue(const Anatomy& anatomy, const Pose& pose, const Points& skin,
                    Patient& patient) {
  const NearestSurface surface(posed_bones(anatomy, pose));
  patient.thickness.assign(std::size_t(skin.rows()), 0);
  int hint = -1;
  for (Eigen::Index i = 0; i < skin.rows(); ++i) {
    const SurfacePoint nearest = surface.nearest(skin.row(i).transpose(), hint);
    hint = nearest.triangle;
    patient.thickness[std::size_t(i)] =
        std::clamp(nearest.distance, patient.tissue.thinnest, patient.tissue.thickest);
  }
}

Patient make_rigid_patient(const TriMesh& skin, double mass, const Vec3& inertia, double thickness,
                           const FleshOptions& tissue) {
  Patient out;
  const Vec3 low = skin.V.colwise().minCoeff(), high = skin.V.colwise().maxCoeff();
  Joint root;
  root.name = "body";
  root.X_PJ.translation() = (low + high) / 2;
  out.skeleton.joints = {root};
  out.segments = {{root.name, 0, mass, Vec3::Zero(), inertia.asDiagonal()}};
  out.skin = skin;
  out.weights.assign(std::size_t(skin.V.rows()), JointWeights{Influence{0, 1.0}});
  out.carrier.assign(std::size_t(skin.V.rows()), 0);
  out.area = vertex_areas(skin);
  out.thickness.assign(std::size_t(skin.V.rows()), thickness);
  out.region.assign(std::size_t(skin.V.rows()), 0);
  out.regions = {"body"};
  out.tissue = tissue;
  return out;
}

}  // namespace ecorche::inline v1
