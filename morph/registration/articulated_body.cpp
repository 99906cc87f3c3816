#include "morph/registration/articulated_body.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

// Components of each sex's own variation, and how much of it counts once both are together.
constexpr Eigen::Index kOwnComponents = 25;
constexpr double kOwnShare = std::numbers::sqrt2 / 2;
// Turns about the long axis up to this are usual at any joint, rad.
constexpr double kLeastTwist = 0.4;
// The child whose build is one of the directions, years; its spread in standard deviations.
constexpr double kChild = 8, kChildSpread = 0.35;

struct SegmentRule {
  const char* name;
  const char* parent;
  const char* first;      // bone of the rig whose head is the joint's centre
  double bend, twist;     // rad
  double most;            // degrees; 0: any
  double skin_twist = 0;  // rad, where skin turns otherwise than the bone
};
// Middle, and left of the paired ones. Skin over the shoulder hardly turns about the arm, that over
// the elbow wholly: once the body stands, what turns does so in the twist segment.
constexpr SegmentRule kMiddle[] = {{"pelvis", "", "root", 3, 3, 0},
                                   {"loin", "pelvis", "spine04", 0.25, 0.15, 45},
                                   {"trunk", "loin", "spine03", 0.25, 0.2, 45},
                                   {"chest", "trunk", "spine02", 0.25, 0.2, 45},
                                   {"neck", "chest", "neck01", 0.3, 0.3, 50},
                                   {"head", "neck", "head", 0.3, 0.4, 60}};
constexpr SegmentRule kPaired[] = {{"girdle", "chest", "clavicle", 0.3, 0.1, 50},
                                   {"arm", "girdle", "upperarm01", 1.2, 0.6, 0, 0.15},
                                   {"arm_twist", "arm", "upperarm02", 0.04, 0.5, 0, 1.0},
                                   {"forearm", "arm_twist", "lowerarm01", 1.2, 0.3, 0},
                                   {"forearm_twist", "forearm", "lowerarm02", 0.04, 0.7, 0},
                                   {"hand", "forearm_twist", "wrist", 0.5, 0.2, 90},
                                   {"thumb", "hand", "finger1-1", 0.3, 0.2, 70},
                                   {"fingers", "hand", "finger3-1", 0.5, 0.05, 110},
                                   {"thigh", "pelvis", "upperleg01", 0.9, 0.4, 0},
                                   {"thigh_twist", "thigh", "upperleg02", 0.04, 0.3, 50},
                                   {"shank", "thigh_twist", "lowerleg01", 0.9, 0.15, 0},
                                   {"shank_twist", "shank", "lowerleg02", 0.04, 0.2, 40},
                                   {"foot", "shank_twist", "foot", 0.35, 0.2, 55},
                                   {"toes", "foot", "toe2-1", 0.2, 0.05, 60}};

struct BonePrefix {
  const char* prefix;
  const char* segment;
};
// Bones of the default rig by the beginning of their names; all others are of the head.
constexpr BonePrefix kBones[] = {{"root", "pelvis"},
                                 {"pelvis", "pelvis"},
                                 {"spine05", "pelvis"},
                                 {"spine04", "loin"},
                                 {"spine03", "trunk"},
                                 {"spine02", "chest"},
                                 {"spine01", "chest"},
                                 {"breast", "chest"},
                                 {"neck", "neck"},
                                 {"clavicle", "girdle"},
                                 {"shoulder", "girdle"},
                                 {"upperarm01", "arm"},
                                 {"upperarm02", "arm_twist"},
                                 {"lowerarm01", "forearm"},
                                 {"lowerarm02", "forearm_twist"},
                                 {"wrist", "hand"},
                                 {"metacarpal", "hand"},
                                 {"finger1", "thumb"},
                                 {"finger2", "fingers"},
                                 {"finger3", "fingers"},
                                 {"finger4", "fingers"},
                                 {"finger5", "fingers"},
                                 {"upperleg01", "thigh"},
                                 {"upperleg02", "thigh_twist"},
                                 {"lowerleg01", "shank"},
                                 {"lowerleg02", "shank_twist"},
                                 {"foot", "foot"},
                                 {"toe", "toes"}};

std::string sided(const std::string& name, Side side) {
  return name.empty() ? name : name + side_suffix(side);
}

bool is_middle(const std::string& name) {
  return std::any_of(std::begin(kMiddle), std::end(kMiddle),
                     [&](const SegmentRule& rule) { return name == rule.name; });
}

std::string segment_of(const std::string& bone) {
  std::string segment = "head";
  for (const auto& [prefix, name] : kBones)
    if (bone.starts_with(prefix)) segment = name;
  if (is_middle(segment)) return segment;
  return sided(segment, bone.ends_with(".L") ? Side::left : Side::right);
}

void add_joint(ArticulatedBody& body, const SegmentRule& rule, Side side) {
  SegmentJoint joint;
  joint.name = sided(rule.name, side);
  joint.side = side;
  const bool middle = *rule.parent == 0 || is_middle(rule.parent);
  joint.parent = find_segment(body, middle ? rule.parent : sided(rule.parent, side));
  joint.bend = rule.bend;
  joint.twist = rule.twist;
  joint.skin_twist = rule.skin_twist > 0 ? rule.skin_twist : rule.twist;
  joint.most = rule.most * kDegree;
  body.joints.push_back(joint);
}

int rig_bone(const Rig& rig, const SegmentRule& rule, Side side) {
  std::string name = rule.first;
  if (side != Side::middle) name += side == Side::left ? ".L" : ".R";
  const auto found = std::find(rig.names.begin(), rig.names.end(), name);
  if (found == rig.names.end())
    throw InputError("the body package's default rig has no bone " + name);
  return int(found - rig.names.begin());
}

// Both sexes as one space: half their difference, and each one's own variation.
void join_spaces(const BodyModel& model, ArticulatedBody& out) {
  const ShapeSpace& male = model.adults(Sex::male);
  const ShapeSpace& female = model.adults(Sex::female);
  const Eigen::Index rows = male.basis.rows();
  const Eigen::Index m = std::min(kOwnComponents, male.basis.cols()),
                     f = std::min(kOwnComponents, female.basis.cols());
  out.mean = (male.mean + female.mean) / 2;
  const auto flat = [&](const Points& points) {
    return Eigen::Map<const Eigen::VectorXd>(points.data(), rows);
  };
  out.basis.resize(rows, 2 + m + f);
  const Points sexes = (male.mean - female.mean) / 2;
  out.basis.col(0) = flat(sexes).cast<float>();
  const Points child = kChildSpread *
                       (model.people(Sex::male, kChild).mean +
                        model.people(Sex::female, kChild).mean - male.mean - female.mean) /
                       2;
  out.basis.col(1) = flat(child).cast<float>();
  out.basis.middleCols(2, m) = float(kOwnShare) * male.basis.leftCols(m);
  out.basis.rightCols(f) = float(kOwnShare) * female.basis.leftCols(f);
}

// Weights of the segments, and joint centres as rings of the skin: where a joint's segments take
// over from its parent's, moved by as much as the rig's own centre lies off.
void add_weights(const BodyModel& model, ArticulatedBody& out) {
  const BodyPackage& package = model.package();
  const Rig rig = read_rig(package, "default", package.points);
  std::vector<int> segment(rig.names.size());
  for (std::size_t b = 0; b < rig.names.size(); ++b)
    segment[b] = find_segment(out, segment_of(rig.names[b]));
  out.weights.start.push_back(0);
  for (int i = 0; i < package.skin_size; ++i) {
    std::map<int, double> row;
    for (int k = rig.weights.start[i]; k < rig.weights.start[i + 1]; ++k)
      row[segment[rig.weights.bone[k]]] += rig.weights.weight[k];
    for (const auto& [joint, weight] : row) {
      out.weights.bone.push_back(joint);
      out.weights.weight.push_back(weight);
    }
    out.weights.start.push_back(int(out.weights.bone.size()));
  }

  const std::size_t count = out.joints.size();
  std::vector<int> bone;
  for (const SegmentRule& rule : kMiddle) bone.push_back(rig_bone(rig, rule, Side::middle));
  for (const Side side : {Side::left, Side::right})
    for (const SegmentRule& rule : kPaired) bone.push_back(rig_bone(rig, rule, side));
  out.joint_mean.resize(Eigen::Index(count), 3);
  out.joint_basis.setZero(Eigen::Index(3 * count), out.basis.cols());
  const Points package_skin = package.points.topRows(package.skin_size);
  for (std::size_t j = 0; j < count; ++j) {
    Vec3 ring = Vec3::Zero(), own = Vec3::Zero();
    ShapeBasis moved = ShapeBasis::Zero(3, out.basis.cols());
    double sum = 0;
    for (int i = 0; i < package.skin_size; ++i) {
      double inside = 0;
      for (int k = out.weights.start[i]; k < out.weights.start[i + 1]; ++k)
        for (int b = out.weights.bone[k]; b >= 0; b = out.joints[b].parent)
          if (b == int(j)) inside += out.weights.weight[k];
      // The root has no ring: all of its own segment.
      double share = inside * (1 - inside);
      if (j == 0) {
        share = 0;
        for (int k = out.weights.start[i]; k < out.weights.start[i + 1]; ++k)
          if (out.weights.bone[k] == 0) share = out.weights.weight[k];
      }
      if (share <= 1e-6) continue;
      sum += share;
      ring += share * out.mean.row(i).transpose();
      own += share * package_skin.row(i).transpose();
      moved += float(share) * out.basis.middleRows(3 * i, 3);
    }
    if (sum <= 0) throw InputError("no skin about the joint " + out.joints[j].name);
    out.joint_mean.row(Eigen::Index(j)) =
        (ring / sum + rig.heads[std::size_t(bone[j])] - own / sum).transpose();
    out.joint_basis.middleRows(Eigen::Index(3 * j), 3) = moved / float(sum);
    out.joints[j].axis =
        (rig.tails[std::size_t(bone[j])] - rig.heads[std::size_t(bone[j])]).normalized();
  }
}

// Elbows and knees bend one way; fingers curl.
void add_hinges(ArticulatedBody& body) {
  for (const Side side : {Side::left, Side::right}) {
    const auto centre = [&](const char* name) -> Vec3 {
      return body.joint_mean.row(find_segment(body, sided(name, side))).transpose();
    };
    const auto joint = [&](const char* name) -> SegmentJoint& {
      return body.joints[std::size_t(find_segment(body, sided(name, side)))];
    };
    const Vec3 arm = centre("forearm") - centre("arm"),
               forearm = centre("hand") - centre("forearm");
    SegmentJoint& elbow = joint("forearm");
    elbow.hinge = arm.cross(forearm).normalized();
    // A straight arm does not tell: forwards.
    if (arm.normalized().cross(forearm.normalized()).norm() < 0.05)
      elbow.hinge = arm.cross(Vec3::UnitZ()).normalized();
    elbow.hinge_min = -std::acos(arm.normalized().dot(forearm.normalized())) - 0.15;
    elbow.hinge_max = 2.6;
    SegmentJoint& knee = joint("shank");
    knee.hinge = Vec3::UnitX();
    knee.hinge_min = -0.2;
    knee.hinge_max = 2.6;
  }
}

}  // namespace

int find_segment(const ArticulatedBody& body, const std::string& name) {
  for (std::size_t j = 0; j < body.joints.size(); ++j)
    if (body.joints[j].name == name) return int(j);
  return -1;
}

double squared_turn(const SegmentJoint& joint, const Mat3& turn) {
  const Eigen::AngleAxisd whole(turn);
  const Vec3 way = whole.angle() * whole.axis();
  const double along = way.dot(joint.axis), twist = std::max(joint.twist, kLeastTwist);
  double out = along * along / (twist * twist) +
               (way.squaredNorm() - along * along) / (joint.bend * joint.bend);
  if (joint.hinge.squaredNorm() > 0) {
    const double flexed = way.dot(joint.hinge);
    const double beyond = std::max({0.0, joint.hinge_min - flexed, flexed - joint.hinge_max});
    out += 25 * beyond * beyond;
  }
  return out;
}

double mean_squared_turn(const ArticulatedBody& body, const std::vector<Mat3>& turns) {
  double sum = 0;
  for (std::size_t j = 1; j < body.joints.size(); ++j)
    sum += squared_turn(body.joints[j], turns[j]);
  return sum / double(body.joints.size());
}

ArticulatedBody make_articulated_body(const BodyModel& model) {
  const BodyPackage& package = model.package();
  ArticulatedBody out;
  for (const SegmentRule& rule : kMiddle) add_joint(out, rule, Side::middle);
  for (const Side side : {Side::left, Side::right})
    for (const SegmentRule& rule : kPaired) add_joint(out, rule, side);
  join_spaces(model, out);
  add_weights(model, out);
  add_hinges(out);
  out.F = package.triangles;
  out.parts = vertex_parts(package);
  out.mirror.assign(package.mirror.begin(), package.mirror.begin() + package.skin_size);
  std::set<int> inner;
  for (const Cavity& cavity : package.cavities) {
    for (const int q : cavity.quads)
      for (int k = 0; k < 4; ++k) inner.insert(package.quads(q, k));
    for (const int rim : cavity.loop) inner.erase(rim);
  }
  out.outer.assign(std::size_t(package.skin_size), 1);
  for (const int i : inner) out.outer[std::size_t(i)] = 0;
  out.area.assign(std::size_t(package.skin_size), 0);
  for (Eigen::Index f = 0; f < out.F.rows(); ++f) {
    const Vec3 a = out.mean.row(out.F(f, 0)), b = out.mean.row(out.F(f, 1)),
               c = out.mean.row(out.F(f, 2));
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k)
      if (out.outer[std::size_t(out.F(f, k))]) out.area[std::size_t(out.F(f, k))] += third;
  }
  return out;
}

ArticulatedState rest_state(const ArticulatedBody& body) {
  ArticulatedState out;
  out.z.setZero(body.basis.cols());
  out.turns.assign(body.joints.size(), Mat3::Identity());
  return out;
}

RestShape rest_shape(const ArticulatedBody& body, const Eigen::VectorXd& z) {
  const Eigen::VectorXf factors = z.cast<float>();
  const auto shaped = [&](const Points& mean, const ShapeBasis& basis) -> Points {
    const Eigen::VectorXf d = basis * factors;
    return mean + Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                      d.data(), mean.rows(), 3)
                      .cast<double>();
  };
  RestShape out{shaped(body.mean, body.basis), {}, shaped(body.joint_mean, body.joint_basis)};
  out.normals = vertex_normals({out.skin, body.F});
  return out;
}

ArticulatedPose articulate(const ArticulatedBody& body, const RestShape& shape,
                           const ArticulatedState& state) {
  ArticulatedPose out{shape, {}, {}};
  out.scale = std::exp(state.log_scale);
  out.shift = state.shift;
  out.turns.resize(body.joints.size());
  out.places.resize(body.joints.size());
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    const int p = body.joints[j].parent;
    const Vec3 centre = shape.centres.row(Eigen::Index(j));
    if (p < 0) {
      out.turns[j] = state.turns[j];
      out.places[j] = centre;
    } else {
      out.turns[j] = out.turns[std::size_t(p)] * state.turns[j];
      out.places[j] = out.places[std::size_t(p)] +
                      out.turns[std::size_t(p)] * (centre - shape.centres.row(p).transpose());
    }
  }
  return out;
}

Points posed_points(const ArticulatedBody& body, const ArticulatedPose& pose,
                    const std::vector<int>& vertices) {
  const Eigen::Index count =
      vertices.empty() ? pose.shape.skin.rows() : Eigen::Index(vertices.size());
  Points out(count, 3);
  for (Eigen::Index r = 0; r < count; ++r) {
    const int i = vertices.empty() ? int(r) : vertices[std::size_t(r)];
    const Vec3 rest = pose.shape.skin.row(i);
    Vec3 sum = Vec3::Zero();
    for (int k = body.weights.start[i]; k < body.weights.start[i + 1]; ++k) {
      const int j = body.weights.bone[k];
      sum += body.weights.weight[k] *
             (pose.turns[j] * (rest - pose.shape.centres.row(j).transpose()) + pose.places[j]);
    }
    out.row(r) = (pose.scale * sum + pose.shift).transpose();
  }
  return out;
}

Mat3 blended_turn(const ArticulatedBody& body, const ArticulatedPose& pose, int vertex) {
  Mat3 sum = Mat3::Zero();
  for (int k = body.weights.start[vertex]; k < body.weights.start[vertex + 1]; ++k)
    sum += body.weights.weight[k] * pose.turns[body.weights.bone[k]];
  return pose.scale * sum;
}

}  // namespace ecorche::inline v1
