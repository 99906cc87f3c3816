#include "app/verbs/bench_verb.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/base_mesh/chest_wall.h"
#include "anatomy/base_mesh/refined_skin.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/muscles/action_line.h"
#include "app/bench/bench_measures.h"
#include "app/bench/bench_retarget.h"
#include "app/bench/bench_timer.h"
#include "app/files/actor.h"
#include "app/files/fitted_actor.h"
#include "app/files/open_motion.h"
#include "app/options/option_values.h"
#ifdef ECORCHE_WINDOW
#include "app/studio/design/bench_history.h"
#include "app/studio/design/bench_window.h"
#endif
#include "morph/dilation/slice_clearance.h"
#include "morph/registration/attached_skin.h"
#include "morph/shapes/standard_bodies.h"
#include "morph/template/template_cache.h"
#include "skinning/evaluation/blend_skinning.h"

namespace ecorche {
namespace {

struct Ratio {
  std::string name, what;
  double seconds = 0, reference = 0, asked = 0;
  double value() const { return seconds / reference; }
};

// The plain linear blend of the same mesh: four influences, positions and normals.
BlendSkin blend_of(const Actor& actor) {
  std::vector<std::vector<BoneWeight>> weights;
  for (const auto& four : actor.binding.joint_weights) {
    weights.emplace_back();
    for (const Influence& influence : four)
      weights.back().push_back({influence.joint, influence.weight});
  }
  return make_blend_skin(actor.character.body.skin, weights);
}

// poses, spread over the motion: they take about as long as 60 of a tendon model
constexpr std::size_t kRow = 12;

// Sequential poses, as in an animation. Milliseconds of one pose: those of the row over their
// number.
std::function<void()> row_of_poses(const Actor& actor, const Motion& motion, PosedAnatomy& posed,
                                   ContactWorkspace& contact, int threads = 1) {
  return [&, threads] {
    for (std::size_t k = 0; k < kRow; ++k)
      pose_muscles(actor.muscles, actor.character.anatomy.skeleton,
                   motion.frames[k * motion.frames.size() / kRow], posed, contact, threads);
  };
}

// A complete frame beside linear blend skinning of the same mesh, over the poses of a motion.
std::vector<Ratio> bench_frames(const Actor& actor, const Motion& motion, const std::string& size,
                                double asked, int rounds) {
  const BlendSkin blend = blend_of(actor);
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const auto rest = rest_positions(skeleton);
  ActorState frame(actor);
  SkinFrame linear;
  std::vector<Transform> X_WJ, bones;
  size_t at = 0, at_linear = 0, at_muscles = 0;
  PosedAnatomy posed;
  ContactWorkspace contact;
  Actor still = actor;
  still.method = SkinMethod::anchors;
  size_t at_still = 0, at_skin = 0;
  const std::vector<BenchCase> cases{
      {"frame", [&] { evaluate(actor, motion.frames[at++ % motion.frames.size()], {}, frame); }},
      {"linear",
       [&] {
         forward_kinematics(skeleton, motion.frames[at_linear++ % motion.frames.size()], X_WJ);
         bones = X_WJ;
         for (size_t j = 0; j < bones.size(); ++j) bones[j].translate(-rest[j]);
         deform_linear(blend, bones, linear);
       }},
      {"muscles",
       [&] {
         pose_muscles(actor.muscles, skeleton, motion.frames[at_muscles++ % motion.frames.size()],
                      posed, contact);
       }},
      {"row", row_of_poses(actor, motion, posed, contact)},
      {"skin",
       [&] { evaluate_skin(actor, motion.frames[at_skin++ % motion.frames.size()], {}, frame); }},
      {"still",
       [&] { evaluate(still, motion.frames[at_still++ % motion.frames.size()], {}, frame); }}};
  const auto times = least_cpu_times(cases, rounds);
  return {
      {"frame_" + size, "whole frame, settled / linear blend with normals, " + size, times[0],
       times[1], 0},
      {"frame_skin_" + size, "the same, muscles not parted beneath the settled skin", times[4],
       times[1], 0},
      {"frame_anchors_" + size, "the same without settling (--skin anchors)", times[5], times[1],
       asked},
      {"muscles_" + size, "kinematics and all muscles, between other work / linear blend, " + size,
       times[2], times[1], 0},
      {"muscles_row_" + size, "the same, pose after pose / linear blend, " + size, times[3] / kRow,
       times[1], 0}};
}

// A skin of as many vertices as the fine one that is a stranger's: its vertices in no order of ours
// and a millimetre off the base mesh, which it is attached to.
Character as_stranger(const Character& fine, const BaseSkin& base, const BodyPackage& package) {
  const Eigen::Index count = fine.body.skin.V.rows();
  constexpr Eigen::Index kStride = 7919;  // prime
  std::vector<Eigen::Index> place(std::size_t(count), 0);
  for (Eigen::Index i = 0; i < count; ++i) place[std::size_t(i)] = i * kStride % count;
  StandingMesh mesh{{Points(count, 3), fine.body.skin.F}, {}};
  for (Eigen::Index i = 0; i < count; ++i)
    mesh.mesh.V.row(place[std::size_t(i)]) =
        fine.body.skin.V.row(i) + Eigen::RowVector3d(0.001, 0, 0);
  for (int* v = mesh.mesh.F.data(); v != mesh.mesh.F.data() + mesh.mesh.F.size(); ++v)
    *v = int(place[std::size_t(*v)]);
  Registration standing;
  standing.posed = standing.body.skin.V = base.mesh.V;
  standing.turn.assign(std::size_t(base.mesh.V.rows()), Mat3::Identity());
  AttachedSkin skin = attach_skin(standing, package.triangles, vertex_parts(package), mesh);
  Character out = fine;
  out.body.skin = {std::move(skin.rest), std::move(mesh.mesh.F)};
  auto own = std::make_shared<OwnSkin>();
  own->base = base.mesh;
  own->map = std::move(skin.map);
  out.own = std::move(own);
  return out;
}

Ratio bench_stranger(const Actor& stranger, const Actor& ours, const Motion& motion, int rounds) {
  ActorState theirs(stranger), own(ours);
  std::size_t at = 0, at_ours = 0;
  const std::vector<BenchCase> cases{
      {"stranger",
       [&] { evaluate(stranger, motion.frames[at++ % motion.frames.size()], {}, theirs); }},
      {"ours", [&] { evaluate(ours, motion.frames[at_ours++ % motion.frames.size()], {}, own); }}};
  const auto times = least_cpu_times(cases, rounds);
  return {"frame_stranger_120k", "whole frame of a stranger's skin / of ours of that size, 120k",
          times[0], times[1], 1.3};
}

// Dilation as `fit` runs it, with bones, beside its lower bound: one ray in each direction of
// each slice.
std::vector<Ratio> bench_dilation(const Template& body_template, const FittedActor& fitted,
                                  const BodyPackage& package, int rounds) {
  const Body& body = fitted.actor.character.body;
  const SkinRays rays(chest_wall_skin(package, body.sex, body.skin.V));
  const FatLayer fat = make_fat_layer(body_template.tables.fat, rays, fitted.undilated, body);
  const auto slices = rest_slices(fitted.undilated);
  const std::vector<Vec2> directions = ray_directions(DilateOptions{}.rays);
  DilateOptions ours, paper, uncut;
  ours.even_about = fitted.report.fit.even_about;
  DilateOptions ellipses = ours;
  ellipses.share = false;
  paper.method = uncut.method = DilateMethod::paper;
  uncut.cut_rays = false;
  double sum = 0;
  const auto cast = [&] {
    for (const Ellipse& slice : slices)
      for (const Vec2& direction : directions)
        sum += rays.first_hit(slice.center, slice.axes.leftCols<2>() * direction).distance;
  };
  Anatomy anatomy = fitted.undilated;
  const auto dilate = [&](const DilateOptions& options) {
    return [&, options] {
      dilate_muscles(anatomy, fitted.undilated.muscles, body_template.tables.muscles, rays, fat,
                     options);
    };
  };
  const std::vector<BenchCase> cases{{"rays", cast},
                                     {"paper", dilate(uncut)},
                                     {"cut", dilate(paper)},
                                     {"ours", dilate(ours)},
                                     {"ellipses", dilate(ellipses)}};
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism,
                                1);  // CPU time of this thread is all there is
  const auto times = least_cpu_times(cases, rounds);
  return {{"dilation_paper", "dilation, paper's factor / its bare rays", times[1], times[0], 1.15},
          {"dilation_cut", "the same with rays cut at the running minimum / bare rays", times[2],
           times[0], 0.7},
          {"dilation", "dilation as in fit, flesh, slices and surface / bare rays", times[3],
           times[0], 0},
          {"dilation_ellipses", "the same, neighbours not parted (--method ellipses) / bare rays",
           times[4], times[0], 0}};
}

struct BenchVerbOptions {
  int rounds = 9;
  std::filesystem::path motion;
  bool muscles = false, studio = false;
};

int run_studio_bench(const Common& common, Report& report) {
#ifdef ECORCHE_WINDOW
  fmt::print("{:<66} {:>10} {:>7} {:>7}\n", "", "ms", "", "asked");
  for (const WindowLine& line : bench_window(common, report)) {
    report.set("bench." + line.name + ".ms", line.ms);
    fmt::print("{:<66} {:>10.1f} {:>7} {:>7.1f}\n", line.what, line.ms, "", line.asked);
  }
  const HistoryCost history = bench_history(common, report, 1000);
  report.set("bench.studio_history.megabytes", history.megabytes);
  report.set("bench.studio_history.longest_undo_ms", 1e3 * history.longest_undo);
  fmt::print("{:<66} {:>10.1f} {:>7} {:>7.1f}\n", "studio: any of 1,000 edits taken back, longest",
             1e3 * history.longest_undo, "", 30.0);
  fmt::print("{:<66} {:>10.1f} {:>7} {:>7.1f}\n", "studio: the memory of 1,000 edits",
             history.megabytes, "MB", 200.0);
  return 0;
#else
  (void)common, (void)report;
  throw UsageError("bench: this program was built without a window; leave --studio away");
#endif
}

int run_retarget_bench(const BenchVerbOptions& options, const Character& character,
                       Report& report) {
  const RetargetPace pace = bench_retarget(options.motion, character, options.rounds);
  report.set("bench.retarget.frames_per_second", pace.frames_per_second);
  report.set("bench.retarget.ratio", pace.ratio);
  fmt::print("retargeting: {:.0f} frames/s of a core, {:.0f} times the kinematics of its poses\n",
             pace.frames_per_second, pace.ratio);
  return 0;
}

int run_bench(const BenchVerbOptions& options, const Common& common, Report& report) {
  if (options.studio) return run_studio_bench(common, report);
  const int rounds = options.rounds;
  const BodyPackage package = read_body_package(common.assets);
  const Template body_template = read_template(common.assets);
  const FittedActor fitted =
      fit_actor(common.assets, body_template, make_body(package, athlete()), package, {}, report);
  if (!options.motion.empty()) return run_retarget_bench(options, fitted.actor.character, report);
  const Motion motion = open_motion(common.assets.tables / "motions" / "long_jump.bvh",
                                    fitted.actor, {}, common, report);

  if (options.muscles) {
    PosedAnatomy posed;
    ContactWorkspace contact;
    const std::vector<BenchCase> row{{"row", row_of_poses(fitted.actor, motion, posed, contact)}};
    const double ms = 1e3 * least_cpu_times(row, rounds)[0] / kRow;
    const std::vector<BenchCase> shared{
        {"row", row_of_poses(fitted.actor, motion, posed, contact,
                             tbb::this_task_arena::max_concurrency())}};
    const double clock_ms = 1e3 * least_clock_times(shared, rounds)[0] / kRow;
    report.set("bench.muscles_row_13k.ms", ms);
    report.set("bench.muscles_row_13k.all_cores_ms", clock_ms);
    fmt::print(
        "kinematics and all muscles, pose after pose: {:.3f} ms on one thread, {:.3f} ms by the "
        "clock on all cores\n",
        ms, clock_ms);
    return 0;
  }
  note(common, "13k vertices");
  std::vector<Ratio> ratios = bench_frames(fitted.actor, motion, "13k", 5, rounds);
  for (const Ratio& ratio : bench_dilation(body_template, fitted, package, std::max(3, rounds / 2)))
    ratios.push_back(ratio);

  note(common, "120k vertices");
  Character fine = fitted.actor.character;
  const BaseSkin base{fine.body.skin, refine_skin(package)};
  fine.body.skin = {refine_points(base.refinement, fine.body.skin.V), base.refinement.F};
  Report fine_report;
  const Actor fine_actor = make_actor(common.assets, std::move(fine), fine_report, {.base = &base});
  for (const Ratio& ratio : bench_frames(fine_actor, motion, "120k", 3, rounds))
    ratios.push_back(ratio);
  Report aside;
  const Actor stranger =
      make_actor(common.assets, as_stranger(fine_actor.character, base, package), aside);
  ratios.push_back(bench_stranger(stranger, fine_actor, motion, rounds));

  fmt::print("{:<66} {:>10} {:>7} {:>7}\n", "", "ms", "ratio", "asked");
  for (const Ratio& ratio : ratios) {
    report.set("bench." + ratio.name + ".ms", 1e3 * ratio.seconds);
    report.set("bench." + ratio.name + ".ratio", ratio.value());
    fmt::print("{:<66} {:>10.3f} {:>7.2f} {:>7}\n", ratio.what, 1e3 * ratio.seconds, ratio.value(),
               ratio.asked > 0 ? fmt::format("{:.2f}", ratio.asked) : "");
  }
  for (const TimedLine& line : bench_measures(package, fitted.actor.character, rounds)) {
    report.set("bench." + line.name + ".ms", 1e3 * line.seconds);
    fmt::print("{:<66} {:>10.3f} {:>7} {:>7}\n", line.what + " (CPU time)", 1e3 * line.seconds, "",
               fmt::format("{:.0f}", 1e3 * line.asked));
  }
  const auto ms = [&](const char* name) {
    return report.number(std::string("timings_ms.") + name);
  };
  const double shared = ms("fit_bones") + ms("fit_muscles") + ms("dilation");
  const double total = shared + ms("anchoring"),
               fine_total = shared + fine_report.number("timings_ms.anchoring");
  report.set("bench.fit_and_anchor_13k_ms", total);
  report.set("bench.fit_and_anchor_120k_ms", fine_total);
  fmt::print("{:<66} {:>10.0f} {:>7} {:>7}\n",
             "bones, muscles, dilation, anchoring, 13k (wall time)", total, "", "1000");
  fmt::print("{:<66} {:>10.0f} {:>7} {:>7}\n", "the same, 120k", fine_total, "", "1500");
  return 0;
}

}  // namespace

void add_bench_verb(VerbRegistry& registry) {
  auto options = std::make_shared<BenchVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "bench", "Measure speed, as ratios within one run",
      "ecorche bench --report bench.json", [options](const Common& common, Report& report) {
        return run_bench(*options, common, report);
      });
  verb->add_flag("--studio", options->studio,
                 "Only the studio's window, by a session of 1280x720 (needs a display)");
  verb->add_flag("--muscles", options->muscles, "Only the posing of all muscles, pose after pose");
  verb->add_option("--motion", options->motion,
                   "Only the retargeting of this motion. Example: --motion walk.bvh");
  verb->add_option("--rounds", options->rounds,
                   "Interleaved repetitions; the least time of each case counts")
      ->check(between(3, 1000))
      ->capture_default_str();
}

}  // namespace ecorche
