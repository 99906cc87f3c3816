#include "app/files/fitted_actor.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/base_mesh/refined_skin.h"
#include "anatomy/geometry/subdivide.h"
#include "morph/fat/body_composition.h"
#include "morph/fat/muscle_mass.h"
#include "skinning/rigs/standing_pose.h"

namespace ecorche {
namespace {

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + long(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Median gap between muscles and the fat layer all over the limbs. The exact distance from each
// skin vertex to the nearest part is known from the anchoring; what is left after fat and skin is
// the gap.
double skin_gap(const Binding& binding, const Refinement* refinement, const FatLayer& fat,
                const std::vector<VertexPart>& parts) {
  std::vector<double> gaps;
  for (int i = 0; i < std::min<int>(binding.vertex_count, int(parts.size())); ++i) {
    const Anchor& anchor = binding.anchors[refinement ? refinement->base_rows[i] : i];
    if (is_limb(parts[i].part) && anchor.kind == Anchor::Kind::muscle)
      gaps.push_back(anchor.distance - fat.thickness[i]);
  }
  return median(gaps);
}

// With the pose in which it stands, by the weights that were found.
std::shared_ptr<const OwnSkin> own_skin(const HungSkin* hung, const Skeleton& skeleton,
                                        const Binding& binding) {
  if (!hung) return nullptr;
  auto out = std::make_shared<OwnSkin>(hung->own);
  out->pose = standing_pose(skeleton, hung->rest.V, hung->standing, binding.joint_weights);
  return out;
}

struct FitInput {
  const Template& body_template;
  const Body& body;
  const BodyPackage& package;
  const FittedActorOptions& options;
};

// Fits, binds by bind(character, options), which returns the binding, and reports.
template <class Bind>
void fit_and_bind(const FitInput& input, const Bind& bind, FitOutcome& out, Report& report) {
  FittingOptions fitting = input.options.fitting;
  std::vector<VertexPart> read;
  if (!fitting.parts) {
    read = vertex_parts(input.package);
    fitting.parts = &read;
  }
  FittedCharacter fitted = fit_character(input.body_template, input.body, input.package, fitting);
  report.set("timings_ms.dilation", fitted.report.dilation_ms);  // stages in their order
  Character character{std::move(fitted.anatomy), input.body};
  std::optional<BaseSkin> base;
  if (const HungSkin* hung = input.options.hung) {
    base = BaseSkin{hung->own.base, {hung->own.map, hung->rest.F, {}, {}}};
    character.body.skin = hung->rest;
  } else if (input.options.fine_skin) {
    base = BaseSkin{input.body.skin, refine_skin(input.package)};
    character.body.skin = {refine_points(base->refinement, input.body.skin.V), base->refinement.F};
  }
  const Binding& binding =
      bind(std::move(character), ActorOptions{base ? &*base : nullptr, input.options.weights});
  out.undilated = std::move(fitted.undilated);
  out.tissue = std::move(fitted.tissue);
  out.report = std::move(fitted.report);
  if (fitting.tissues && !input.options.hung)  // which may be clothes
    out.skin_gap_median =
        skin_gap(binding, base ? &base->refinement : nullptr, fitted.fat, *fitting.parts);
  report_fit(out.report, out.skin_gap_median, report);
}

}  // namespace

void report_fit(const FittingReport& fitted, double skin_gap_median, Report& report) {
  const FitReport& fit = fitted.fit;
  report.set("timings_ms.dilation", fitted.dilation_ms);
  report.set("timings_ms.fit_bones", fit.bones_ms);
  report.set("timings_ms.fit_muscles", fit.muscles_ms);
  if (const InteriorReport& interior = fit.interior; interior.warp_ms > 0) {
    report.set("timings_ms.fit_tissue_prepared", interior.prepare_ms);
    report.set("timings_ms.fit_tissue_warp", interior.warp_ms);
    report.set("fit.tissue.nodes", interior.nodes);
    report.set("fit.tissue.tetrahedra", interior.tetrahedra);
    report.set("fit.tissue.inverted", interior.inverted);
    report.set("fit.tissue.template_soft_volume", interior.soft_before);
    report.set("fit.tissue.soft_volume", interior.soft_after);
  }
  report.set("fit.muscle_surface_outside_before_keeping_inside", fitted.dilation.surface_outside);
  report.set("fit.muscles_collapsed", fitted.dilation.collapsed);
  report.set("rays", double(fitted.dilation.rays));
  report.set("fit.ray_misses", double(fitted.dilation.misses));
  report.set("fit.stature", fit.stature);
  report.set("fit.bone_vertices", fit.bone_vertices);
  report.set("fit.bone_vertices_outside", fit.bones_outside);
  report.set("fit.muscle_points", fitted.fill.points);
  report.set(
      "fit.muscle_points_outside_share",
      fitted.fill.points > 0 ? double(fitted.fill.points_outside) / fitted.fill.points : 0.0);
  report.set("fit.muscle_points_outside_max", fitted.fill.furthest);
  report.set("fit.bone_overlap_share_max", fitted.fill.pierced_share);
  report.set("fit.bone_overlap_muscle", fitted.fill.pierced_muscle);
  report.set("fit.muscle_overlap_share", fitted.fill.overlap_share);
  report.set("fit.muscle_in_bone_share", fitted.fill.bone_share);
  report.set("fit.filled_share", fitted.fill.filled_share);
  report.set("fit.shown_through", fitted.fill.shown);
  report.set("fit.shown_through_by_one", fitted.fill.shown_by_one);
  report.set("fit.shown_through_most", fitted.fill.shown_most);
  report.set("fit.loose_ends", fitted.fill.loose_ends);
  report.set("fit.torn_muscles", int(fitted.fill.torn.size()));
  report.set("fit.torn_muscle", fitted.fill.torn.empty() ? "" : fitted.fill.torn.front());
  report.set("fit.needles_at_rest", fitted.fill.needles);
  report.set("fit.superficial_gap_median", fitted.fill.superficial_gap_median);
  report.set("fit.skin_gap_median", skin_gap_median);
  report.set("fit.muscle_mass_wanted", fit.muscle_mass);
  report.set("fit.muscle_volume_wanted", fitted.dilation.target_volume);
  report.set("fit.muscle_volume", fitted.dilation.volume);
  const Tissues& tissues = fitted.tissues;
  report.set("fit.tissue_volume.body", tissues.body);
  report.set("fit.tissue_volume.bones", tissues.bones);
  report.set("fit.tissue_volume.muscles", tissues.muscles);
  report.set("fit.tissue_volume.layer", tissues.layer);
  report.set("fit.tissue_volume.rest", tissues.rest);
  report.set("fit.tissue_mass.bones", kBoneDensity * tissues.bones);
  report.set("fit.tissue_mass.muscles", kMuscleDensity * tissues.muscles);
  report.set("fit.tissue_mass.layer", kAdiposeDensity * tissues.layer);
  report.set("fit.tissue_mass.rest", kOrganDensity * tissues.rest);
  report.set("fit.landmarks", int(fit.landmarks.size()));
  report.set("fit.landmarks_off_bracket",
             int(std::count_if(fit.landmarks.begin(), fit.landmarks.end(), is_off)));
  for (const LandmarkDepth& landmark : fit.landmarks)
    report.set("fit.landmark_depth." + landmark.name, landmark.depth);
}

FittedActor fit_actor(const Assets& assets, const Template& body_template, const Body& body,
                      const BodyPackage& package, const FittedActorOptions& options,
                      Report& report) {
  FittedActor out;
  const auto bind = [&](Character character, const ActorOptions& how) -> const Binding& {
    out.actor = make_actor(assets, std::move(character), report, how);
    return out.actor.binding;
  };
  fit_and_bind({body_template, body, package, options}, bind, out, report);
  Character& character = out.actor.character;
  character.own = own_skin(options.hung, character.anatomy.skeleton, out.actor.binding);
  return out;
}

FittedForFile fit_for_file(const Assets& assets, const Template& body_template, const Body& body,
                           const BodyPackage& package, const FittedActorOptions& options,
                           Report& report) {
  FittedForFile out;
  const auto bind = [&](Character character, const ActorOptions& how) -> const Binding& {
    out.bound = bind_character(assets, std::move(character), report, how);
    return out.bound.binding;
  };
  fit_and_bind({body_template, body, package, options}, bind, out, report);
  Character& character = out.bound.character;
  character.own = own_skin(options.hung, character.anatomy.skeleton, out.bound.binding);
  return out;
}

Character fit_unbound(const Template& body_template, const Body& body, const BodyPackage& package,
                      const FittingOptions& options, Report& report) {
  FittedCharacter fitted = fit_character(body_template, body, package, options);
  report_fit(fitted.report, 0, report);
  return {std::move(fitted.anatomy), body};
}

}  // namespace ecorche
