#include "app/ragdoll/character_ragdoll.h"

#include <fmt/format.h>

#include <stdexcept>

#include "anatomy/errors.h"
#include "app/files/body_inertia.h"
#include "skinning/motion/no_such_joint.h"
#include "skinning/ragdoll/limp_motion.h"

namespace ecorche {

Ragdoll character_ragdoll(const std::string& file, const Character& character,
                          const Binding& binding, Report& report) {
  const SegmentInertia inertia = weigh_character(character, binding, report);
  try {
    return make_ragdoll(character.anatomy.skeleton, inertia.segments, character.body.skin.V,
                        binding.joint_weights);
  } catch (const std::invalid_argument& e) {
    throw UnfitError(fmt::format("{}: {}; take a character that `ecorche fit` has made from a body",
                                 file, e.what()));
  }
}

double ground_height(const Character& character) { return character.body.skin.V.col(1).minCoeff(); }

void require_limp_joints(const Skeleton& skeleton, const std::vector<std::string>& joints) {
  for (const std::string& name : joints)
    if (find_joint(skeleton, name) < 0)
      throw UsageError("--passive: " + no_such_joint(skeleton, name));
}

Motion with_limp_joints(const std::string& file, const Character& character, const Binding& binding,
                        const std::vector<std::string>& joints, const Motion& motion,
                        const Common& common, Report& report) {
  require_limp_joints(character.anatomy.skeleton, joints);
  const Ragdoll ragdoll = character_ragdoll(file, character, binding, report);
  const StageTimer timer(report, "limp");
  RagdollOptions options;
  options.ground_height = ground_height(character);
  try {
    LimpResult limp = limp_motion(ragdoll, motion, joints, options);
    std::string names;
    for (const std::string& name : limp.joints) names += (names.empty() ? "" : ", ") + name;
    note(common, "limp: " + names);
    report.set("limp.joints", int(limp.joints.size()));
    report.set("limp.limit_excess_deg", limp.limit_excess * kDegreesPerRadian);
    report.set("limp.overlap", limp.overlap);
    return std::move(limp.motion);
  } catch (const std::invalid_argument& e) {
    throw UsageError(
        fmt::format("--passive: {}; name a joint of a limb, of the neck or the spine", e.what()));
  }
}

}  // namespace ecorche
