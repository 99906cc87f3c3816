#include "skinning/checks/bodies_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "morph/fat/muscle_mass.h"
#include "morph/fit/fit_character.h"
#include "morph/template/template_cache.h"
#include "skinning/character/character_model.h"
#include "skinning/checks/check_targets.h"

namespace ecorche::inline v1 {
namespace {

double outside_share(const AnatomyCheck& check) {
  return check.muscle_points > 0 ? double(check.muscle_points_outside) / check.muscle_points : 0;
}

}  // namespace

std::vector<BodySpec> checked_bodies() {
  std::vector<BodySpec> bodies = standard_bodies();
  bodies.push_back(athlete());
  bodies.push_back(
      {.sex = Sex::female, .age = 30, .height = 1.82, .mass = 72, .name = "tall_female"});
  bodies.push_back(
      {.sex = Sex::female, .age = 45, .height = 1.62, .mass = 87, .name = "obese_female"});
  bodies.push_back({.sex = Sex::male, .age = 55, .height = 1.70, .mass = 88, .name = "stout_male"});
  bodies.push_back(
      {.sex = Sex::male, .age = 22, .height = 1.92, .mass = 72, .name = "slim_tall_male"});
  return bodies;
}

std::vector<BodyCheck> check_bodies(const Assets& assets, const std::vector<BodySpec>& bodies,
                                    const std::vector<LimitPose>& poses,
                                    const CheckProgress& progress) {
  const BodyModel model(assets);
  const BodyPackage& package = model.package();
  const Template body_template = read_template(assets);
  const LayerOrder layers = template_layers(body_template, package);
  std::vector<Body> all;  // before any is fitted: one that cannot be had is told at once
  for (const BodySpec& spec : bodies) all.push_back(make_body(model, spec));
  std::vector<BodyCheck> checks;
  if (progress) progress(0, int(bodies.size()));
  for (const Body& made : all) {
    FittedCharacter fitted = fit_character(body_template, made, package, {.layers = &layers});
    const CharacterModel compiled =
        compile_character({std::move(fitted.anatomy), made}, {.muscles = MuscleMotion::map});
    CheckOptions options;
    options.sweep_step = 0;
    options.reference = &body_template;
    options.layers = &layers;
    BodyCheck body;
    body.name = bodies[checks.size()].name;
    body.mass = made.mass;
    body.stature = made.skin.V.col(1).maxCoeff() - made.skin.V.col(1).minCoeff();
    body.tissues = fitted.report.tissues;
    body.target_volume = fitted.report.dilation.target_volume;
    body.dilation_ms = fitted.report.dilation_ms;
    body.check = check_anatomy(compiled, package, poses, options);
    checks.push_back(std::move(body));
    if (progress) progress(int(checks.size()), int(bodies.size()));
  }
  return checks;
}

std::string bodies_table(const std::vector<BodyCheck>& checks) {
  std::string out =
      fmt::format("{:<16}{:>7}{:>7}{:>7}{:>10}{:>9}{:>8}{:>8}{:>9}{:>9}\n", "body", "cm", "kg",
                  "bones", "muscles", "overlap", "in bone", "filled", "muscle", "wanted");
  out += fmt::format("{:<16}{:>7}{:>7}{:>7}{:>10}{:>9}{:>8}{:>8}{:>9}{:>9}\n", "  asked", "", "",
                     "out 0", "<=0.050 %", "<=2 %", "<=1 %", ">=95 %", "kg", "kg");
  bool posed = false;
  for (const BodyCheck& body : checks) {
    const AnatomyCheck& c = body.check;
    posed = posed || !c.poses.empty();
    out += fmt::format(
        "{:<16}{:>7.1f}{:>7.1f}{:>7}{:>8.3f} %{:>7.2f} %{:>6.2f} %{:>6.1f} %{:>9.1f}{:>9.1f}\n",
        body.name, 100 * body.stature, body.mass, c.bone_points_outside, 100 * outside_share(c),
        100 * c.overlap_share, 100 * c.bone_share, 100 * c.filled_share,
        kMuscleDensity * body.tissues.muscles, kMuscleDensity * body.target_volume);
  }
  if (!posed) return out;
  out += fmt::format("\n{:<16}{:>16}{:>18}\n", "posed", "outside, mean", "overlap, worst");
  for (const BodyCheck& body : checks)
    out += fmt::format("{:<16}{:>14.3f} %{:>16.2f} %\n", body.name,
                       100 * body.check.posed_outside_share, 100 * body.check.posed_overlap_worst);
  return out;
}

std::string bodies_csv(const std::vector<BodyCheck>& checks) {
  std::string out =
      "body,stature_m,mass_kg,bone_points_outside,muscle_outside_share,muscle_overlap_share,bone_"
      "overlap_share,filled_share,shown_m2,shown_most_m2,shown_most,gap_p95_m,muscle_l,wanted_l,"
      "bone_l,layer_l,rest_l,dilation_"
      "ms,posed_outside_share,posed_overlap_worst\n";
  for (const BodyCheck& body : checks) {
    const AnatomyCheck& c = body.check;
    const Tissues& t = body.tissues;
    out += fmt::format(
        "{},{:.4f},{:.2f},{},{:.6f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{},{:.5f},{:.3f},{:.3f},{:."
        "3f},{:.3f},{:.3f},"
        "{:.0f},",
        body.name, body.stature, body.mass, c.bone_points_outside, outside_share(c),
        c.overlap_share, c.bone_share, c.filled_share, c.shown, c.shown_by_one, c.shown_most,
        c.gap_p95, 1e3 * t.muscles, 1e3 * body.target_volume, 1e3 * t.bones, 1e3 * t.layer,
        1e3 * t.rest, body.dilation_ms);
    out += c.poses.empty()
               ? ",\n"
               : fmt::format("{:.6f},{:.5f}\n", c.posed_outside_share, c.posed_overlap_worst);
  }
  return out;
}

bool is_met(const BodyCheck& body) {
  const std::vector<Target> targets = check_targets(body.check);
  return std::all_of(targets.begin(), targets.end(),
                     [](const Target& target) { return target.met; });
}

}  // namespace ecorche::inline v1
