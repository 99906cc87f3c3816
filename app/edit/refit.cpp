#include "app/edit/refit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/authoring/muscle_placement.h"
#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "anatomy/muscles/transform_muscles.h"
#include "app/files/open_body.h"
#include "morph/fat/muscle_mass.h"
#include "morph/placement/bone_groups.h"
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
Muscle placed_side(Workshop& workshop, const Document& document, const TableMuscle& muscle,
                   Side side) {
  MuscleTable table = *document.frame;
  table.muscles = {muscle};
  PlaceOptions options;
  if (document.fit.slices > 0) options.min_slices = options.max_slices = document.fit.slices;
  std::vector<Muscle> both = place_muscles(table, workshop.source(), options);
  return std::move(both[side == Side::right]);
}

void edit_joint(const EditedJoint& edit, const std::string& name, Skeleton& skeleton) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<Vec3> moved = rest;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    Joint& joint = skeleton.joints[j];
    const auto [base, side] = split_side(joint.name);
    if (joint.name != name && base != name) continue;
    const double outwards = side == Side::right ? -1 : 1;
    moved[j] += 1e-3 * Vec3(outwards * edit.moved.x(), edit.moved.y(), edit.moved.z());
    for (int axis = 0; axis < 3; ++axis) {
      // axes of both sides are right-handed frames that mean the same to either side
      joint.axes =
          Eigen::AngleAxisd(edit.turned[axis] * kDegree, joint.axes.col(axis)) * joint.axes;
      if (!edit.limits[axis]) continue;
      joint.min[axis] = edit.limits[axis]->first * kDegree;
      joint.max[axis] = edit.limits[axis]->second * kDegree;
    }
  }
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    Joint& joint = skeleton.joints[j];
    joint.X_PJ.translation() =
        joint.parent >= 0 ? Vec3(moved[j] - moved[std::size_t(joint.parent)]) : moved[j];
  }
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

}  // namespace

std::vector<Muscle> placed_entry(Workshop& workshop, const Document& document, int entry) {
  const EditedMuscle& edited = *document.muscles[std::size_t(entry)];
  std::vector<Muscle> sides{
      placed_side(workshop, document, edited.left, Side::left),
      placed_side(workshop, document, edited.right.value_or(edited.left), Side::right)};
  const SkeletonWarp& warp = workshop.warp();
  sides = carry_muscles(sides, [&](const Vec3& x, int joint) { return warp.by_joint(joint, x); });
  const double share = volume_share(workshop);
  for (Muscle& muscle : sides) {
    muscle.volume *= share;
    widen_to_volume(muscle);
  }
  return sides;
}

Template edited_template(Workshop& workshop, const Document& document) {
  Template out = workshop.base();
  const Document& built_in = workshop.built_in();
  if (!same_muscles(document, built_in) || document.fit.slices > 0) {
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
      for (Muscle& muscle : placed_entry(workshop, document, int(m))) {
        lean.push_back(muscle);
        grown.push_back(std::move(muscle));
      }
    }
    out.tables.muscles = std::move(lean);
    out.anatomy.muscles = std::move(grown);
  }
  for (const auto& [name, edit] : *document.joints) edit_joint(edit, name, out.anatomy.skeleton);
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
  out.layer = document.body->layer;
  out.dilate.method = document.fit.method;
  out.dilate.alpha = document.fit.alpha;
  out.dilate.rays = document.fit.rays;
  out.dilate.clearance = 1e-3 * document.fit.clearance;
  out.tissues = false;
  return out;
}

bool fits_alike(const Document& a, const Document& b) {
  return same_muscles(a, b) && a.joints == b.joints && a.body == b.body && a.fit == b.fit;
}

}  // namespace ecorche
