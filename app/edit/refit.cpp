#include "app/edit/refit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/authoring/muscle_placement.h"
#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "anatomy/muscles/transform_muscles.h"
#include "app/edit/document/edited_skeleton.h"
#include "app/files/open_body.h"
#include "morph/fat/muscle_mass.h"
#include "morph/placement/bone_groups.h"
#include "morph/placement/own_parts.h"
#include "morph/shapes/body.h"
#include "morph/shapes/modify_body.h"
#include "morph/shapes/shape_space_cache.h"

namespace ecorche {
namespace {

// What the template's muscles hold for what the table lists, as build_template has it.
double volume_share(Workshop& workshop) {
  double listed = 0;
  for (const auto& muscle : workshop.built_in().muscles)
    if (muscle->left.layer != "subcutaneous") listed += 2 * muscle->left.volume_male;
  const Template& base = workshop.base();
  return muscle_mass(base.body.sex, base.body.age, base.tables.stature, base.body.mass) /
         kMuscleDensity / listed;
}

// One side of an entry on the source skeleton.
Muscle placed_side(const Anatomy& source, const Document& document, const TableMuscle& muscle,
                   Side side) {
  MuscleTable table = *document.frame;
  table.muscles = {muscle};
  PlaceOptions options;
  if (document.fit.slices > 0) options.min_slices = options.max_slices = document.fit.slices;
  std::vector<Muscle> both = place_muscles(table, source, options);
  return std::move(both[side == Side::right]);
}

// Whether the wraps that a muscle slides over are those of the other document.
bool same_wraps(const Document& a, const Document& b, const EditedMuscle& muscle) {
  if (a.frame == b.frame) return true;
  return std::ranges::all_of(wraps_of(muscle), [&](int wrap) {
    const std::size_t k = std::size_t(wrap);
    return k < b.frame->wraps.size() &&
           wrap_text(*a.frame, a.frame->wraps[k]) == wrap_text(*b.frame, b.frame->wraps[k]);
  });
}

bool same_muscles(const Document& a, const Document& b) {
  return a.muscles == b.muscles && a.frame == b.frame;
}

// `source`: edited_source(), or the workshop's where the document has no parts of its own.
std::vector<Muscle> placed_on(const Anatomy& source, Workshop& workshop, const Document& document,
                              int entry) {
  const EditedMuscle& edited = *document.muscles[std::size_t(entry)];
  std::vector<Muscle> sides{
      placed_side(source, document, edited.left, Side::left),
      placed_side(source, document, edited.right.value_or(edited.left), Side::right)};
  const OwnParts parts(source, workshop.source(), workshop.warp());
  sides = carry_muscles(sides, [&](const Vec3& x, int joint) { return parts.carry(x, joint); });
  const double share = volume_share(workshop);
  for (Muscle& muscle : sides) {
    muscle.volume *= share;
    widen_to_volume(muscle);
  }
  return sides;
}

}  // namespace

std::vector<Muscle> placed_entry(Workshop& workshop, const Document& document, int entry) {
  if (!has_own_parts(document)) return placed_on(workshop.source(), workshop, document, entry);
  return placed_on(edited_source(workshop, document), workshop, document, entry);
}

Template edited_template(Workshop& workshop, const Document& document) {
  Template out = workshop.base();
  const Document& built_in = workshop.built_in();
  if (!same_muscles(document, built_in) || document.fit.slices > 0) {
    std::optional<Anatomy> own_source;
    if (has_own_parts(document)) own_source = edited_source(workshop, document);
    const Anatomy& source = own_source ? *own_source : workshop.source();
    std::vector<Muscle> lean, grown;
    for (std::size_t m = 0; m < document.muscles.size(); ++m) {
      const int own = find_entry(built_in, document.muscles[m]->left.name);
      const bool as_built = own >= 0 && document.fit.slices == 0 &&
                            document.muscles[m] == built_in.muscles[std::size_t(own)] &&
                            same_wraps(document, built_in, *document.muscles[m]);
      if (as_built) {
        for (const std::size_t k : {2 * std::size_t(own), 2 * std::size_t(own) + 1}) {
          lean.push_back(out.tables.muscles[k]);
          grown.push_back(out.anatomy.muscles[k]);
        }
        continue;
      }
      for (Muscle& muscle : placed_on(source, workshop, document, int(m))) {
        lean.push_back(muscle);
        grown.push_back(std::move(muscle));
      }
    }
    out.tables.muscles = std::move(lean);
    out.anatomy.muscles = std::move(grown);
  }
  edit_skeleton(workshop, document, out);
  return out;
}

Body edited_body(Workshop& workshop, const Document& document, const Common& common,
                 Report& report) {
  const EditedBody& wanted = *document.body;
  const BodyPackage& package = workshop.package();
  Body body = wanted.file.empty() ? workshop.base().body
                                  : open_base_body(wanted.file, package, common, report);
  if (wanted.targets.empty()) return body;
  const TapeMeasure tape(package, read_measure_table(package, package.tables / "body"));
  const ShapeSpace space = read_shape_space(package, tape, body.sex);
  BodyChange change;
  bool lengths = false;
  for (const auto& [name, value] : wanted.targets) {
    const int measure = tape.table().at(name);
    change.measures.push_back({measure, value});
    const MeasureKind kind = tape.measure(measure).kind;
    lengths = lengths || (kind != MeasureKind::girth && kind != MeasureKind::mass);
  }
  change.keep_lengths = !lengths;  // with a length, the others follow it
  check_change(tape, space, body.skin.V, change);
  body.skin = skin_mesh(package, change_body(package, tape, space, body.skin.V, change).points);
  body.mass = kBodyDensity * skin_volume(package, body.skin.V);
  body.landmarks.clear();
  return body;
}

FittingOptions fitting_of(const Document& document) {
  FittingOptions out;
  for (const auto& [group, values] : document.skeleton->groups) {
    GroupScale& scale = out.fit.scales.emplace_back(GroupScale{group, values});
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!group_measures()[k].factor) scale.values[k] *= 1e-3;
  }
  out.joints = joint_parents(document);
  out.layer = document.body->layer;
  out.layer_sites = document.body->layer_sites;
  out.dilate.method = document.fit.method;
  out.dilate.alpha = document.fit.alpha;
  out.dilate.rays = document.fit.rays;
  out.dilate.clearance = 1e-3 * document.fit.clearance;
  out.tissues = false;
  return out;
}

bool fits_alike(const Document& a, const Document& b) {
  return same_muscles(a, b) && differs_in_muscles_alone(a, b);
}

bool differs_in_muscles_alone(const Document& a, const Document& b) {
  return a.joints == b.joints && a.skeleton == b.skeleton && a.body == b.body && a.fit == b.fit;
}

}  // namespace ecorche
