#include "morph/fit/fit_anatomy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <tbb/parallel_for.h>

#include "anatomy/errors.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_force.h"
#include "anatomy/queries/signed_distance.h"
#include "anatomy/queries/skin_bonds.h"
#include "morph/fascia/lay_fascia.h"
#include "morph/fat/body_composition.h"
#include "morph/fat/fat_layer.h"
#include "morph/fat/muscle_mass.h"
#include "morph/fit/template_tissue.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/placement/own_parts.h"
#include "morph/placement/part_bones.h"
#include "morph/shapes/body.h"
#include "morph/tissue/interior_warp.h"

namespace ecorche::inline v1 {
namespace {

using Clock = std::chrono::steady_clock;

// m: skins more even than this are fitted on one side and mirrored
constexpr double kSymmetric = 1e-3;
constexpr double kShortest = 0.4, kTallest = 3;  // m

double since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void check_skin(const BodyPackage& topology, const Points& skin) {
  if (skin.rows() < topology.skin_size)
    throw UnfitError(fmt::format("the skin has {} vertices; bodies here have the base mesh's {}",
                                 skin.rows(), topology.skin_size));
  if (!skin.allFinite()) throw UnfitError("the skin has vertices that are not finite numbers");
}

// The plane of symmetry x = c of a skin, and how far it is from being symmetric.
struct Symmetry {
  double plane = 0, largest = 0;
};
Symmetry symmetry_of(const Points& skin, const std::vector<int>& mirror) {
  Symmetry out;
  for (size_t i = 0; i < mirror.size(); ++i) out.plane += (skin(i, 0) + skin(mirror[i], 0)) / 2;
  out.plane /= double(mirror.size());
  for (size_t i = 0; i < mirror.size(); ++i) {
    const Vec3 other(2 * out.plane - skin(mirror[i], 0), skin(mirror[i], 1), skin(mirror[i], 2));
    out.largest = std::max(out.largest, (skin.row(i).transpose() - other).norm());
  }
  return out;
}

// The skin seen in a mirror, in the same vertex order.
Points mirrored_skin(const Points& skin, const std::vector<int>& mirror, double plane) {
  Points out(mirror.size(), 3);
  for (size_t i = 0; i < mirror.size(); ++i)
    out.row(i) << 2 * plane - skin(mirror[i], 0), skin(mirror[i], 1), skin(mirror[i], 2);
  return out;
}

// The two sides agree on what the middle shares: the mean of their maps.
void share_middle(const FitRules& rules, Placement& left, Placement& right) {
  for (size_t g = 0; g < rules.groups.size(); ++g) {
    if (rules.groups[g].paired) continue;
    BoneMap& a = left.maps[g];
    BoneMap& b = right.maps[g];
    const Quat turn = Quat(a.target_frame).slerp(0.5, Quat(b.target_frame));
    a.target_frame = turn.toRotationMatrix();
    a.target_origin = (a.target_origin + b.target_origin) / 2;
    for (size_t w = 0; w < a.shape.size(); ++w) a.shape[w] = (a.shape[w] + b.shape[w]) / 2;
    b = a;
  }
}

struct BothSides {
  SidedPlacement placement;
  PlaceReport left, right;
};

// The tissue over palpable points, as data/palpable.csv says, for a body's sex, fatness and
// stature.
struct Bracket {
  double low = 0, high = 0;  // m
};
std::vector<Bracket> brackets_of(const FitTables& tables, const Body& body, double stature) {
  const FatTable& fat = tables.fat.sites;
  const FatOptions own{body.sex, estimate_fatness(body)}, lean{Sex::male, 0};
  const double size = stature / tables.stature;
  std::vector<Bracket> out;
  for (const LandmarkRule& rule : tables.rules.landmarks) {
    const double more = fat.thickness(rule.fat_site, own) - fat.thickness(rule.fat_site, lean);
    out.push_back({rule.low * std::min(size, 1.0) + std::min(more, 0.0),
                   rule.high * std::max(size, 1.0) + std::max(more, 0.0)});
  }
  return out;
}

// What a palpable point is held to: where the template itself is off, bodies may be as it is.
Bracket asked_of(const FitTables& tables, size_t landmark, const Bracket& bracket, double stature) {
  constexpr double kSame = 1e-6;  // m
  const double own = tables.landmarks[landmark].wanted * stature / tables.stature;
  return {std::min(bracket.low - kDepthSlack, own - kSame),
          std::max(bracket.high + kDepthSlack, own + kSame)};
}

PlaceInput input_for(const FitTables& tables, const Points& skin, double stature,
                     const std::vector<Bracket>& brackets) {
  PlaceInput input = fit_input(tables, skin, stature);
  for (size_t k = 0; k < input.landmarks.size(); ++k) {
    const Bracket asked = asked_of(tables, k, brackets[k], stature);
    input.landmarks[k].shallowest = asked.low;
    input.landmarks[k].deepest = asked.high;
  }
  return input;
}

BothSides place_both(const FitTables& tables, const Points& skin, const SkinField& field,
                     double stature, const Symmetry& symmetry,
                     const std::vector<Bracket>& brackets) {
  BothSides out;
  SidedPlacement& p = out.placement;
  p.source_plane = tables.half.mid_plane;
  p.target_plane = symmetry.plane;
  if (symmetry.largest < kSymmetric) {
    p.left =
        place_bones(input_for(tables, skin, stature, brackets), tables.rules, field, &out.left);
    p.right = p.left;
    out.right = out.left;
    return out;
  }
  const Points other = mirrored_skin(skin, tables.topology.mirror, symmetry.plane);
  const SkinField other_field(capped_skin(tables.topology, other));
  PlaceInput of_left = input_for(tables, skin, stature, brackets),
             of_right = input_for(tables, other, stature, brackets);
  of_left.mirrored = &other_field;
  of_right.mirrored = &field;
  p.left = place_bones(of_left, tables.rules, field);
  p.right = place_bones(of_right, tables.rules, other_field);
  share_middle(tables.rules, p.left, p.right);
  const auto again = [&](const Points& side, const SkinField& side_field, Placement& placement,
                         PlaceReport& report) {
    PlaceInput input = input_for(tables, side, stature, brackets);
    const Placement start = placement;
    input.start = &start;
    input.middle_fixed = true;
    placement = place_bones(input, tables.rules, side_field, &report);
  };
  again(skin, field, p.left, out.left);
  again(other, other_field, p.right, out.right);
  return out;
}

// The same for a skin whose head may be held aside.
BothSides place_straight(const Template& body_template, const Points& skin, const SkinField& field,
                         double stature, const Symmetry& symmetry,
                         const std::vector<Bracket>& brackets) {
  const FitTables& tables = body_template.tables;
  if (symmetry.largest < kSymmetric)
    return place_both(tables, skin, field, stature, symmetry, brackets);
  const Points own = body_template.body.skin.V.topRows(skin.rows());
  const NamedPoints &at = tables.half.points, centres = joint_centres(tables.regressor, skin);
  std::vector<int> head;
  for (int i = 0; i < int(own.rows()); ++i)
    if (own(i, 1) > at.at("head").y()) head.push_back(i);
  const HeadTurn turn = find_head_turn(skin, tables.topology.mirror, head, symmetry.plane,
                                       centres.at("c7").y(), centres.at("head").y());
  const Points straight = straightened(turn, skin);
  BothSides out =
      place_both(tables, straight, SkinField(capped_skin(tables.topology, straight)), stature,
                 {symmetry.plane, symmetry_of(straight, tables.topology.mirror).largest}, brackets);
  out.placement.turn = turn;
  return out;
}

// Adds the pushes that the placement needs, and says what is left outside.
// The blades are where the skin and their joints have put them; in the thin, ribs give way.
// `part_of`: by group, left (or middle) and right; -1: none, the left one's mirror image.
void keep_ribs_below_blades(const Anatomy& source, const FitRules& rules,
                            const std::vector<std::array<int, 2>>& part_of, double plane,
                            std::vector<SettledPart>& parts) {
  constexpr double kClearance = 3e-3;  // m
  const int cage = part_of[rules.group_of_bone.at("rib5")][0];
  std::vector<TriMesh> blades;
  for (const Bone& bone : source.bones) {
    if (split_side(bone.name).first != "scapula") continue;
    const int part = part_of[rules.group_of_bone.at("scapula")][bone.side == Side::right];
    if (part >= 0) blades.push_back({parts[part].bones.front(), bone.mesh.F});
  }
  if (cage < 0 || blades.empty()) return;
  std::vector<const TriMesh*> both;
  for (const TriMesh& blade : blades) both.push_back(&blade);
  keep_below(join_meshes(both), plane, kClearance, parts[cage]);
}

void settle(const Template& body_template, const SkinField& field, bool even,
            const std::vector<Bracket>& brackets, SidedPlacement& placement, FitReport& report) {
  const FitTables& tables = body_template.tables;
  const FitRules& rules = tables.rules;
  const Anatomy& source = table_anatomy(body_template);
  const SkeletonWarp warp(source, rules, placement);
  const Anatomy placed = warp.skeleton();
  std::vector<SettledPart> parts;
  std::vector<std::array<int, 2>> part_of(rules.groups.size(), {-1, -1});
  for (size_t b = 0; b < source.bones.size(); ++b) {
    const int group = rules.group_of_bone.find(split_side(source.bones[b].name).first)->second;
    const bool paired = rules.groups[group].paired,
               right = paired && source.bones[b].side == Side::right;
    if (right && even) continue;
    int& part = part_of[group][right];
    if (part < 0) {
      part = int(parts.size());
      parts.emplace_back().even = even && !paired;
    }
    parts[part].bones.push_back(placed.bones[b].mesh.V);
  }
  std::vector<PalpablePoint> points;
  for (size_t k = 0; k < tables.landmarks.size(); ++k) {
    if (!rules.landmarks[k].checked) continue;
    const BonePoint& point = tables.landmarks[k].point;
    const bool paired = rules.groups[point.group].paired;
    const Bracket asked = asked_of(tables, k, brackets[k], report.stature);
    constexpr double kMiddle = 2e-3;  // m: nearer to the plane, a point has no partner
    points.push_back({part_of[point.group][0],
                      warp.by_group(point.group, Side::left, point.position), asked.low,
                      asked.high});
    if (even || (!paired && std::abs(point.position.x() - placement.source_plane) < kMiddle))
      continue;
    const Vec3 other(2 * placement.source_plane - point.position.x(), point.position.y(),
                     point.position.z());
    points.push_back({part_of[point.group][paired], warp.by_group(point.group, Side::right, other),
                      asked.low, asked.high});
  }
  settle_bones(field, placement.target_plane, points, parts);
  keep_ribs_below_blades(source, rules, part_of, placement.target_plane, parts);
  placement.pushes.resize(rules.groups.size());
  report.bones_furthest = -std::numeric_limits<double>::infinity();
  for (size_t g = 0; g < rules.groups.size(); ++g)
    for (const int right : {0, 1}) {
      if (part_of[g][right] < 0) continue;
      SettledPart& part = parts[part_of[g][right]];
      const bool twice = even && rules.groups[g].paired;
      report.bones_outside += twice ? 2 * part.outside : part.outside;
      report.bones_furthest = std::max(report.bones_furthest, part.furthest);
      if (twice) {
        placement.pushes[g][1] = part.pushes;
        for (LocalPush& push : placement.pushes[g][1]) {
          push.centre.x() = 2 * placement.target_plane - push.centre.x();
          push.move.x() = -push.move.x();
        }
      }
      placement.pushes[g][right] = std::move(part.pushes);
    }
}

void measure_bones(const FitTables& tables, const BothSides& sides, const SkeletonWarp& warp,
                   const Anatomy& anatomy, const SkinField& field,
                   const std::vector<Bracket>& brackets, FitReport& report) {
  for (const Bone& bone : anatomy.bones) report.bone_vertices += bone.mesh.V.rows();
  report.iterations = sides.left.iterations;
  for (size_t k = 0; k < tables.landmarks.size(); ++k) {
    const LandmarkRule& rule = tables.rules.landmarks[k];
    if (!rule.checked) continue;
    const BonePoint& point = tables.landmarks[k].point;
    report.landmarks.push_back(
        {rule.name,
         -field.nearest_judged(warp.by_group(point.group, Side::left, point.position)).distance,
         brackets[k].low, brackets[k].high});
  }
}

// The warp of the flesh from the template's body into this one.
InteriorMap warp_interior(const Template& body_template, const Points& skin,
                          const std::vector<Bone>& bones, Interior interior, Fit& fit) {
  InteriorReport& report = fit.report.interior;
  const FitTables& tables = body_template.tables;
  const Points own_skin = body_template.body.skin.V.topRows(tables.topology.skin_size);
  const Anatomy& own = table_anatomy(body_template);
  const BodyPair pair{&own_skin, &skin, &own.bones, &bones};
  auto start = Clock::now();
  if (interior == Interior::rbf) {
    InteriorMap map = rbf_map(pair);
    report.warp_ms = since(start);
    return map;
  }
  const HarmonicSolver solver(template_tissue(body_template, interior));
  report.prepare_ms = since(start);
  start = Clock::now();
  Points nodes = solver.move_nodes(pair);
  const TissueMesh& mesh = solver.mesh();
  report.nodes = mesh.V.rows();
  report.tetrahedra = mesh.T.rows();
  const std::vector<double> before = tissue_volumes(mesh, mesh.V),
                            after = tissue_volumes(mesh, nodes);
  for (size_t t = 0; t < before.size(); ++t) {
    report.inverted += after[t] <= 0;
    if (mesh.in_bone[t]) continue;
    report.soft_before += before[t];
    report.soft_after += after[t];
  }
  InteriorMap map = solver.map_to(nodes);
  report.warp_ms = since(start);
  fit.tissue = mesh;
  fit.tissue.V = std::move(nodes);
  return map;
}

// Muscles in the fat of the skin go with it: both bodies have the same vertices.
class SkinCarrier {
 public:
  SkinCarrier(const Template& body_template, const Points& skin)
      : size_(body_template.tables.topology.skin_size),
        rays_(capped_skin(body_template.tables.topology, body_template.body.skin.V)),
        bonder_(joined_bones(body_template.anatomy), rays_, vertex_normals(rays_.mesh()),
                find_mouth(body_template.anatomy, body_template.body.skin)),
        skin_(capped_skin(body_template.tables.topology, skin)),
        normals_(vertex_normals(skin_)) {}

  // Where points of a strip go that `inner` would move as what lies inside.
  CarryMap map(const Strip& strip, const CarryMap& inner) const {
    return [this, &inner, slices = rest_slices(strip)](const Vec3& x, int joint) {
      const auto nearest = std::ranges::min_element(
          slices, {}, [&](const Ellipse& slice) { return (slice.center - x).squaredNorm(); });
      const Vec3 inside = inner(x, joint);
      const SkinBond bond = bonder_.bond(x, nearest->axes.col(1));
      // the middle of a cap is no place of the skin
      if (std::ranges::any_of(bond.vertices, [&](int v) { return v >= size_; })) return inside;
      Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        place += bond.weights[k] * Vec3(skin_.V.row(bond.vertices[size_t(k)]));
        normal += bond.weights[k] * Vec3(normals_.row(bond.vertices[size_t(k)]));
      }
      const Mat3 turn = Quat::FromTwoVectors(bond.normal, normal).toRotationMatrix();
      return bond.moved(place, normal, turn, inside);
    };
  }

 private:
  int size_;
  SkinRays rays_;
  SkinBonder bonder_;
  TriMesh skin_;
  Points normals_;
};

// What the template's own muscles are to hold, m^3.
double muscle_volume_of(const Template& body_template) {
  const Body& own = body_template.body;
  const FitTables& tables = body_template.tables;
  return muscle_mass(own.sex, own.age, tables.stature, kBodyDensity * tables.volume) /
             kMuscleDensity +
         fat_in_muscles(own);
}

// `wanted`, `size`: muscle and stature that the body has for the template's.
void carry_all(const std::vector<Muscle>& muscles, const CarryMap& map, const InteriorMap& flesh,
               const SkinCarrier* with_skin, double wanted, double size, std::vector<Muscle>& out) {
  const CarryMap inner =
      flesh ? CarryMap([&](const Vec3& x, int) { return flesh(x); }) : CarryMap();
  out = muscles;
  tbb::parallel_for(size_t{0}, muscles.size(), [&](size_t m) {
    // what moves the skin ends in it
    EndsInFlesh ends;
    if (lies_in_fat(out[m])) ends = {out[m].origin_bone.empty(), out[m].insertion_bone.empty()};
    for (Strip& strip : out[m].strips)
      strip = lies_in_fat(out[m]) && with_skin
                  ? carry_strip(strip, map, with_skin->map(strip, inner ? inner : map), ends)
                  : carry_strip(strip, map, inner);
    const double before = rest_volume(muscles[m]), now = rest_volume(out[m]);
    if (now <= 0) return;
    // those of the skin are as thick as the body is tall, whatever muscle it has
    const double factor = lies_in_fat(out[m]) ? size : std::sqrt(wanted * before / now);
    for (Strip& strip : out[m].strips) scale_radii(strip, Vec2::Constant(factor));
    out[m].volume = lies_in_fat(out[m]) ? rest_volume(out[m]) : wanted * muscles[m].volume;
    // Of the volume that a person of this size has; what then fills the skin between the muscles is
    // no muscle that pulls.
    if (out[m].max_force <= 0)
      out[m].max_force = isometric_force(out[m].volume, out[m].fibre_length);
  });
}

}  // namespace

Fit fit_anatomy(const Template& body_template, const Body& body, const FitOptions& options) {
  const FitTables& tables = body_template.tables;
  check_skin(tables.topology, body.skin.V);
  const Points skin = body.skin.V.topRows(tables.topology.skin_size);
  Fit fit;
  fit.report.stature = skin.col(1).maxCoeff() - skin.col(1).minCoeff();
  if (fit.report.stature < kShortest || fit.report.stature > kTallest)
    throw UnfitError(
        fmt::format("the skin is {:.3g} m tall; is it in metres, upright?", fit.report.stature));

  auto start = Clock::now();
  const Symmetry symmetry = symmetry_of(skin, tables.topology.mirror);
  fit.report.asymmetry = symmetry.largest;
  if (symmetry.largest < kSymmetric) fit.report.even_about = symmetry.plane;
  const SkinField field(capped_skin(tables.topology, skin));
  const std::vector<Bracket> brackets = brackets_of(tables, body, fit.report.stature);
  BothSides sides =
      place_straight(body_template, skin, field, fit.report.stature, symmetry, brackets);
  scale_groups(options.scales, tables.rules, table_anatomy(body_template), sides.placement);
  settle(body_template, field, symmetry.largest < kSymmetric, brackets, sides.placement,
         fit.report);
  const SkeletonWarp warp(table_anatomy(body_template), tables.rules, sides.placement);
  fit.anatomy = warp.skeleton();
  fit.report.bones_ms = since(start);
  InteriorMap flesh;
  if (options.interior != Interior::bones)
    flesh = warp_interior(body_template, skin, fit.anatomy.bones, options.interior, fit);
  const OwnParts parts(body_template.anatomy, table_anatomy(body_template), warp);
  parts.add_to(fit.anatomy);
  part_bones(fit.anatomy.bones, body_template.anatomy.bones, fit.report.even_about);

  start = Clock::now();
  const double mass =
      body.mass > 0 ? body.mass : kBodyDensity * inner_volume(tables.topology, skin);
  fit.report.muscle_mass = muscle_mass(body.sex, body.age, fit.report.stature, mass);
  fit.report.muscle_volume = fit.report.muscle_mass / kMuscleDensity + fat_in_muscles(body);
  std::optional<SkinCarrier> with_skin;
  if (std::ranges::any_of(tables.muscles, lies_in_fat)) with_skin.emplace(body_template, skin);
  const CarryMap by_joint = [&](const Vec3& x, int joint) { return parts.carry(x, joint); };
  carry_all(tables.muscles, by_joint, flesh, with_skin ? &*with_skin : nullptr,
            fit.report.muscle_volume / muscle_volume_of(body_template),
            fit.report.stature / tables.stature, fit.anatomy.muscles);
  fit.fascia = carry_fascia(tables.fascia, by_joint);
  fit.report.muscles_ms = since(start);
  measure_bones(tables, sides, warp, fit.anatomy, field, brackets, fit.report);
  fit.placement = std::move(sides.placement);
  return fit;
}

std::vector<Muscle> carry_muscles_again(const Template& body_template, const Body& body,
                                        const Fit& before, std::span<const int> held) {
  const FitTables& tables = body_template.tables;
  const SkeletonWarp warp(table_anatomy(body_template), tables.rules, before.placement);
  const OwnParts parts(body_template.anatomy, table_anatomy(body_template), warp);
  std::vector<Muscle> others, carried;
  for (size_t m = 0; m < held.size(); ++m)
    if (held[m] < 0) others.push_back(tables.muscles[m]);
  std::optional<SkinCarrier> with_skin;
  if (std::ranges::any_of(others, lies_in_fat))
    with_skin.emplace(body_template, body.skin.V.topRows(tables.topology.skin_size));
  carry_all(
      others, [&](const Vec3& x, int joint) { return parts.carry(x, joint); }, {},
      with_skin ? &*with_skin : nullptr,
      before.report.muscle_volume / muscle_volume_of(body_template),
      before.report.stature / tables.stature, carried);
  std::vector<Muscle> out;
  for (size_t m = 0, k = 0; m < held.size(); ++m)
    out.push_back(held[m] < 0 ? std::move(carried[k++]) : before.anatomy.muscles[size_t(held[m])]);
  return out;
}

}  // namespace ecorche::inline v1
