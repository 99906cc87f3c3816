#include "morph/place_bones.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <tbb/parallel_for.h>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

constexpr int kSamplesPerBone = 60;
constexpr int kPushRounds = 6;

bool in_hand(const std::string& group) {
  return group == "carpus" || group.starts_with("metacarpal") || group.find("_phalanx") != std::string::npos;
}

// The group whose place a known point determines: the one that begins there, else one that ends there, else a contact's first.
int group_of_point(const FitRules& rules, const std::string& point) {
  if (point == "orbit") return rules.group_of_bone.at("skull");
  for (size_t g = 0; g < rules.groups.size(); ++g)
    if (rules.groups[g].near == point && point != "pelvis") return static_cast<int>(g);
  for (size_t g = 0; g < rules.groups.size(); ++g)
    if (rules.groups[g].far == point) return static_cast<int>(g);
  for (const ContactRule& contact : rules.contacts)
    if (contact.point == point) return contact.a;
  return -1;
}

Vec3 contact_direction(const ContactRule& rule, const HalfSkeleton& half) {
  if (rule.along == "x") return Vec3::UnitX();
  if (rule.along == "z") return Vec3::UnitZ();
  const auto axis = half.hinges.find(rule.point);
  return axis == half.hinges.end() ? Vec3::UnitX() : axis->second;
}

void add_contacts(const PlaceInput& input, const FitRules& rules, BoneProblem& problem) {
  for (const ContactRule& rule : rules.contacts) {
    const auto at = input.source->points.find(rule.point);
    if (at == input.source->points.end()) throw UnfitError(fmt::format("bone_contacts.csv: the skeleton has no joint '{}'", rule.point));
    const Vec3 p = at->second;
    problem.joints.push_back({rule.a, rule.b, p, p, rule.tolerance});
    if (rule.along.empty()) continue;
    const Vec3 side = rule.spread * contact_direction(rule, *input.source);
    problem.joints.push_back({rule.a, rule.b, p + side, p + side, rule.loose});
    problem.joints.push_back({rule.a, rule.b, p - side, p - side, rule.loose});
  }
}

BoneProblem state_problem(const PlaceInput& input, const FitRules& rules) {
  const HalfSkeleton& source = *input.source;
  NamedPoints centres = input.centres;
  complete_centres(source, centres);
  const NamedPoints hinges = guess_hinges(centres);
  BoneProblem problem;
  problem.groups.resize(rules.groups.size());
  // Groups whose near point is not known from the skin are carried by the one before them.
  const std::map<std::string, std::string> carriers{{"cmc2", "carpus"}, {"cmc3", "carpus"}, {"cmc4", "carpus"}, {"cmc5", "carpus"},
                                                    {"patella", "femur"}};
  std::map<std::string, int> index;
  for (size_t g = 0; g < rules.groups.size(); ++g) index[rules.groups[g].name] = static_cast<int>(g);
  for (size_t g = 0; g < rules.groups.size(); ++g) {
    const GroupRule& rule = rules.groups[g];
    if (!centres.contains(rule.near)) {
      const auto carrier = carriers.find(rule.near);
      if (carrier == carriers.end()) throw UnfitError(fmt::format("nothing says where '{}' is in the skin", rule.near));
      centres[rule.near] = problem.groups[index.at(carrier->second)].map(source.points.at(rule.near));
    }
    BoneGroup& group = problem.groups[g];
    group.map = expected_map(rule, source.points, source.hinges, centres, hinges, input.size);
    group.expected = group.map;
    group.freedom = rule.freedom;
    for (double& tolerance : group.freedom) tolerance *= input.freedom;
  }
  for (const auto& [name, tolerance] : input.tolerances) {
    const int group = group_of_point(rules, name);
    if (group < 0 || !source.points.contains(name)) continue;
    problem.anchors.push_back({group, source.points.at(name), centres.at(name), Vec3::Constant(tolerance)});
  }
  add_contacts(input, rules, problem);
  for (const LandmarkTarget& target : input.landmarks)
    problem.depths.push_back({target.point.group, target.point.position, target.wanted, target.tolerance, target.slack, target.deeper});
  for (const HalfBone& bone : source.bones) {
    const double margin = in_hand(rules.groups[bone.group].name) ? input.hand_margin : input.margin;
    for (const int i : surface_samples(bone.mesh, kSamplesPerBone))
      problem.inside.push_back({bone.group, bone.mesh.V.row(i), margin, 1e-3});
  }
  return problem;
}

struct Violation {
  int bone, vertex;
  double distance;
};

// All bone vertices that lie less than `margin` below the skin, bone by bone.
std::vector<Violation> violations(const HalfSkeleton& source, const BoneProblem& problem, const SkinField& skin, double margin) {
  std::vector<std::vector<Violation>> found(source.bones.size());
  tbb::parallel_for(size_t{0}, source.bones.size(), [&](size_t b) {
    const HalfBone& bone = source.bones[b];
    int seed = -1;
    for (int i = 0; i < bone.mesh.V.rows(); ++i) {
      const Vec3 p = bone.mesh.V.row(i);
      const SkinPoint at = skin.nearest(problem.groups[bone.group].map(p), seed);
      seed = at.triangle;
      if (at.distance > -margin) found[b].push_back({static_cast<int>(b), i, at.distance});
    }
  });
  std::vector<Violation> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

std::vector<int> surface_samples(const TriMesh& mesh, int count) {
  const int n = static_cast<int>(mesh.V.rows());
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
  while (static_cast<int>(out.size()) < count) {
    int i = 0;
    away.maxCoeff(&i);
    choose(i);
  }
  return out;
}

Placement place_bones(const PlaceInput& input, const FitRules& rules, const SkinField& skin, PlaceReport* report) {
  BoneProblem problem = state_problem(input, rules);
  SolveSummary summary = solve_bones(problem, skin, input.iterations);
  int iterations = summary.iterations;
  // Vertices between the samples may still stick out: aim at the worst of them too, and solve again.
  std::vector<Violation> out;
  for (int round = 0; round < kPushRounds; ++round) {
    out = violations(*input.source, problem, skin, 0.3 * input.hand_margin);
    if (out.empty()) break;
    std::stable_sort(out.begin(), out.end(), [](const Violation& a, const Violation& b) { return a.distance > b.distance; });
    std::vector<int> taken(input.source->bones.size(), 0);
    for (const Violation& v : out) {
      if (++taken[v.bone] > 12) continue;
      const HalfBone& bone = input.source->bones[v.bone];
      problem.inside.push_back({bone.group, bone.mesh.V.row(v.vertex), input.hand_margin, 0.4e-3});
    }
    summary = solve_bones(problem, skin, 12);
    iterations += summary.iterations;
  }
  Placement placement;
  for (const BoneGroup& group : problem.groups) placement.maps.push_back(group.map);
  if (report) {
    out = violations(*input.source, problem, skin, 0);
    report->iterations = iterations;
    report->cost = summary.cost;
    report->outside = static_cast<int>(out.size());
    report->furthest = 0;
    for (const Violation& v : out) report->furthest = std::max(report->furthest, v.distance);
  }
  return placement;
}

HalfSkeleton moved(const HalfSkeleton& half, const FitRules& rules, const Placement& placement) {
  HalfSkeleton out = half;
  for (HalfBone& bone : out.bones)
    for (int i = 0; i < bone.mesh.V.rows(); ++i) bone.mesh.V.row(i) = placement.maps[bone.group](bone.mesh.V.row(i));
  for (auto& [name, point] : out.points) {
    const int group = group_of_point(rules, name);
    if (group >= 0) point = placement.maps[group](half.points.at(name));
  }
  out.mid_plane = 0;
  return out;
}

}  // namespace ecorche
