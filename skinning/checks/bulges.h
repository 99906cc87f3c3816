// Bulging of a character's muscles, in measures with published values.
#pragma once

#include <string>
#include <vector>

#include "skinning/character/character_model.h"
#include "skinning/checks/anatomy_check.h"
#include "skinning/checks/check_targets.h"

namespace ecorche::inline v1 {

struct Thickening {
  std::string muscle;
  // m: as ultrasound finds it, the mean over sections of the middle half of the bellies as they are
  // drawn, relaxed and at full activation, joints held. The papers scanned bellies at several sites
  // along and across, with a probe that stays as it was laid on: across each section in the
  // direction in which it is thinnest while relaxed.
  double relaxed = 0, tense = 0;
  // bounds of the change, a share of `relaxed`: the range measured in people, widened by its error
  double low = 0, high = 0;
  std::string published;  // measured in people, as text
};

struct Bulges {
  // Left upper arm, m: relaxed half-way from shoulder to elbow in the rest pose; flexed by 100
  // degrees, palm up, all muscles of the arm tense: the largest from 40 to 65 % of the way. As a
  // tape lies, over hollows, of the upper arm's own skin, whatever it touches. NaN where the
  // skeleton has no such arm.
  double arm_relaxed = 0, arm_flexed = 0, arm_tensed = 0;  // flexed: the same without activation
  std::vector<Thickening> muscles;
};

Bulges measure_bulges(const CharacterModel& model);

// Length of a tape round the piece of the skin that a plane cuts nearest to a point: the section's
// convex hull. 0 where the plane misses.
double tape_girth(const TriMesh& skin, const Vec3& point, const Vec3& normal);

// What is asked of the muscles' thickening, and whether it is met.
std::vector<Target> bulge_targets(const Bulges& bulges);

std::string bulge_table(const Bulges& bulges);

}  // namespace ecorche::inline v1
