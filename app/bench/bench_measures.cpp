#include "app/bench/bench_measures.h"

#include <oneapi/tbb/global_control.h>

#include "anatomy/base_mesh/refined_skin.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/muscles/action_line.h"
#include "app/bench/bench_timer.h"
#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/solve_measures.h"
#include "morph/tissue/interior_interpolation.h"

namespace ecorche {
namespace {

constexpr const char* kEight[] = {"neck_base_girth",    "chest_girth", "waist_girth",
                                  "hip_girth",          "stature",     "crotch_height",
                                  "arm_length_outseam", "weight"};
constexpr const char* kRegions[] = {"stature",
                                    "cervicale_height",
                                    "waist_height",
                                    "crotch_height",
                                    "knee_height_midpatella",
                                    "lateral_malleolus_height",
                                    "shoulder_length",
                                    "arm_length_outseam",
                                    "waist_back_length",
                                    "biacromial_breadth",
                                    "head_girth",
                                    "neck_girth",
                                    "neck_base_girth",
                                    "chest_girth",
                                    "underbust_girth",
                                    "waist_girth",
                                    "hip_girth",
                                    "thigh_girth",
                                    "knee_girth",
                                    "calf_girth",
                                    "ankle_girth",
                                    "upper_arm_girth_relaxed",
                                    "forearm_girth",
                                    "wrist_girth"};

// Targets a little away from the mean body, so that the solver does not start at a solution.
template <class Names>
std::vector<MeasureTarget> targets_of(const TapeMeasure& tape, const ShapeSpace& space,
                                      const Names& names) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(space.basis.cols());
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(12, z.size()); ++i)
    z[i] = i % 2 == 0 ? 0.7 : -0.5;
  const Points body = space_points(space, z);
  std::vector<MeasureTarget> out;
  for (const char* name : names)
    out.push_back({tape.table().at(name), tape.take(tape.table().at(name), body)});
  return out;
}

// Points that move with an edited skin: vertices of all bones, and centre and two ends of each
// slice.
Points inner_points(const Anatomy& anatomy) {
  const std::vector<Ellipse> slices = rest_slices(anatomy);
  Eigen::Index count = 3 * Eigen::Index(slices.size()), row = 0;
  for (const Bone& bone : anatomy.bones) count += bone.mesh.V.rows();
  Points out(count, 3);
  for (const Bone& bone : anatomy.bones) {
    out.middleRows(row, bone.mesh.V.rows()) = bone.mesh.V;
    row += bone.mesh.V.rows();
  }
  for (const Ellipse& slice : slices)
    for (const Vec3& p : {slice.center, Vec3(slice.center + slice.radii.x() * slice.axes.col(0)),
                          Vec3(slice.center + slice.radii.y() * slice.axes.col(1))})
      out.row(row++) = p.transpose();
  return out;
}

}  // namespace

std::vector<TimedLine> bench_measures(const BodyPackage& package, const Character& character,
                                      int rounds) {
  const TapeMeasure tape(package, read_measure_table(package, package.tables / "body"));
  const ShapeSpace space = read_shape_space(package, tape, Sex::female);
  const Refinement refinement = refine_skin(package);
  const int waist = tape.table().at("waist_girth");
  std::vector<MeasureTarget> eight = targets_of(tape, space, kEight),
                             regions = targets_of(tape, space, kRegions);
  const SolvedBody body = solve_measures(tape, space, eight),
                   body_24 = solve_measures(tape, space, regions);
  double change = 0.005;  // to and fro
  const auto edited = [&](std::vector<MeasureTarget> targets) {
    change = -change;
    for (MeasureTarget& target : targets)
      if (target.measure == waist) target.value += change;
    return targets;
  };
  SolvedBody out;
  Points fine, moved;
  const SkinInterpolation carrier =
      make_skin_interpolation(character.body.skin.V, inner_points(character.anatomy));
  const std::vector<BenchCase> cases{
      {"new", [&] { out = solve_measures(tape, space, eight); }},
      {"edit", [&] { out = solve_measures(tape, space, edited(eight), {}, &body.z); }},
      {"edit_inside",
       [&] {
         out = solve_measures(tape, space, edited(eight), {}, &body.z);
         carry(carrier, out.points, moved);
       }},
      {"edit_fine", [&] {
         out = solve_measures(tape, space, edited(regions), {}, &body_24.z);
         fine = refine_points(refinement, out.points);
       }}};
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism,
                                1);  // CPU time of this thread is all there is
  const std::vector<double> times = least_cpu_times(cases, rounds);
  return {
      {"measures_new_13k", "a body from eight measures, 13k", times[0], 0.050},
      {"measures_edit_13k", "one of its measures edited, 13k", times[1], 0.016},
      {"measures_edit_inside_13k", "the same, bones and muscles carried along", times[2], 0.150},
      {"measures_edit_120k", "one of 24 measures edited, 120k", times[3], 0.100}};
}

}  // namespace ecorche
