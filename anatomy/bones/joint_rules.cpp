#include "anatomy/bones/joint_rules.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "anatomy/bones/mirror.h"
#include "anatomy/compute/linear_systems.h"
#include "anatomy/errors.h"
#include "anatomy/mesh_files/stl_io.h"

namespace ecorche::inline v1 {

Vec3 world_from_mjcf(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

namespace {
class JointPlacer {
 public:
  JointPlacer(const Table& table, const Mjcf& mjcf, const std::vector<Bone>& bones)
      : table_(table), mjcf_(mjcf), bones_(bones) {}

  Skeleton place() {
    for (row_ = 0; row_ < table_.rows(); ++row_)
      centers_[table_.text(row_, "name")] = center(table_.text(row_, "center"));
    Skeleton skeleton;
    for (row_ = 0; row_ < table_.rows(); ++row_) append(skeleton);
    return skeleton;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(
        fmt::format("{}: joint '{}': {}", table_.where(row_), table_.text(row_, "name"), message));
  }

  template <class Map>
  const auto& known(const Map& map, const std::string& name, const char* kind) const {
    const auto found = map.find(name);
    if (found == map.end()) fail(fmt::format("unknown {} '{}'", kind, name));
    return found->second;
  }

  const TriMesh& bone(const std::string& name) const {
    const auto found = std::find_if(bones_.begin(), bones_.end(), [&](const Bone& b) {
      return b.name == name || b.name == name + "_l";
    });
    if (found == bones_.end()) fail(fmt::format("unknown bone '{}'", name));
    return found->mesh;
  }

  std::vector<std::string> words(const std::string& text, std::size_t count,
                                 std::size_t most) const {
    std::istringstream in(text);
    std::vector<std::string> all;
    for (std::string word; in >> word;) all.push_back(word);
    if (all.size() < count || all.size() > most)
      fail(fmt::format("'{}' is not a rule; see the head of the table", text));
    return all;
  }

  // --- centres -------------------------------------------------------------------------
  Vec3 center(const std::string& rule) const {
    if (rule.starts_with("mid ")) {
      Vec3 c = center(rule.substr(4));
      c.x() = kSourceMidPlane;
      return c;
    }
    const auto w = words(rule, 2, 3);
    if (w[0] == "body")
      return world_from_mjcf(known(mjcf_.bodies, w[1], "MJCF body").translation());
    if (w[0] == "head" && w.size() == 3) return facing_end(bone(w[1]), bone(w[2]));
    if (w[0] == "disc" && w.size() == 3) return (front(bone(w[1])) + front(bone(w[2]))) / 2;
    if (w[0] == "axis" && w.size() == 3) return nearest_on_axis(w[1], surface_centroid(bone(w[2])));
    if (w[0] == "front") return front(bone(w[1]));
    if (w[0] == "top") return top(bone(w[1]));
    if (w[0] == "condyles") return condyles(bone(w[1]));
    if (w[0] == "glide") return glide_center(w[1]);
    fail(fmt::format("unknown rule '{}' for the centre", rule));
  }

  // Centroid of the surface in the last sixth of a bone's length on the side of another bone.
  static Vec3 facing_end(const TriMesh& mesh, const TriMesh& other) {
    const Vec3 middle = surface_centroid(mesh);
    const Points centred = mesh.V.rowwise() - middle.transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(centred.transpose() * centred);
    Vec3 axis = principal.eigenvectors().col(2);
    if (axis.dot(surface_centroid(other) - middle) < 0) axis = -axis;
    const Eigen::VectorXd along = centred * axis;
    return centroid_where(mesh, along,
                          along.maxCoeff() - (along.maxCoeff() - along.minCoeff()) / 6);
  }

  // Mean of the triangles' centroids, weighted by area, where the corners' mean value exceeds
  // `least`.
  static Vec3 centroid_where(const TriMesh& mesh, const Eigen::VectorXd& value, double least) {
    TriMesh part{mesh.V, Triangles(mesh.F.rows(), 3)};
    Eigen::Index count = 0;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      const auto face = mesh.F.row(f);
      if ((value[face[0]] + value[face[1]] + value[face[2]]) / 3 >= least)
        part.F.row(count++) = face;
    }
    part.F.conservativeResize(count, 3);
    return surface_centroid(part);
  }

  // A turn about an axis is the same about each of its points; one amid the bones is the best to
  // draw and to measure from.
  Vec3 nearest_on_axis(const std::string& name, const Vec3& target) const {
    const MjcfJoint& joint = known(mjcf_.joints, name, "MJCF joint");
    const Vec3 at = world_from_mjcf(joint.center), axis = world_from_mjcf(joint.axis);
    return at + axis * axis.dot(target - at);
  }

  // The foremost third: the body of a vertebra, the front arch of the atlas.
  static Vec3 front(const TriMesh& mesh) {
    const Eigen::VectorXd z = mesh.V.col(2);
    return centroid_where(mesh, z, z.maxCoeff() - (z.maxCoeff() - z.minCoeff()) / 3);
  }

  static Vec3 top(const TriMesh& mesh) {
    const Eigen::VectorXd y = mesh.V.col(1);
    return centroid_where(mesh, y, y.maxCoeff() - (y.maxCoeff() - y.minCoeff()) / 10);
  }

  // The condyles are the highest points of the jaw's hindmost quarter (the coronoid processes stand
  // further forward).
  static Vec3 condyles(const TriMesh& mesh) {
    const double back =
        mesh.V.col(2).minCoeff() + (mesh.V.col(2).maxCoeff() - mesh.V.col(2).minCoeff()) / 4;
    Vec3 highest[2] = {Vec3(0, -1e9, 0), Vec3(0, -1e9, 0)};
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      Vec3& best = highest[mesh.V(i, 0) > kSourceMidPlane];
      if (mesh.V(i, 2) < back && mesh.V(i, 1) > best.y()) best = mesh.V.row(i);
    }
    return (highest[0] + highest[1]) / 2;
  }

  // c minimises sum |c + R(share t) (p(0) - c) - p(t)|^2 over knee angles t, R about the knee's
  // axis, p(t) the patella's centre as the MJCF couples it to the knee.
  Vec3 glide_center(const std::string& name) const {
    const Vec3 start = surface_centroid(bone(name));
    const Vec3 axis = world_from_mjcf(known(mjcf_.joints, "knee_angle_l", "MJCF joint").axis);
    Eigen::MatrixXd A(0, 3);
    Eigen::VectorXd b(0);
    const auto add = [&](const Mat3& rows, const Vec3& right) {
      A.conservativeResize(A.rows() + 3, 3);
      b.conservativeResize(b.size() + 3);
      A.bottomRows(3) = rows;
      b.tail(3) = right;
    };
    for (double angle = 10; angle <= 110; angle += 10) {
      const Mat3 R = Eigen::AngleAxisd(kPatellaShare * angle * kDegree, axis).toRotationMatrix();
      add(Mat3::Identity() - R, coupled(name + "_l", start, angle * kDegree) - R * start);
    }
    add(1e-3 * axis * axis.transpose(),
        1e-3 * axis * axis.dot(start));  // nothing else holds it along the axis
    return solve_least_squares(A, b);
  }

  // Where the couplings of a body's joints to the knee carry a point of the neutral pose, at a knee
  // angle in rad.
  Vec3 coupled(const std::string& body, const Vec3& point, double angle) const {
    const Vec3 origin = world_from_mjcf(known(mjcf_.bodies, body, "MJCF body").translation());
    Vec3 shift = Vec3::Zero(), arm = point - origin;
    for (const MjcfCoupling& c : mjcf_.couplings) {
      const auto joint = mjcf_.joints.find(c.joint1);
      if (joint == mjcf_.joints.end() || joint->second.body != body) continue;
      double q = 0;  // beyond the neutral value
      for (std::size_t power = 4; power >= 1; --power) q = (q + c.coefficients[power]) * angle;
      const Vec3 axis = world_from_mjcf(joint->second.axis);
      if (joint->second.slide) {
        shift += q * axis;
      } else {
        arm = Eigen::AngleAxisd(q, axis) * arm;
      }
    }
    return origin + shift + arm;
  }

  // --- axes ----------------------------------------------------------------------------
  Vec3 direction(const std::string& word) const {
    if (word == "left") return Vec3::UnitX();
    if (word == "right") return -Vec3::UnitX();
    if (word == "up") return Vec3::UnitY();
    if (word == "down") return -Vec3::UnitY();
    if (word == "forward") return Vec3::UnitZ();
    if (word == "back") return -Vec3::UnitZ();
    fail(
        fmt::format("'{}' is no direction; expected left, right, up, down, forward or back", word));
  }

  Vec3 flexion_line(const std::string& rule) const {
    if (rule == "x") return Vec3::UnitX();
    if (rule == "y") return Vec3::UnitY();
    if (rule == "z") return Vec3::UnitZ();
    return mjcf_axis(rule);
  }

  Vec3 mjcf_axis(const std::string& rule) const {
    const auto w = words(rule, 2, 2);
    if (w[0] != "joint") fail(fmt::format("unknown axis '{}'", rule));
    return world_from_mjcf(known(mjcf_.joints, w[1], "MJCF joint").axis);
  }

  // Towards the far end of what the joint carries.
  Vec3 towards(const std::string& rule) const {
    if (!rule.starts_with("to ")) return direction(rule);
    const std::string name = words(rule, 2, 2)[1];
    const auto joint = centers_.find(name);
    const Vec3 target = joint != centers_.end() ? joint->second : surface_centroid(bone(name));
    return (target - centers_.at(table_.text(row_, "name"))).normalized();
  }

  Vec3 first_child(const std::string& name) const {
    for (int r = 0; r < table_.rows(); ++r) {
      if (table_.text(r, "parent") == name) return centers_.at(table_.text(r, "name"));
    }
    fail("a long axis by an MJCF joint needs a child joint");
  }

  Mat3 axes() const {
    const std::string& name = table_.text(row_, "name");
    const std::string& long_rule = table_.text(row_, "long");
    const bool long_is_exact = long_rule.starts_with("joint ");
    const Vec3 far =
        long_is_exact ? (first_child(name) - centers_.at(name)).normalized() : towards(long_rule);
    Vec3 flexion = flexion_line(table_.text(row_, "flexion_axis"));
    Vec3 rotation = long_is_exact ? mjcf_axis(long_rule) : far;
    if (long_is_exact) {
      flexion = (flexion - flexion.dot(rotation) * rotation).normalized();
    } else {
      rotation = (rotation - rotation.dot(flexion) * flexion).normalized();
    }
    Vec3 abduction = flexion.cross(rotation);
    flexion *= sense(flexion, far, "flexes");
    abduction *= sense(abduction, far, "abducts");
    Mat3 result;
    result << flexion, abduction, flexion.cross(abduction);
    return result;
  }

  double sense(const Vec3& axis, const Vec3& far, const char* column) const {
    const double motion = axis.cross(far).dot(direction(table_.text(row_, column)));
    if (std::abs(motion) < 0.05)
      fail(fmt::format("{} '{}' is square to the motion", column, table_.text(row_, column)));
    return motion > 0 ? 1 : -1;
  }

  // --- joints --------------------------------------------------------------------------
  void append(Skeleton& skeleton) const {
    const std::string& name = table_.text(row_, "name");
    Joint joint;
    joint.axes = axes();
    const char* columns[3] = {"flexion", "abduction", "rotation"};
    for (int a = 0; a < 3; ++a) {
      joint.min[a] = table_.number(row_, fmt::format("{}_min", columns[a])) * kDegree;
      joint.max[a] = table_.number(row_, fmt::format("{}_max", columns[a])) * kDegree;
      if (joint.min[a] > joint.max[a])
        fail(fmt::format("{}: the lower limit exceeds the upper one", columns[a]));
    }
    const std::string& paired = table_.text(row_, "paired");
    if (paired != "yes" && paired != "no")
      fail(fmt::format("paired '{}'; expected yes or no", paired));
    for (const char* suffix : {"_l", "_r"}) {
      if (paired == "no" && suffix[1] == 'r') break;
      Joint one = joint;
      one.name = paired == "yes" ? name + suffix : name;
      Vec3 at = centers_.at(name);
      if (suffix[1] == 'r') {
        at = mirror_point(at);
        // how a turning axis mirrors; stays right-handed
        one.axes.bottomRows(2) = -one.axes.bottomRows(2);
      }
      if (const std::string& parent = table_.text(row_, "parent"); !parent.empty()) {
        one.parent = std::max(find_joint(skeleton, parent), find_joint(skeleton, parent + suffix));
        if (one.parent < 0) fail(fmt::format("the parent '{}' does not precede it", parent));
        at -= rest_positions(skeleton)[one.parent];
      } else if (!skeleton.joints.empty()) {
        fail("a second joint without parent");
      }
      one.X_PJ.translation() = at;
      if (find_joint(skeleton, one.name) >= 0) fail("a second joint of this name");
      skeleton.joints.push_back(one);
    }
  }

  const Table& table_;
  const Mjcf& mjcf_;
  const std::vector<Bone>& bones_;
  std::map<std::string, Vec3> centers_;  // by name without side
  int row_ = 0;
};

}  // namespace

Skeleton place_joints(const Table& table, const Mjcf& mjcf, const std::vector<Bone>& bones) {
  return JointPlacer(table, mjcf, bones).place();
}

}  // namespace ecorche::inline v1
