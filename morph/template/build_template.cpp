#include "morph/template/build_template.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "anatomy/authoring/capsule_table.h"
#include "anatomy/authoring/fascia_table.h"
#include "anatomy/authoring/muscle_placement.h"
#include "anatomy/authoring/muscle_table.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/bones/bone_surface.h"
#include "anatomy/bones/mirror.h"
#include "anatomy/geometry/mirror_mesh.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fascia/lay_fascia.h"
#include "morph/fat/fat_layer.h"
#include "morph/fat/muscle_mass.h"
#include "morph/placement/part_bones.h"
#include "morph/placement/settle_bones.h"
#include "morph/shapes/body.h"
#include "morph/template/regressor_training.h"

namespace ecorche::inline v1 {
namespace {

// m: stature of the bone package's skeleton with 5 mm of scalp and 15 mm of heel pad.
constexpr double kSourceStature = 1.707;

// Rounds bones and takes back below the skin what comes out by that. Right bones stay the images of
// left ones, vertex by vertex.
void round_bones(const FitRules& rules, const SkinField& skin, std::vector<Bone>& bones) {
  tbb::parallel_for(std::size_t{0}, bones.size(), [&](std::size_t b) {
    if (bones[b].side != Side::right) bones[b].mesh = rounded_bone(bones[b].mesh);
  });
  std::vector<SettledPart> parts(rules.groups.size());
  const auto group_of = [&](const Bone& bone) {
    return std::size_t(rules.group_of_bone.at(split_side(bone.name).first));
  };
  for (const Bone& bone : bones) {
    if (bone.side == Side::right) continue;
    SettledPart& part = parts[group_of(bone)];
    part.even = !rules.groups[group_of(bone)].paired;
    part.bones.push_back(bone.mesh.V);
  }
  settle_bones(skin, 0, {}, parts);
  std::vector<std::size_t> taken(parts.size(), 0);
  for (Bone& bone : bones) {
    if (bone.side == Side::right) continue;
    const std::size_t group = group_of(bone);
    bone.mesh.V = parts[group].bones[taken[group]++];
  }
  for (Bone& bone : bones) {
    if (bone.side != Side::right) continue;
    const auto left = std::ranges::find(bones, mirror_name(bone.name), &Bone::name);
    bone.mesh = mirror_mesh(left->mesh, 0);
  }
}

}  // namespace

SidedPlacement place_source(const Assets& assets, const Anatomy& source, const FitRules& rules) {
  const BodyPackage package = read_body_package(assets);
  const ShapedBody shaped = shape_body(package, ShapeSpec{});
  const HalfSkeleton half = left_half(source, rules, kSourceMidPlane, kSourceStature);
  const Placement placement = place_bones(source_input(package, half, rules, shaped), rules,
                                          SkinField(capped_skin(package, shaped.points)));
  return {placement, placement, kSourceMidPlane, 0};
}

Template build_template(const Assets& assets) {
  FitTables tables{FatTables(assets.tables)};
  tables.rules = read_fit_rules(assets.tables);
  const FitRules& rules = tables.rules;
  const Anatomy source = read_source_skeleton(assets);
  const BodyPackage package = read_body_package(assets);
  const ShapedBody shaped = shape_body(package, ShapeSpec{});

  // The skeleton into the body.
  const HalfSkeleton half = left_half(source, rules, kSourceMidPlane, kSourceStature);
  const PlaceInput input = source_input(package, half, rules, shaped);
  const SkinField skin(capped_skin(package, shaped.points));
  const SkeletonWarp warp(source, rules, place_source(assets, source, rules));

  Template out{{}, {}, FitTables(tables.fat)};
  out.body = shaped.body;
  out.anatomy = warp.skeleton();
  const CarryMap by_joint = [&](const Vec3& x, int joint) { return warp.by_joint(joint, x); };
  const MuscleTable table = read_muscle_table(assets.tables);
  out.anatomy.muscles = carry_muscles(place_muscles(table, source), by_joint);
  std::vector<FasciaPlan> plans =
      place_fascia(read_fascia_table(assets.tables, table), table, source);
  for (FasciaPlan& plan : place_capsules(read_capsule_rules(assets.tables), source))
    plans.push_back(std::move(plan));
  tables.fascia = carry_fascia(plans, by_joint);
  double listed = 0;
  for (const Muscle& muscle : out.anatomy.muscles)
    if (!lies_in_fat(muscle)) listed += muscle.volume;  // those of the skin are not weighed
  const double own =
      muscle_mass(shaped.body.sex, shaped.body.age, shaped.stature, shaped.mass) / kMuscleDensity;
  for (Muscle& muscle : out.anatomy.muscles) {
    muscle.volume *= own / listed;  // the table gives the shares
    widen_to_volume(muscle);
  }

  // What other bodies are measured against.
  tables.half = left_half(out.anatomy, rules, 0, shaped.stature);
  // Bodies' axes are guessed from their joint centres; the template's must be found the same way to
  // be compared.
  for (const auto& [name, axis] : guess_hinges(tables.half.points)) tables.half.hinges[name] = axis;
  tables.stature = shaped.stature;
  tables.volume = inner_volume(package, shaped.body.skin.V);
  tables.gaps = glide_pairs_at_rest(tables.half, rules);
  tables.margins = sample_margins(tables.half, rules, input, skin);
  tables.landmarks = input.landmarks;
  for (LandmarkTarget& target : tables.landmarks) {
    target.point.position = tables.half.bones[target.point.bone].mesh.V.row(target.point.vertex);
    target.wanted = -skin.distance(target.point.position);
  }
  tables.topology.skin_size = package.skin_size;
  tables.topology.quads = package.quads;
  tables.topology.triangles = package.triangles;
  tables.topology.cavities = package.cavities;
  tables.topology.mirror.assign(package.mirror.begin(), package.mirror.begin() + package.skin_size);
  train(package, half, shaped, tables);

  // Bones are placed by what the package has of them; muscles lie on their rounded surfaces.
  round_bones(rules, skin, out.anatomy.bones);
  part_bones(out.anatomy.bones, {}, 0);
  // Its muscles fill its skin, as they do in every body.
  tables.muscles = out.anatomy.muscles;
  const SkinRays rays(capped_skin(package, out.body.skin.V));
  DilateOptions even;
  even.even_about = 0;
  dilate_muscles(out.anatomy, tables.muscles, tables.muscles, rays,
                 make_fat_layer(tables.fat, rays, out.anatomy, out.body), even);
  out.anatomy.fascia = lay_fascia(tables.fascia, out.anatomy, rays);
  out.tables = std::move(tables);
  return out;
}

}  // namespace ecorche::inline v1
