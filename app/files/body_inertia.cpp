#include "app/files/body_inertia.h"

#include "app/files/actor.h"

namespace ecorche {

SegmentInertia weigh_character(const Assets& assets, const Character& character, Report& report) {
  const BoundCharacter bound = bind_character(assets, character, report);
  return weigh_character(bound.character, bound.binding, report);
}

SegmentInertia weigh_character(const Character& character, const Binding& binding, Report& report) {
  const StageTimer timer(report, "inertia");
  SegmentInertia out = segment_inertia(character.anatomy, character.body, binding.joint_weights);
  report.set("inertia.segments", int(out.segments.size()));
  report.set("inertia.mass", out.mass);
  report.set("inertia.tissue_mass", out.tissue_mass);
  report.set("inertia.bone", out.bone_mass);
  report.set("inertia.muscle", out.muscle_mass);
  report.set("inertia.fat", out.fat_mass);
  report.set("inertia.lungs", out.lung_mass);
  return out;
}

}  // namespace ecorche
