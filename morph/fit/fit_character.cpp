#include "morph/fit/fit_character.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "anatomy/base_mesh/chest_wall.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fascia/lay_fascia.h"
#include "morph/fat/muscle_mass.h"

namespace ecorche::inline v1 {
namespace {

using Clock = std::chrono::steady_clock;

// What is told of how the muscles of a fitted body lie.
FillReport judge(const Template& body_template, const FittedCharacter& fitted,
                 const BodyPackage& package, const FittingOptions& options,
                 const TriMesh& closed_skin, const SkinRays& wall) {
  std::vector<VertexPart> read;
  if (!options.parts) read = vertex_parts(package);
  const std::vector<VertexPart>& parts = options.parts ? *options.parts : read;
  FillReport out = measure_fill(fitted.anatomy, closed_skin, wall, fitted.fat, parts);
  if (!options.dilated || options.dilate.method != DilateMethod::ecorche || !options.dilate.share)
    return out;
  measure_rest(fitted.anatomy, wall.mesh(), fitted.fat, parts, out);
  measure_torn(fitted.anatomy, body_template.anatomy.muscles, out);
  const LayeredBody body{fitted.anatomy, wall.mesh(), fitted.fat, parts};
  std::optional<LayerOrder> made;
  if (!options.layers) made = template_layers(body_template, package);
  measure_shown(made ? *made : *options.layers, body, out);
  return out;
}

}  // namespace

DilateOptions dilation_of(const FittingOptions& options, const FitReport& fit) {
  // Strips of one muscle overlap: the volumes of all sections add up to more than is drawn. Ratio
  // of the volume of the union of the muscles to the sum over the strips.
  constexpr double kUnionRatio = 0.915;
  DilateOptions out = options.dilate;
  out.even_about = fit.even_about;
  if (!out.most_volume) out.most_volume = fit.muscle_volume / kUnionRatio;
  return out;
}

FatLayer fat_of(const Template& body_template, const Body& body, const Anatomy& anatomy,
                const SkinRays& wall, const FittingOptions& options) {
  FatLayer fat = make_fat_layer(body_template.tables.fat, wall, anatomy, body);
  if (options.layer != 1 || !options.layer_sites.empty())
    scale_fat(options.layer, options.layer_sites, wall.mesh(), fat);
  return fat;
}

FittedCharacter fit_character(const Template& body_template, const Body& body,
                              const BodyPackage& package, const FittingOptions& options,
                              FitRecord* record) {
  FittedCharacter fitted;
  FittingReport& report = fitted.report;
  Fit fit = fit_anatomy(body_template, body, options.fit);
  if (record) *record = {body_template.tables.muscles, fit, {}, {}, {}};
  report.fit = std::move(fit.report);
  fitted.anatomy = std::move(fit.anatomy);
  fitted.tissue = std::move(fit.tissue);
  fitted.undilated = fitted.anatomy;

  const TriMesh closed_skin = capped_skin(package, body.skin.V);
  // muscles and the layer over them lie under the chest's wall, not in the breasts
  const SkinRays wall(chest_wall_skin(package, body.sex, body.skin.V));
  const DilateOptions dilation = dilation_of(options, report.fit);
  const auto start = Clock::now();
  fitted.fat = fat_of(body_template, body, fitted.anatomy, wall, options);
  if (options.dilated) {
    report.dilation =
        dilate_muscles(fitted.anatomy, fitted.undilated.muscles, body_template.tables.muscles, wall,
                       fitted.fat, dilation, {.record = record ? &record->dilation : nullptr});
    fitted.anatomy.fascia = lay_fascia(fit.fascia, fitted.anatomy, wall);
    if (record) record->grown = fitted.anatomy.muscles, record->fascia = fitted.anatomy.fascia;
  }
  report.dilation_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();

  if (options.judged)
    report.fill = judge(body_template, fitted, package, options, closed_skin, wall);
  if (options.tissues)
    report.tissues = measure_tissues(fitted.anatomy, closed_skin, wall.mesh(), fitted.fat);
  rearrange_joints(options.joints, fitted.anatomy);
  rearrange_joints(options.joints, fitted.undilated);
  return fitted;
}

}  // namespace ecorche::inline v1
