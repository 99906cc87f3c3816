#include "skinning/checks/anatomy_check.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/base_mesh/chest_wall.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/muscles/torn_muscles.h"
#include "anatomy/posing/joint_sweep.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/fat/fat_layer.h"
#include "morph/fit/layer_gaps.h"
#include "morph/fit/muscle_ends.h"
#include "morph/fit/shown_through.h"
#include "skinning/character/evaluate.h"
#include "skinning/checks/slits.h"
#include "skinning/checks/wholeness.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kJump = 0.001;        // m
constexpr double kLeastShared = 1e-9;  // m^3, of a neighbour that is named
constexpr double kSticksOut = 0.020;   // m

// Everything of a character that does not change from pose to pose.
struct Subject {
  const CharacterModel& model;
  const BodyPackage& package;
  MuscleSurface surface;
  std::vector<SliceRange> ranges;
  std::vector<double> rest_volumes;  // #strips
  std::vector<double> rest_reaches;  // #slices, see reaches_of()
  RestSurface rest_surface;
  FasciaSurface fascia;
  std::vector<Vec3> joints;
  bool packaged = false;  // the skin has the package's topology

  const Anatomy& anatomy() const { return model.character.anatomy; }
};

// One pose's meshes, and the memory they are made in.
struct Shape {
  explicit Shape(const CharacterModel& model) : frame(model) {}

  CharacterState frame;
  Points muscles, fascia;
  std::vector<Points> bones;
  Points skin_points;
  TriMesh skin;  // closed as far as is known how
};

void shape_pose(const Subject& subject, const Pose& pose, Shape& shape) {
  const Anatomy& anatomy = subject.anatomy();
  evaluate(subject.model, pose, {}, shape.frame);
  update_muscle_surface(subject.surface, shape.frame.posed, shape.muscles);
  PointsF fascia;
  update_fascia_surface(subject.fascia, shape.frame.posed, fascia);
  shape.fascia = fascia.cast<double>();
  shape.bones.resize(anatomy.bones.size());
  for (std::size_t i = 0; i < anatomy.bones.size(); ++i) {
    const Bone& bone = anatomy.bones[i];
    const std::size_t j = bone.joint;
    const Transform X = shape.frame.posed.X_WJ[j] * Eigen::Translation3d(-subject.joints[j]);
    shape.bones[i] = (bone.mesh.V * X.linear().transpose()).rowwise() + X.translation().transpose();
  }
  to_points(shape.frame.skin, shape.skin_points);
  if (subject.packaged)
    shape.skin = capped_skin(subject.package, shape.skin_points);
  else
    shape.skin = {shape.skin_points, subject.model.character.body.skin.F};
}

// Muscles in order, then bones.
SolidVolumes measure_shape(const Subject& subject, const Shape& shape, double spacing) {
  std::vector<Solid> solids;
  for (const MuscleSurface::Part& part : subject.surface.parts)
    solids.push_back(
        {Solid::Kind::muscle, &shape.muscles, &subject.surface.F, part.face_begin, part.face_end});
  for (std::size_t i = 0; i < shape.bones.size(); ++i) {
    const Triangles& F = subject.anatomy().bones[i].mesh.F;
    solids.push_back({Solid::Kind::bone, &shape.bones[i], &F, 0, int(F.rows())});
  }
  return measure_solids(solids, spacing);
}

// What a shape, at rest or posed, has to say about each bone.
struct PosedBones {
  std::vector<int> outside;   // points
  std::vector<double> depth;  // m, of the farthest

  int all_outside() const { return std::accumulate(outside.begin(), outside.end(), 0); }
};

PosedBones measure_bones(const Shape& shape) {
  PosedBones out;
  const NearestSurface skin(shape.skin);
  for (const Points& bone : shape.bones) {
    const std::vector<int> winding = winding_numbers(shape.skin, bone);
    int& outside = out.outside.emplace_back(0);
    double& depth = out.depth.emplace_back(0.0);
    for (std::size_t i = 0; i < winding.size(); ++i) {
      if (winding[i] != 0) continue;
      ++outside;
      depth = std::max(depth, skin.nearest(bone.row(i)).distance);
    }
  }
  return out;
}

FasciaFigures fascia_figures(const Subject& subject, const Shape& shape) {
  return measure_fascia(subject.anatomy(), subject.fascia, shape.fascia, shape.skin,
                        {shape.muscles, subject.surface.F});
}

void check_rest(const Subject& subject, const Shape& shape, const CheckOptions& options,
                AnatomyCheck& check) {
  const std::vector<int> winding = winding_numbers(shape.skin, shape.muscles);
  const NearestSurface skin(shape.skin);
  check.muscle_points = winding.size();
  for (std::size_t i = 0; i < winding.size(); ++i) {
    MuscleCheck& muscle = check.muscles[subject.surface.muscle[i]];
    ++muscle.points;
    if (winding[i] != 0) continue;
    ++muscle.points_outside;
    ++check.muscle_points_outside;
    check.furthest_outside =
        std::max(check.furthest_outside, skin.nearest(shape.muscles.row(i)).distance);
  }
  for (const Points& bone : shape.bones) check.bone_points += bone.rows();
  check.bone_points_outside = measure_bones(shape).all_outside();
  check.fascia = fascia_figures(subject, shape);

  const SolidVolumes volumes = measure_shape(subject, shape, options.rest_spacing);
  check.overlap_share = volumes.muscle_overlap_share();
  check.bone_share = volumes.bone_overlap_share();
  check.open_columns = volumes.open_columns;
  const int muscles = check.muscles.size();
  for (int m = 0; m < muscles; ++m) {
    MuscleCheck& muscle = check.muscles[m];
    muscle.volume = volumes.volume[m];
    if (!(muscle.volume > 0)) continue;
    muscle.overlap = volumes.in_muscle[m] / muscle.volume;
    muscle.in_bone = volumes.in_bone[m] / muscle.volume;
    if (muscle.in_bone > check.pierced_share)
      check.pierced_share = muscle.in_bone,
      check.pierced_muscle = subject.anatomy().muscles[m].name;
  }
  for (const SharedVolume& pair : volumes.pairs) {  // largest first
    if (pair.b >= muscles || pair.volume < kLeastShared) continue;
    for (const auto& [one, other] : {std::pair(pair.a, pair.b), std::pair(pair.b, pair.a)}) {
      MuscleCheck& muscle = check.muscles[one];
      if (muscle.neighbour < 0) muscle.neighbour = other, muscle.neighbour_volume = pair.volume;
    }
  }
}

// All muscles and bones as one soup.
TriMesh flesh_of(const Subject& subject, const Shape& shape) {
  Eigen::Index points = shape.muscles.rows(), faces = subject.surface.F.rows();
  for (std::size_t i = 0; i < shape.bones.size(); ++i)
    points += shape.bones[i].rows(), faces += subject.anatomy().bones[i].mesh.F.rows();
  TriMesh flesh{Points(points, 3), Triangles(faces, 3)};
  flesh.V.topRows(shape.muscles.rows()) = shape.muscles;
  flesh.F.topRows(subject.surface.F.rows()) = subject.surface.F;
  Eigen::Index point = shape.muscles.rows(), face = subject.surface.F.rows();
  for (std::size_t i = 0; i < shape.bones.size(); ++i) {
    const Triangles& F = subject.anatomy().bones[i].mesh.F;
    flesh.V.middleRows(point, shape.bones[i].rows()) = shape.bones[i];
    flesh.F.middleRows(face, F.rows()) = (F.array() + int(point)).matrix();
    point += shape.bones[i].rows();
    face += F.rows();
  }
  return flesh;
}

void check_torn(const Subject& subject, const CheckOptions& options, AnatomyCheck& check) {
  if (!options.reference) return;
  const std::vector<Muscle>& muscles = subject.anatomy().muscles;
  const std::vector<MuscleTear> tears = measure_tears(muscles, options.reference->anatomy.muscles);
  for (std::size_t m = 0; m < tears.size(); ++m) {
    check.compared = check.compared || tears[m].known;
    check.needles_at_rest += tears[m].needles;
    check.muscles[m].tear = tears[m];
  }
  const std::vector<int> torn = torn_muscles(tears);
  check.torn = int(torn.size());
  if (!torn.empty()) check.torn_muscle = muscles[torn.front()].name;
}

void check_shown(const LayerOrder& layers, const LayeredBody& body, AnatomyCheck& check) {
  const ShownThrough shown = measure_shown_through(layers, body);
  check.shown = shown.area;
  check.shown_most = shown.most;
  check.shown_by_one = shown.by_one;
  for (std::size_t m = 0; m < shown.muscles.size(); ++m) check.muscles[m].shown = shown.muscles[m];
}

void check_voids(const Subject& subject, const Shape& shape, const CheckOptions& options,
                 AnatomyCheck& check) {
  check.filled_share = check.slits = std::numeric_limits<double>::quiet_NaN();
  if (!subject.packaged) return;
  const Body& body = subject.model.character.body;
  const TriMesh wall = chest_wall_skin(subject.package, body.sex, shape.skin_points);
  const SkinRays rays(wall);
  const FatLayer fat =
      make_fat_layer(FatTables(subject.package.tables), rays, subject.anatomy(), body);
  const TriMesh flesh = flesh_of(subject, shape);
  const std::vector<VertexPart> parts = vertex_parts(subject.package);
  const LayerGaps gaps =
      measure_layer_gaps(wall, fat, parts, flesh, {shape.fascia, subject.fascia.F});
  check.filled_share = gaps.filled_share;
  check.gap_median = gaps.median;
  check.gap_p95 = gaps.p95;

  std::vector<char> looked_at(std::size_t(wall.V.rows()), 0);
  for (const int i : vertices_over_flesh(wall, parts)) looked_at[std::size_t(i)] = 1;
  const std::vector<double> slits = slit_areas(wall, fat.thickness, looked_at, flesh);
  check.slits = 0;
  double most = 0;
  for (std::size_t f = 0; f < slits.size(); ++f) {
    check.slits += slits[f];
    if (Eigen::Index(f) < subject.surface.F.rows())
      check.muscles[std::size_t(subject.surface.muscle[flesh.F(Eigen::Index(f), 0)])].slits +=
          slits[f];
  }
  for (std::size_t m = 0; m < check.muscles.size(); ++m) {
    if (check.muscles[m].slits <= most) continue;
    most = check.muscles[m].slits;
    check.slit_muscle = subject.anatomy().muscles[m].name;
  }
  if (!options.reference) return;
  std::optional<LayerOrder> made;
  if (!options.layers) made = template_layers(*options.reference, subject.package);
  check_shown(made ? *made : *options.layers, {subject.anatomy(), wall, fat, parts}, check);
}

void check_ends(const Subject& subject, AnatomyCheck& check) {
  const MuscleEnds ends = measure_muscle_ends(subject.anatomy());
  check.ends = int(ends.distances.size());
  check.loose_ends = ends.loose;
  for (std::size_t m = 0; m < ends.farthest.size(); ++m)
    check.muscles[m].end_distance = ends.farthest[m];
  if (ends.distances.empty()) return;
  check.end_distance_median = ends.distances[ends.distances.size() / 2];
  check.end_distance_max = ends.distances.back();
}

// How far each section's outline goes from its centre, m.
std::vector<double> reaches_of(std::span<const Ellipse> sections) {
  std::vector<double> out;
  for (const Ellipse& section : sections) {
    double& reach = out.emplace_back(0.0);
    for (std::size_t i = 0; i < kOutlinePoints; ++i)
      reach = std::max(reach, double(section.outline[i]) *
                                  outline_directions()[i].cwiseProduct(section.radii).norm());
  }
  return out;
}

// By how much a section goes farther than at rest and than those before and after it, m: a spike if
// it is much.
double sticking_out(std::span<const double> reaches, const SliceRange& strip, int k,
                    double at_rest) {
  double others = at_rest;
  if (k > strip.begin) others = std::max(others, reaches[k - 1]);
  if (k + 1 < strip.end) others = std::max(others, reaches[k + 1]);
  return reaches[k] - others;
}

// What one pose has to say about each muscle.
struct PosedMuscles {
  std::vector<double> outside, overlap, in_bone, drift;  // shares
  std::vector<double> spike;                             // m
  std::vector<MuscleWholeness> whole;
};

PoseCheck check_pose(const Subject& subject, const LimitPose& pose, double spacing,
                     PosedMuscles& muscles, PosedBones& bones) {
  Shape shape(subject.model);
  shape_pose(subject, pose.pose, shape);
  PoseCheck out;
  out.name = pose.name;
  const std::size_t count = subject.anatomy().muscles.size();
  for (std::vector<double>* list :
       {&muscles.outside, &muscles.overlap, &muscles.in_bone, &muscles.drift, &muscles.spike})
    list->assign(count, 0.0);
  const std::vector<int> winding = winding_numbers(shape.skin, shape.muscles);
  std::vector<int> points(count, 0);
  for (std::size_t i = 0; i < winding.size(); ++i) {
    const std::size_t m = subject.surface.muscle[i];
    ++points[m];
    if (winding[i] == 0) ++out.muscle_points_outside, ++muscles.outside[m];
  }
  bones = measure_bones(shape);
  out.bone_points_outside = bones.all_outside();
  for (double depth : bones.depth) out.bone_depth = std::max(out.bone_depth, depth);
  out.fascia = fascia_figures(subject, shape);
  const SolidVolumes volumes = measure_shape(subject, shape, spacing);
  out.overlap_share = volumes.muscle_overlap_share();
  out.bone_share = volumes.bone_overlap_share();
  for (std::size_t m = 0; m < count; ++m) {
    if (points[m] > 0) muscles.outside[m] /= points[m];
    if (!(volumes.volume[m] > 0)) continue;
    muscles.overlap[m] = volumes.in_muscle[m] / volumes.volume[m];
    muscles.in_bone[m] = volumes.in_bone[m] / volumes.volume[m];
  }
  muscles.whole = measure_wholeness(subject.rest_surface, subject.surface, subject.ranges,
                                    shape.frame.posed, flesh_of(subject, shape));
  double edges = 0, creased = 0;
  for (const MuscleWholeness& muscle : muscles.whole) {
    edges += muscle.edge_length;
    creased += muscle.creased_length;
    out.needles += muscle.needles;
    out.daylight += muscle.daylight;
    out.buried += muscle.buried;
    out.stretch = std::max(out.stretch, muscle.stretch);
    out.kink = std::max(out.kink, muscle.kink);
    out.loose_ends += muscle.end_off > kLooseEnd;
  }
  out.creased_share = edges > 0 ? creased / edges : 0;
  const std::vector<double> reaches = reaches_of(shape.frame.posed.slices);
  for (std::size_t i = 0; i < subject.ranges.size(); ++i) {
    double& drift = muscles.drift[subject.ranges[i].muscle];
    drift = std::max(
        drift,
        std::abs(strip_volume(shape.frame.posed, subject.ranges[i]) / subject.rest_volumes[i] - 1));
    double& spike = muscles.spike[subject.ranges[i].muscle];
    for (int k = subject.ranges[i].begin; k < subject.ranges[i].end; ++k) {
      const double by = sticking_out(reaches, subject.ranges[i], k, subject.rest_reaches[k]);
      spike = std::max(spike, by);
      out.spikes += by > kSticksOut;
    }
  }
  return out;
}

// Keeps a muscle's worst figures and their poses.
void note_wholeness(const MuscleWholeness& whole, int pose, MuscleCheck& muscle) {
  const double creased = whole.edge_length > 0 ? whole.creased_length / whole.edge_length : 0;
  if (creased > muscle.creased) muscle.creased = creased, muscle.creased_pose = pose;
  if (whole.needles > muscle.needles) muscle.needles = whole.needles, muscle.needles_pose = pose;
  if (whole.daylight > muscle.daylight)
    muscle.daylight = whole.daylight, muscle.daylight_pose = pose;
  if (whole.buried > muscle.buried) muscle.buried = whole.buried, muscle.buried_pose = pose;
  if (whole.stretch > muscle.stretch) muscle.stretch = whole.stretch, muscle.stretch_pose = pose;
  if (whole.kink > muscle.kink) muscle.kink = whole.kink, muscle.kink_pose = pose;
  if (whole.end_off > muscle.end_off) muscle.end_off = whole.end_off, muscle.end_off_pose = pose;
}

void check_poses(const Subject& subject, const std::vector<LimitPose>& poses,
                 const CheckOptions& options, const CheckProgress& progress, AnatomyCheck& check) {
  check.poses.resize(poses.size());
  std::vector<PosedMuscles> muscles(poses.size());
  std::vector<PosedBones> bones(poses.size());
  const int total = poses.size();
  std::atomic<int> done = 0;
  if (progress) progress(0, total);
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t p) {
    check.poses[p] = check_pose(subject, poses[p], options.pose_spacing, muscles[p], bones[p]);
    if (progress) progress(++done, total);
  });
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const PoseCheck& pose = check.poses[p];
    const double outside = double(pose.muscle_points_outside) / std::max(check.muscle_points, 1);
    check.posed_outside_share += outside / double(poses.size());
    check.posed_outside_worst = std::max(check.posed_outside_worst, outside);
    check.posed_bone_points_outside =
        std::max(check.posed_bone_points_outside, pose.bone_points_outside);
    const double sheets = double(poses.size()) * std::max(check.fascia.points, 1);
    check.posed_fascia_outside += pose.fascia.outside / sheets;
    check.posed_fascia_pierced += pose.fascia.pierced / sheets;
    check.posed_overlap_mean += pose.overlap_share / double(poses.size());
    check.posed_overlap_worst = std::max(check.posed_overlap_worst, pose.overlap_share);
    check.posed_bone_share_worst = std::max(check.posed_bone_share_worst, pose.bone_share);
    check.posed_spikes += double(pose.spikes) / double(poses.size());
    check.posed_creased_mean += pose.creased_share / double(poses.size());
    check.posed_creased_worst = std::max(check.posed_creased_worst, pose.creased_share);
    check.posed_needles += double(pose.needles) / double(poses.size());
    check.posed_daylight += pose.daylight / double(poses.size());
    check.posed_buried += pose.buried / double(poses.size());
    check.posed_stretch_max = std::max(check.posed_stretch_max, pose.stretch);
    check.posed_kink_max = std::max(check.posed_kink_max, pose.kink);
    check.posed_loose_ends += double(pose.loose_ends) / double(poses.size());
    for (std::size_t m = 0; m < check.muscles.size(); ++m) {
      MuscleCheck& muscle = check.muscles[m];
      if (muscles[p].outside[m] > muscle.posed_outside)
        muscle.posed_outside = muscles[p].outside[m], muscle.outside_pose = int(p);
      if (muscles[p].overlap[m] > muscle.posed_overlap)
        muscle.posed_overlap = muscles[p].overlap[m], muscle.overlap_pose = int(p);
      muscle.posed_in_bone = std::max(muscle.posed_in_bone, muscles[p].in_bone[m]);
      muscle.drift = std::max(muscle.drift, muscles[p].drift[m]);
      if (muscles[p].spike[m] > muscle.spike)
        muscle.spike = muscles[p].spike[m], muscle.spike_pose = int(p);
      note_wholeness(muscles[p].whole[m], int(p), muscle);
    }
    for (std::size_t b = 0; b < check.bones.size(); ++b) {
      BoneCheck& bone = check.bones[b];
      if (bones[p].outside[b] > bone.posed_outside)
        bone.posed_outside = bones[p].outside[b], bone.outside_pose = int(p);
      if (bones[p].depth[b] > bone.posed_depth)
        bone.posed_depth = bones[p].depth[b], bone.depth_pose = int(p);
    }
  }
}

void check_sweeps(const Subject& subject, double step, AnatomyCheck& check) {
  const Skeleton& skeleton = subject.anatomy().skeleton;
  ContactWorkspace contact;
  const auto worst = measure_sweeps(
      [&](const Pose& pose, PosedAnatomy& posed) {
        pose_muscles(subject.model.muscles, skeleton, pose, posed, contact);
      },
      skeleton, subject.ranges, joint_sweeps(skeleton, step));
  for (std::size_t i = 0; i < worst.size(); ++i) {
    MuscleCheck& muscle = check.muscles[subject.ranges[i].muscle];
    muscle.drift = std::max(muscle.drift, worst[i].drift.size);
    if (!(worst[i].length.size > muscle.jump)) continue;
    muscle.jump = worst[i].length.size;
    muscle.jump_joint = worst[i].length.joint;
    muscle.jump_axis = worst[i].length.axis;
    muscle.jump_angle = worst[i].length.angle;
  }
}

}  // namespace

AnatomyCheck check_anatomy(const CharacterModel& model, const BodyPackage& package,
                           const std::vector<LimitPose>& poses, const CheckOptions& options,
                           const CheckProgress& progress) {
  const Anatomy& anatomy = model.character.anatomy;
  Subject subject{model,
                  package,
                  make_muscle_surface(anatomy),
                  slice_ranges(anatomy),
                  {},
                  {},
                  {},
                  make_fascia_surface(anatomy),
                  rest_positions(anatomy.skeleton),
                  false};
  subject.packaged =
      !model.character.own && model.character.body.skin.V.rows() == package.skin_size;
  AnatomyCheck check;
  check.muscles.resize(anatomy.muscles.size());
  check.bones.resize(anatomy.bones.size());
  Shape rest(model);
  shape_pose(subject, rest_pose(anatomy.skeleton), rest);
  for (const SliceRange& range : subject.ranges)
    subject.rest_volumes.push_back(strip_volume(rest.frame.posed, range));
  subject.rest_reaches = reaches_of(rest.frame.posed.slices);
  if (!poses.empty())
    subject.rest_surface = make_rest_surface(anatomy, subject.surface, subject.ranges,
                                             rest.frame.posed, flesh_of(subject, rest));
  check_rest(subject, rest, options, check);
  check.bone_overlap = measure_bone_overlap(anatomy.bones, options.rest_spacing);
  check_torn(subject, options, check);
  check_voids(subject, rest, options, check);
  check_ends(subject, check);
  check_poses(subject, poses, options, progress, check);
  check.swept = options.sweep_step > 0;
  if (check.swept) check_sweeps(subject, options.sweep_step, check);
  for (const MuscleCheck& muscle : check.muscles) {
    check.drift_max = std::max(check.drift_max, muscle.drift);
    check.jump_max = std::max(check.jump_max, muscle.jump);
    check.posed_spike_max = std::max(check.posed_spike_max, muscle.spike);
    check.paths_that_jump += muscle.jump > kJump;
  }
  return check;
}

}  // namespace ecorche::inline v1
