#include "morph/placement/half_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

const Vec3& need(const NamedPoints& points, const std::string& name) {
  const auto it = points.find(name);
  if (it == points.end()) throw UnfitError(fmt::format("the skeleton has no point '{}'", name));
  return it->second;
}

const HalfBone* find(const HalfSkeleton& half, const std::string& name) {
  for (const HalfBone& bone : half.bones)
    if (bone.name == name) return &bone;
  return nullptr;
}

const HalfBone& need(const HalfSkeleton& half, const std::string& name) {
  if (const HalfBone* bone = find(half, name)) return *bone;
  throw UnfitError(fmt::format("the skeleton has no bone '{}'", name));
}

// Mean of the vertices that lie within `reach` of the furthest one from `from`, and that furthest
// vertex.
struct FarEnd {
  Vec3 tip, middle;
};
FarEnd far_end(const TriMesh& mesh, const Vec3& from, double reach) {
  int far = 0;
  (mesh.V.rowwise() - from.transpose()).rowwise().squaredNorm().maxCoeff(&far);
  FarEnd end{mesh.V.row(far), Vec3::Zero()};
  const Vec3 axis = (end.tip - from).normalized();
  double count = 0;
  for (int i = 0; i < mesh.V.rows(); ++i) {
    const Vec3 p = mesh.V.row(i);
    if (axis.dot(end.tip - p) > reach) continue;
    end.middle += p;
    ++count;
  }
  end.middle /= count;
  return end;
}

// Similarity in the mid-plane that takes a -> A and b -> B.
Vec3 carry_between(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& A, const Vec3& B) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(b - a, B - A);
  return A + (B - A).norm() / (b - a).norm() * (turn * (x - a));
}

Vec3 orthogonal(const Vec3& v, const Vec3& axis) { return (v - axis.dot(v) * axis).normalized(); }

Vec3 across_direction(const GroupRule& rule, const NamedPoints& points, const NamedPoints& hinges) {
  if (rule.across == "x") return Vec3::UnitX();
  if (rule.across == "y") return Vec3::UnitY();
  if (rule.across.starts_with("hinge:")) return need(hinges, rule.across.substr(6));
  const size_t arrow = rule.across.find('>');
  if (arrow == std::string::npos)
    throw UnfitError(
        fmt::format("bone_groups.csv: group '{}': unknown across '{}'", rule.name, rule.across));
  return need(points, rule.across.substr(arrow + 1)) - need(points, rule.across.substr(0, arrow));
}

Mat3 group_frame(const GroupRule& rule, const NamedPoints& points, const NamedPoints& hinges) {
  const Vec3 across = across_direction(rule, points, hinges);
  Mat3 frame = Mat3::Identity();
  if (!rule.paired) return frame;
  if (rule.far.empty()) {  // no long axis: upright, turned about the vertical
    frame.col(1) = Vec3::UnitY();
  } else {
    frame.col(1) = (need(points, rule.far) - need(points, rule.near)).normalized();
  }
  frame.col(0) = orthogonal(across, frame.col(1));
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace

std::vector<int> surface_samples(const TriMesh& mesh, int count) {
  const int n = mesh.V.rows();
  std::vector<int> out;
  if (n <= count) {
    for (int i = 0; i < n; ++i) out.push_back(i);
    return out;
  }
  Eigen::VectorXd away = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  const auto choose = [&](int i) {
    out.push_back(i);
    away = away.cwiseMin((mesh.V.rowwise() - mesh.V.row(i)).rowwise().squaredNorm());
  };
  for (int k = 0; k < 27; ++k) {
    const Vec3 d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    int i = 0;
    (mesh.V * d).maxCoeff(&i);
    if (away[i] > 0) choose(i);
  }
  while (int(out.size()) < count) {
    int i = 0;
    away.maxCoeff(&i);
    choose(i);
  }
  return out;
}

std::vector<int> watched_vertices(const TriMesh& mesh) {
  constexpr int kAll = 300, kDirections = 300, kSpread = 150;
  if (mesh.V.rows() <= kAll) return surface_samples(mesh, kAll);
  std::vector<int> out = surface_samples(mesh, kSpread);
  for (int k = 0; k < kDirections; ++k) {  // directions on a Fibonacci lattice
    const double y = 1 - (2 * k + 1.0) / kDirections, r = std::sqrt(1 - y * y),
                 turn = 2.399963229728653 * k;
    Eigen::Index i = 0;
    (mesh.V * Vec3(r * std::cos(turn), y, r * std::sin(turn))).maxCoeff(&i);
    out.push_back(int(i));
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

HalfSkeleton left_half(const Anatomy& anatomy, const FitRules& rules, double mid_plane,
                       double stature) {
  HalfSkeleton half;
  half.mid_plane = mid_plane;
  half.stature = stature;
  const std::vector<Vec3> positions = rest_positions(anatomy.skeleton);
  for (size_t j = 0; j < positions.size(); ++j) {
    const auto [name, side] = split_side(anatomy.skeleton.joints[j].name);
    if (side == Side::right) continue;
    half.points[name] = positions[j];
    half.hinges[name] = anatomy.skeleton.joints[j].axes.col(0);
  }
  for (const Bone& bone : anatomy.bones) {
    const auto [name, side] = split_side(bone.name);
    if (side == Side::right) continue;
    const auto group = rules.group_of_bone.find(name);
    if (group == rules.group_of_bone.end())
      throw UnfitError(fmt::format("bone '{}' is in no group of bone_groups.csv", bone.name));
    half.bones.push_back(
        {name, group->second, side == Side::left, bone.mesh, watched_vertices(bone.mesh)});
  }
  // The signs that guess_hinges gives: bending the knee and pulling up the foot turn about +x,
  // bending the elbow about -x.
  for (const auto& [joint, sign] :
       {std::pair("knee", 1.0), std::pair("ankle", 1.0), std::pair("elbow", -1.0)})
    if (Vec3& axis = half.hinges[joint]; axis.x() * sign < 0) axis = -axis;
  add_bone_points(half);
  return half;
}

void add_bone_points(HalfSkeleton& half) {
  NamedPoints& p = half.points;
  for (int k = 1; k <= 5; ++k) {
    const std::string n = std::to_string(k);
    p["tip" + n] =
        far_end(need(half, "distal_phalanx" + n).mesh, need(p, k == 1 ? "ip1" : "dip" + n), 1e-4)
            .tip;
    p["toe_tip" + n] = far_end(need(half, "toe_distal_phalanx" + n).mesh,
                               need(p, k == 1 ? "toe_ip1" : "toe_dip" + n), 1e-4)
                           .tip;
    if (k > 1)
      p["cmc" + n] = far_end(need(half, "metacarpal" + n).mesh, need(p, "mcp" + n), 4e-3).middle;
  }
  p["radioulnar"] = far_end(need(half, "ulna").mesh, need(p, "elbow"), 8e-3).middle;
  // The eye's middle, in shares of the skull's box (found on the package's skull).
  const TriMesh& skull = need(half, "skull").mesh;
  const Vec3 low = skull.V.colwise().minCoeff(), high = skull.V.colwise().maxCoeff();
  p["orbit"] = low + Vec3(0.72, 0.44, 0.83).cwiseProduct(high - low);
  // The foremost point of the chin, and the edge of the front teeth.
  const auto of_jaw = [&](const Vec3& direction, const Vec3& from, const Vec3& to) {
    LandmarkRule rule;
    rule.bone = "mandible";
    rule.direction = direction;
    rule.from = from;
    rule.to = to;
    const Vec3 at = find_landmark(half, rule).position;
    return Vec3(half.mid_plane, at.y(), at.z());
  };
  p["chin"] = of_jaw(Vec3::UnitZ(), {0.4, 0, 0}, {0.6, 1.0 / 3, 1});
  p["bite"] = of_jaw(Vec3::UnitY(), {0.4, 0, 0.85}, {0.6, 1, 1});
}

BonePoint find_landmark(const HalfSkeleton& half, const LandmarkRule& rule) {
  BonePoint best;
  double furthest = -1e300;
  for (size_t b = 0; b < half.bones.size(); ++b) {
    if (half.bones[b].name != rule.bone) continue;
    const Points& V = half.bones[b].mesh.V;
    const Vec3 low = V.colwise().minCoeff(), size = Vec3(V.colwise().maxCoeff()) - low;
    for (int i = 0; i < V.rows(); ++i) {
      const Vec3 p = V.row(i);
      const Vec3 share = (p - low).cwiseQuotient(size);
      if ((share.array() < rule.from.array()).any() || (share.array() > rule.to.array()).any())
        continue;
      const double reach = rule.direction.dot(p);
      if (reach > furthest) {
        furthest = reach;
        best = {int(b), i, half.bones[b].group, p};
      }
    }
  }
  if (furthest == -1e300)
    throw UnfitError(fmt::format("landmark '{}': no vertex of bone '{}' within its limits",
                                 rule.name, rule.bone));
  return best;
}

NamedPoints guess_centres(const FitRules& rules, const std::vector<Landmark>& cubes, Sex sex,
                          double stature) {
  constexpr double kMale = 1.748, kFemale = 1.605;  // statures that the offsets were found at
  const double size = stature / (sex == Sex::male ? kMale : kFemale);
  NamedPoints marks, out;
  for (const Landmark& cube : cubes) marks[cube.name] = cube.position;
  for (const CubeRule& rule : rules.cubes) {
    const Vec3& mark = need(marks, rule.cube);
    const Vec3 offset = size * (sex == Sex::male ? rule.male : rule.female);
    if (rule.toward.empty())
      out[rule.joint] = mark + offset;
    else
      out[rule.joint] = mark + offset.x() * (need(out, rule.toward) - mark).normalized();
  }
  out["pelvis"] = Vec3(0, out["hip"].y(), out["hip"].z());
  return out;
}

void complete_centres(const HalfSkeleton& source, NamedPoints& target) {
  const auto between = [&](const char* a, const char* b, std::initializer_list<const char*> names) {
    for (const char* name : names)
      if (!target.contains(name))
        target[name] = carry_between(need(source.points, name), need(source.points, a),
                                     need(source.points, b), need(target, a), need(target, b));
  };
  between("l5", "t12", {"l4", "l3", "l2", "l1"});
  between("t12", "c7", {"t11", "thorax"});
  between("c7", "head", {"c6", "c5", "c4", "c3", "c2", "c1"});
}

NamedPoints guess_hinges(const NamedPoints& c) {
  NamedPoints out;
  // The elbow is bent in the rest pose of skins: its axis is normal to the plane of the arm.
  // Flexion brings the hand forward.
  const Vec3 upper = need(c, "elbow") - need(c, "shoulder"),
             lower = need(c, "wrist") - need(c, "elbow");
  Vec3 elbow = upper.cross(lower);
  const Vec3 sideways = orthogonal(need(c, "mcp2") - need(c, "mcp5"), lower.normalized());
  elbow = elbow.norm() > 0.1 * upper.norm() * lower.norm() ? Vec3(elbow.normalized()) : sideways;
  out["elbow"] = elbow;
  // Knee and ankle turn about an axis across the direction that the foot points to, which at the
  // knee lies halfway to straight on.
  Vec3 foot = need(c, "mtp2") - need(c, "ankle");
  foot.y() = 0;
  foot.normalize();
  const Vec3 leg = (need(c, "knee") - need(c, "hip")).normalized(),
             shank = (need(c, "ankle") - need(c, "knee")).normalized();
  const Vec3 ahead = (foot + Vec3::UnitZ()).normalized();
  out["knee"] = orthogonal(ahead.cross(leg + shank), (leg + shank).normalized());
  out["ankle"] = orthogonal(foot.cross(shank), shank);
  return out;
}

BoneMap expected_map(const GroupRule& rule, const NamedPoints& source,
                     const NamedPoints& source_hinges, const NamedPoints& target,
                     const NamedPoints& target_hinges, double width) {
  BoneMap map;
  map.origin = need(source, rule.near);
  map.target_origin = need(target, rule.near);
  map.frame = group_frame(rule, source, source_hinges);
  map.target_frame = group_frame(rule, target, target_hinges);
  map.shaft = rule.shaft;
  map.shape[BoneMap::log_length] = map.shape[BoneMap::log_width_x] =
      map.shape[BoneMap::log_width_z] = std::log(width);
  if (!rule.far.empty()) {
    const Vec3 a = need(source, rule.far) - map.origin,
               b = need(target, rule.far) - map.target_origin;
    map.length = rule.paired ? a.norm() : std::abs(a.y());
    if (rule.paired) map.shape[BoneMap::log_length] = std::log(b.norm() / a.norm());
  }
  return map;
}

}  // namespace ecorche::inline v1
