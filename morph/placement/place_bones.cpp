#include "morph/placement/place_bones.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <tbb/parallel_for.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kSamplesPerBone = 60;  // surface points that keep their depth; fewer: bones pierce
constexpr int kPushRounds = 6;       // at most, of moving inside what is outside the skin
constexpr int kGlideRounds = 3;      // of pairing shoulder blade and ribs anew, when authored
// Factor of the inside points' tolerances in the first solution. Larger: it says less about the
// skin; 1: bones far from their goal are crushed instead of moved.
constexpr double kGentle = 8;
constexpr double kPushMargin = 0.4e-3;  // m below the skin that every bone vertex reaches

bool in_hand(const std::string& group) {
  return group == "carpus" || group.starts_with("metacarpal") ||
         group.find("_phalanx") != std::string::npos;
}

// The group whose place a known point determines: that of the bone it is a point of, else the one
// that begins there, else one that ends there, else a contact's first.
int group_of_point(const FitRules& rules, const std::string& point) {
  static const std::map<std::string, std::string> bones{
      {"orbit", "skull"}, {"jaw", "mandible"}, {"chin", "mandible"}, {"bite", "mandible"}};
  if (const auto bone = bones.find(point); bone != bones.end())
    return rules.group_of_bone.at(bone->second);
  for (size_t g = 0; g < rules.groups.size(); ++g)
    if (rules.groups[g].near == point && point != "pelvis") return int(g);
  for (size_t g = 0; g < rules.groups.size(); ++g)
    if (rules.groups[g].far == point) return int(g);
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
    if (at == input.source->points.end())
      throw UnfitError(
          fmt::format("bone_contacts.csv: the skeleton has no joint '{}'", rule.point));
    const Vec3 p = at->second, q = input.authored ? Vec3(p + rule.close) : p;
    problem.joints.push_back({rule.a, rule.b, p, q, rule.tolerance});
    if (rule.along.empty()) continue;
    const Vec3 side = rule.spread * contact_direction(rule, *input.source);
    problem.joints.push_back({rule.a, rule.b, p + side, q + side, rule.loose});
    problem.joints.push_back({rule.a, rule.b, p - side, q - side, rule.loose});
  }
}

std::vector<SurfaceSample> wanted_margins(const HalfSkeleton& half, const FitRules& rules,
                                          const PlaceInput& input) {
  std::vector<SurfaceSample> out;
  for (size_t b = 0; b < half.bones.size(); ++b) {
    const double margin =
        in_hand(rules.groups[half.bones[b].group].name) ? input.hand_margin : input.margin;
    for (const int i : surface_samples(half.bones[b].mesh, kSamplesPerBone))
      out.push_back({int(b), i, margin});
  }
  return out;
}

bool in_both(const FitRules& rules, const BoneProblem& problem, int group) {
  return problem.mirrored && !rules.groups[group].paired;
}

BoneProblem state_problem(const PlaceInput& input, const FitRules& rules) {
  const HalfSkeleton& source = *input.source;
  NamedPoints centres = input.centres;
  complete_centres(source, centres);
  const NamedPoints hinges = guess_hinges(centres);
  const std::vector<double> features =
      input.build ? build_features(input.centres, input.stature) : std::vector<double>{};
  BoneProblem problem;
  problem.mirrored = input.mirrored;
  problem.groups.resize(rules.groups.size());
  // Groups whose near point is not known from the skin are carried by the one before them.
  const std::map<std::string, std::string> carriers{{"cmc2", "carpus"},
                                                    {"cmc3", "carpus"},
                                                    {"cmc4", "carpus"},
                                                    {"cmc5", "carpus"},
                                                    {"patella", "femur"}};
  std::map<std::string, int> index;
  for (size_t g = 0; g < rules.groups.size(); ++g) index[rules.groups[g].name] = int(g);
  for (size_t g = 0; g < rules.groups.size(); ++g) {
    const GroupRule& rule = rules.groups[g];
    if (!centres.contains(rule.near)) {
      const auto carrier = carriers.find(rule.near);
      if (carrier == carriers.end())
        throw UnfitError(fmt::format("nothing says where '{}' is in the skin", rule.near));
      centres[rule.near] =
          problem.groups[index.at(carrier->second)].map(source.points.at(rule.near));
    }
    BoneGroup& group = problem.groups[g];
    group.map = expected_map(rule, source.points, source.hinges, centres, hinges,
                             input.size * (input.authored ? rule.width : 1));
    if (input.authored) group.map.move(BoneMap::turn_z, rule.raised);
    if (input.build) apply_build(*input.build, features, int(g), group.map);
    group.expected = group.map;
    group.freedom = rule.freedom;
    const bool fixed = input.middle_fixed && !rule.paired;
    for (double& tolerance : group.freedom) tolerance *= fixed ? 0 : input.freedom;
    if (input.start) group.map = input.start->maps[g];
  }
  for (const auto& [name, tolerance] : input.tolerances) {
    const int group = group_of_point(rules, name);
    if (group < 0 || !source.points.contains(name)) continue;
    problem.anchors.push_back(
        {group, source.points.at(name), centres.at(name), Vec3::Constant(tolerance)});
  }
  add_contacts(input, rules, problem);
  for (const LandmarkTarget& target : input.landmarks)
    problem.depths.push_back({target.point.group, target.point.position, target.wanted,
                              target.tolerance, target.slack, target.deeper});
  const std::vector<SurfaceSample> own =
      input.margins ? std::vector<SurfaceSample>{} : wanted_margins(source, rules, input);
  for (const SurfaceSample& s : input.margins ? *input.margins : own)
    problem.inside.push_back({source.bones[s.bone].group, source.bones[s.bone].mesh.V.row(s.vertex),
                              s.margin, 1e-3, in_both(rules, problem, source.bones[s.bone].group)});
  return problem;
}

struct Violation {
  int bone, vertex;
  double distance;
};

// Bone vertices (all, or the watched ones) that lie less than `margin` below the skin, bone by
// bone.
std::vector<Violation> violations(const HalfSkeleton& source, const FitRules& rules,
                                  const BoneProblem& problem, const SkinField& skin, double margin,
                                  bool all) {
  std::vector<std::vector<Violation>> found(source.bones.size());
  tbb::parallel_for(size_t{0}, source.bones.size(), [&](size_t b) {
    const HalfBone& bone = source.bones[b];
    const int count = all ? bone.mesh.V.rows() : bone.watched.size();
    SkinPoint at;
    Vec3 asked = Vec3::Zero();
    at.distance = 1e300;
    for (int k = 0; k < count; ++k) {
      const int i = all ? k : bone.watched[k];
      const Vec3 x = problem.groups[bone.group].map(bone.mesh.V.row(i));
      if (at.distance + (x - asked).norm() < -margin)
        continue;  // distances change no faster than places
      at = skin.nearest_judged(x, at.triangle);
      if (in_both(rules, problem, bone.group)) {
        const SkinPoint other = problem.mirrored->nearest_judged(x);
        at.distance = std::max(at.distance, other.distance);
      }
      asked = x;
      if (at.distance > -margin) found[b].push_back({int(b), i, at.distance});
    }
  });
  std::vector<Violation> joined;
  for (const auto& part : found) joined.insert(joined.end(), part.begin(), part.end());
  return joined;
}

// How much sticks out in all, m.
double sticking(const std::vector<Violation>& found) {
  double sum = 0;
  for (const Violation& v : found) sum += v.distance + kPushMargin;
  return sum;
}

// Vertices between the samples may still stick out: aims at the worst of them too, and solves
// again. Where the skin is folded (lips, a chin on the neck) that can end with bones crushed;
// rounds that do harm are taken back. Returns what is left in the end.
std::vector<Violation> push_in(const PlaceInput& input, const FitRules& rules,
                               const SkinField& skin, BoneProblem& problem, bool all,
                               int& iterations) {
  constexpr double kHarm = 2;
  std::vector<Violation> out = violations(*input.source, rules, problem, skin, kPushMargin, all),
                         best = out;
  std::vector<BoneGroup> kept = problem.groups;
  for (int round = 0;
       round < kPushRounds && !out.empty() && sticking(out) <= kHarm * sticking(best); ++round) {
    std::stable_sort(out.begin(), out.end(), [](const Violation& a, const Violation& b) {
      return a.distance > b.distance;
    });
    std::vector<int> taken(input.source->bones.size(), 0);
    for (const Violation& v : out) {
      if (++taken[v.bone] > 12) continue;
      const HalfBone& bone = input.source->bones[v.bone];
      problem.inside.push_back({bone.group, bone.mesh.V.row(v.vertex), input.hand_margin, 0.4e-3,
                                in_both(rules, problem, bone.group)});
    }
    iterations += solve_bones(problem, skin, 12).iterations;
    out = violations(*input.source, rules, problem, skin, kPushMargin, all);
    if (sticking(out) < sticking(best)) best = out, kept = problem.groups;
  }
  problem.groups = std::move(kept);
  return best;
}

// Palpable points that lie a little off where they should are aimed at harder, some times over.
// Those that are far off are left alone: there the bones would be bent for what is fat, or what no
// skeleton fits.
void aim_again(const PlaceInput& input, const SkinField& skin, BoneProblem& problem,
               int& iterations) {
  constexpr int kRounds = 8;
  constexpr double kFar = 25e-3, kWithin = 0.7e-3;  // m
  constexpr double kHarder = 0.6;
  for (int round = 0; round < kRounds; ++round) {
    bool any = false;
    for (size_t k = 0; k < input.landmarks.size(); ++k) {
      const LandmarkTarget& target = input.landmarks[k];
      DepthPoint& aim = problem.depths[k];
      const Vec3 x = problem.groups[aim.group].map(aim.x);
      const double depth = -skin.distance(x, aim.seed);
      const double off = std::max(target.shallowest - depth, depth - target.deepest);
      if (off <= 0 || off > kFar) continue;
      aim.wanted =
          depth < target.shallowest ? target.shallowest + kWithin : target.deepest - kWithin;
      aim.slack = 0;
      aim.deeper = 1;
      aim.tolerance *= kHarder;
      any = true;
    }
    if (!any) return;
    iterations += solve_bones(problem, skin, 12, true).iterations;
  }
}

std::vector<BoneMap> current_maps(const BoneProblem& problem) {
  std::vector<BoneMap> maps;
  for (const BoneGroup& group : problem.groups) maps.push_back(group.map);
  return maps;
}

// The shoulder blade glides on the ribs: points of its inner side and the rib points under them, in
// the placement of `maps`. Gaps are what they are in the source.
std::vector<GapPair> glide_pairs(const HalfSkeleton& source, const FitRules& rules,
                                 const std::vector<BoneMap>& maps) {
  // m: blade vertices this near to the ribs in the source glide
  constexpr double kGlideReach = 0.018;
  constexpr int kPairs = 14;
  const int blade_group = rules.group_of_bone.at("scapula"),
            cage_group = rules.group_of_bone.at("rib5");
  Points cage(0, 3);
  const HalfBone* blade = nullptr;
  for (const HalfBone& bone : source.bones) {
    if (bone.name == "scapula") blade = &bone;
    if (bone.name < "rib2" || bone.name > "rib8") continue;
    cage.conservativeResize(cage.rows() + bone.mesh.V.rows(), 3);
    cage.bottomRows(bone.mesh.V.rows()) = bone.mesh.V;
  }
  Points placed = cage;
  for (Eigen::Index i = 0; i < cage.rows(); ++i) placed.row(i) = maps[cage_group](cage.row(i));
  const auto middle_of = [](const Points& points) -> Vec3 {
    return 0.5 * (points.colwise().minCoeff() + points.colwise().maxCoeff()).transpose();
  };
  const auto outwards = [](const Vec3& p, const Vec3& middle) {
    return Vec3(p.x() - middle.x(), 0, p.z() - middle.z()).normalized();
  };
  const Vec3 source_middle(source.mid_plane, 0, middle_of(cage).z()),
      placed_middle(0, 0, middle_of(placed).z());
  TriMesh near;  // blade vertices that lie on the ribs, as a cloud
  std::vector<double> gaps;
  for (Eigen::Index i = 0; i < blade->mesh.V.rows(); ++i) {
    const Vec3 x = blade->mesh.V.row(i);
    Eigen::Index k = 0;
    if ((cage.rowwise() - x.transpose()).rowwise().norm().minCoeff(&k) > kGlideReach) continue;
    near.V.conservativeResize(near.V.rows() + 1, 3);
    near.V.row(near.V.rows() - 1) = x;
    const Vec3 rib = cage.row(k);
    gaps.push_back(outwards(rib, source_middle).dot(x - rib));
  }
  std::vector<GapPair> out;
  if (near.V.rows() == 0) return out;
  for (const int i : surface_samples(near, kPairs)) {
    const Vec3 x = near.V.row(i), on_blade = maps[blade_group](x);
    Eigen::Index k = 0;
    (placed.rowwise() - on_blade.transpose()).rowwise().squaredNorm().minCoeff(&k);
    const Vec3 on_rib = placed.row(k);
    out.push_back(
        {blade_group, cage_group, x, cage.row(k), outwards(on_rib, placed_middle), gaps[i], 2e-3});
  }
  return out;
}

}  // namespace

Placement place_bones(const PlaceInput& input, const FitRules& rules, const SkinField& skin,
                      PlaceReport* report) {
  BoneProblem problem = state_problem(input, rules);
  problem.gaps = input.gaps;
  // Far from the goal, bones that stick out would be crushed rather than moved: first gently, then
  // in earnest.
  for (InsidePoint& point : problem.inside) point.tolerance *= kGentle;
  int iterations = solve_bones(problem, skin, input.iterations).iterations;
  for (InsidePoint& point : problem.inside) point.tolerance /= kGentle;
  iterations += solve_bones(problem, skin, input.iterations).iterations;
  for (int round = 0; round < kGlideRounds && input.authored; ++round) {
    problem.gaps = glide_pairs(*input.source, rules, current_maps(problem));
    iterations += solve_bones(problem, skin, input.iterations).iterations;
  }
  aim_again(input, skin, problem, iterations);
  push_in(input, rules, skin, problem, false, iterations);
  const std::vector<Violation> left = push_in(input, rules, skin, problem, true, iterations);
  if (report) {
    report->iterations = iterations;
    report->outside.assign(input.source->bones.size(), 0);
    report->furthest = -kPushMargin;
    for (const Violation& v : left) {
      report->outside[v.bone] += v.distance > 0;
      report->furthest = std::max(report->furthest, v.distance);
    }
  }
  Placement placement{current_maps(problem), {}};
  for (const BoneGroup& group : problem.groups) placement.expected.push_back(group.expected);
  return placement;
}

std::vector<GapPair> glide_pairs_at_rest(const HalfSkeleton& half, const FitRules& rules) {
  const std::vector<BoneMap> still(rules.groups.size());
  std::vector<GapPair> out = glide_pairs(half, rules, still);
  for (GapPair& pair : out) pair.gap = pair.normal.dot(pair.x_a - pair.x_b);
  return out;
}

std::vector<SurfaceSample> sample_margins(const HalfSkeleton& half, const FitRules& rules,
                                          const PlaceInput& input, const SkinField& skin) {
  std::vector<SurfaceSample> out = wanted_margins(half, rules, input);
  for (SurfaceSample& s : out)
    s.margin = std::min(s.margin, -skin.distance(half.bones[s.bone].mesh.V.row(s.vertex)));
  return out;
}

HalfSkeleton moved(const HalfSkeleton& half, const FitRules& rules, const Placement& placement) {
  HalfSkeleton out = half;
  for (HalfBone& bone : out.bones)
    for (int i = 0; i < bone.mesh.V.rows(); ++i)
      bone.mesh.V.row(i) = placement.maps[bone.group](bone.mesh.V.row(i));
  for (auto& [name, point] : out.points) {
    const int group = group_of_point(rules, name);
    if (group >= 0) point = placement.maps[group](half.points.at(name));
  }
  out.mid_plane = 0;
  return out;
}

}  // namespace ecorche::inline v1
