#include "skinning/checks/bulges.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "anatomy/joint_angles.h"
#include "anatomy/muscles/slice_outline.h"
#include "skinning/character/evaluate.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kFlexed = 1.7453292519943295;  // rad

// Published measurements: change of thickness at full effort with the joint held, as a share
// of the relaxed thickness.
struct PublishedBulge {
  const char* muscle;
  double low, high;
  const char* what;
};
constexpr PublishedBulge kPublished[] = {
    {"gastrocnemius_lateral_l", 0.25, 0.55, "+5 to +7 mm, +36 to +47 % (Maganaris 1998)"},
    {"gastrocnemius_medial_l", -0.1, 0.1, "0, not significant (Maganaris 1998)"},
    {"soleus_l", 0.25, 0.55, "+6 to +7 mm, +38 to +47 % (Maganaris 1998)"},
    {"tibialis_anterior_l", -0.1, 0.1,
     "unchanged (Maganaris 1999, recalled); belly shortens and its section grows (Raiteri 2016)"},
    {"masseter_superficial_l", 0.2, 0.65,
     "men +5.4 mm, +56 % (Kiliaridis 1991); +3.4 mm, +30 % (Park 2018)"},
};

// Shares of a belly's length between which it was scanned.
constexpr double kScannedFrom = 0.25, kScannedTo = 0.75;

double width_along(const Ellipse& section, const Vec3& direction) {
  const Vec2 axes = section.radii.cwiseProduct(section.axes.leftCols<2>().transpose() * direction);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < outline_directions().size(); ++k) {
    const double along = double(section.outline[k]) * axes.dot(outline_directions()[k]);
    low = std::min(low, along), high = std::max(high, along);
  }
  return high - low;
}

// The direction in which a section is least wide.
Vec3 thin_direction(const Ellipse& section) {
  constexpr int kDirections = 90;
  Vec3 thin = section.axes.col(1);
  for (int d = 0; d < kDirections; ++d) {
    const double angle = d * std::numbers::pi / kDirections;
    const Vec3 direction =
        std::cos(angle) * section.axes.col(0) + std::sin(angle) * section.axes.col(1);
    if (width_along(section, direction) < width_along(section, thin)) thin = direction;
  }
  return thin;
}

int root_of(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Perimeter of the convex hull (Andrew's monotone chain).
double hull_perimeter(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  if (points.size() < 3) return 0;
  std::vector<Vec2> hull;
  const auto add = [&](const Vec2& p, std::size_t least) {
    while (hull.size() > least) {
      const Vec2 a = hull.back() - hull[hull.size() - 2], b = p - hull.back();
      if (a.x() * b.y() - a.y() * b.x() > 0) break;
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const Vec2& p : points) add(p, 1);
  const std::size_t lower = hull.size();
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  double length = 0;
  for (std::size_t i = 0; i + 1 < hull.size(); ++i) length += (hull[i + 1] - hull[i]).norm();
  return length;
}

// The skin that goes mostly with the upper arm: a plane across a bent arm cuts the forearm too, and
// the trunk, which beside a heavy body's armpit is one piece with the arm.
Triangles upper_arm_skin(const CharacterModel& model) {
  const Skeleton& skeleton = model.character.anatomy.skeleton;
  const int shoulder = find_joint(skeleton, "shoulder_l"), elbow = find_joint(skeleton, "elbow_l");
  std::vector<char> inside(skeleton.joints.size(), 0);
  for (int j = shoulder; j < int(inside.size()); ++j) {  // parents come first
    const int parent = skeleton.joints[j].parent;
    inside[j] = j == shoulder || (parent >= 0 && inside[parent] && j != elbow);
  }
  const auto share = [&](int v) {
    double sum = 0;
    for (const Influence& influence : model.binding.joint_weights[v])
      if (inside[influence.joint]) sum += influence.weight;
    return sum;
  };
  const Triangles& all = model.character.body.skin.F;
  Triangles out(all.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < all.rows(); ++f)
    if (share(all(f, 0)) + share(all(f, 1)) + share(all(f, 2)) > 1.5) out.row(count++) = all.row(f);
  out.conservativeResize(count, 3);
  return out;
}

double arm_girth(const CharacterModel& model, const CharacterState& frame, const Triangles& arm,
                 double from, double to) {
  const Skeleton& skeleton = model.character.anatomy.skeleton;
  const Vec3 shoulder = frame.posed.X_WJ[find_joint(skeleton, "shoulder_l")].translation();
  const Vec3 elbow = frame.posed.X_WJ[find_joint(skeleton, "elbow_l")].translation();
  TriMesh skin;
  to_points(frame.skin, skin.V);
  skin.F = arm;
  double girth = 0;
  for (double share = from; share <= to + 1e-9; share += 0.025)
    girth = std::max(girth, tape_girth(skin, shoulder + share * (elbow - shoulder),
                                       (elbow - shoulder).normalized()));
  return girth;
}

void measure_arm(const CharacterModel& model, Bulges& bulges) {
  const Anatomy& anatomy = model.character.anatomy;
  const Skeleton& skeleton = anatomy.skeleton;
  bulges.arm_relaxed = bulges.arm_flexed = bulges.arm_tensed =
      std::numeric_limits<double>::quiet_NaN();
  const int elbow = find_joint(skeleton, "elbow_l"), forearm = find_joint(skeleton, "forearm_l");
  if (elbow < 0 || forearm < 0 || find_joint(skeleton, "shoulder_l") < 0) return;
  const Triangles arm = upper_arm_skin(model);
  CharacterState frame(model);
  Pose pose = rest_pose(skeleton);
  evaluate_skin(model, pose, {}, frame);
  bulges.arm_relaxed = arm_girth(model, frame, arm, 0.5, 0.5);
  const auto turn = [&](int j, int axis, double angle) {
    const Joint& joint = skeleton.joints[j];
    Vec3 angles = joint_angles(joint, Quat::Identity());
    angles[axis] = angle;
    pose.rotations[j] = joint_rotation(joint, angles);
  };
  turn(elbow, 0, kFlexed);
  turn(forearm, 2, skeleton.joints[forearm].max.z());
  evaluate_skin(model, pose, {}, frame);
  bulges.arm_flexed = arm_girth(model, frame, arm, 0.4, 0.65);
  std::vector<double> effort;
  for (const Muscle& muscle : anatomy.muscles) effort.push_back(muscle.group == "arm" ? 1.0 : 0.0);
  evaluate_skin(model, pose, {effort}, frame);
  bulges.arm_tensed = arm_girth(model, frame, arm, 0.4, 0.65);
}

}  // namespace

double tape_girth(const TriMesh& skin, const Vec3& point, const Vec3& normal) {
  const auto height = [&](int i) { return (skin.V.row(i).transpose() - point).dot(normal); };
  std::map<std::pair<int, int>, int> index;  // of cut edges
  std::vector<Vec3> points;
  std::vector<int> parent;
  const auto cut = [&](int a, int b) {
    const auto [at, fresh] = index.try_emplace(std::minmax(a, b), int(points.size()));
    if (fresh) {
      const double ha = height(a), hb = height(b);
      points.push_back(skin.V.row(a).transpose() +
                       ha / (ha - hb) * (skin.V.row(b) - skin.V.row(a)).transpose());
      parent.push_back(at->second);
    }
    return at->second;
  };
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    std::array<int, 2> ends{};
    int found = 0;
    for (int i = 0; i < 3; ++i) {
      const int a = skin.F(f, i), b = skin.F(f, (i + 1) % 3);
      if ((height(a) < 0) != (height(b) < 0) && found < 2) ends[found++] = cut(a, b);
    }
    if (found == 2) parent[root_of(parent, ends[0])] = root_of(parent, ends[1]);
  }
  if (points.empty()) return 0;
  std::map<int, std::pair<Vec3, int>> pieces;  // sum of points, count
  for (int i = 0; i < int(points.size()); ++i) {
    auto& [sum, count] = pieces.try_emplace(root_of(parent, i), Vec3::Zero(), 0).first->second;
    sum += points[i];
    ++count;
  }
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [piece, of] : pieces) {
    const double distance = (of.first / of.second - point).norm();
    if (distance < least) least = distance, nearest = piece;
  }
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vec2> outline;
  for (int i = 0; i < int(points.size()); ++i)
    if (root_of(parent, i) == nearest) outline.emplace_back(points[i].dot(u), points[i].dot(v));
  return hull_perimeter(std::move(outline));
}

Bulges measure_bulges(const CharacterModel& model) {
  Bulges bulges;
  measure_arm(model, bulges);
  const Anatomy& anatomy = model.character.anatomy;
  const Pose pose = rest_pose(anatomy.skeleton);
  CharacterState relaxed(model), tense(model);
  evaluate(model, pose, {}, relaxed);
  const std::vector<double> effort(anatomy.muscles.size(), 1.0);
  evaluate(model, pose, {effort}, tense);
  for (const PublishedBulge& published : kPublished) {
    const int m = find_muscle(anatomy, published.muscle);
    Thickening found{published.muscle, 0, 0, published.low, published.high, published.what};
    int sections = 0;
    for (const SliceRange& range : slice_ranges(anatomy)) {
      if (range.muscle != m) continue;
      const Strip& strip = anatomy.muscles[m].strips[range.strip];
      const double belly = strip.belly_end - strip.belly_begin;
      for (int k = range.begin; k < range.end; ++k) {
        const double share = (strip.slices[k - range.begin].s - strip.belly_begin) / belly;
        if (share < kScannedFrom || share > kScannedTo) continue;
        const Vec3 probe = thin_direction(relaxed.posed.slices[k]);
        found.relaxed += width_along(relaxed.posed.slices[k], probe);
        found.tense += width_along(tense.posed.slices[k], probe);
        ++sections;
      }
    }
    if (sections == 0) continue;
    found.relaxed /= sections, found.tense /= sections;
    bulges.muscles.push_back(std::move(found));
  }
  return bulges;
}

std::vector<Target> bulge_targets(const Bulges& bulges) {
  std::vector<Target> out;
  for (const Thickening& m : bulges.muscles) {
    const double change = m.tense / m.relaxed - 1;
    out.push_back({fmt::format("thickening of {} at full effort", m.muscle),
                   fmt::format("{:+.0f} .. {:+.0f} %", 100 * m.low, 100 * m.high),
                   fmt::format("{:+.0f} %", 100 * change), change >= m.low && change <= m.high});
  }
  return out;
}

std::string bulge_table(const Bulges& bulges) {
  std::string out = fmt::format("\n{:<28} {:>12} {:>12} {:>16}  {}\n", "bulge", "relaxed", "tense",
                                "change", "measured in people");
  if (std::isfinite(bulges.arm_relaxed)) {
    out += fmt::format("{:<28} {:>9.1f} cm {:>9.1f} cm {:>+13.1f} cm  {}\n",
                       "upper arm girth, flexed", 100 * bulges.arm_relaxed, 100 * bulges.arm_tensed,
                       100 * (bulges.arm_tensed - bulges.arm_relaxed),
                       "trained men +2 to +4 cm; untrained men +1.5 to +2.5; women +0.8 to +1.5");
    out += fmt::format("{:<28} {:>9.1f} cm {:>9.1f} cm {:>+13.1f} cm\n", "  of it without effort",
                       100 * bulges.arm_relaxed, 100 * bulges.arm_flexed,
                       100 * (bulges.arm_flexed - bulges.arm_relaxed));
  }
  for (const Thickening& m : bulges.muscles)
    out += fmt::format("{:<28} {:>9.1f} mm {:>9.1f} mm {:>+8.1f} mm {:>+3.0f} %  {}\n", m.muscle,
                       1e3 * m.relaxed, 1e3 * m.tense, 1e3 * (m.tense - m.relaxed),
                       100 * (m.tense / m.relaxed - 1), m.published);
  return out;
}

}  // namespace ecorche::inline v1
