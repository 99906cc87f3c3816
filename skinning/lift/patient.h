// A person who is carried: rigid segments on passive joints, and a skin whose tissue is pressed
// against the bones.
//
// Masses of segments are those of motion/center_of_mass.h. Passive moments of the joints are linear
// about the pose in which the person was laid down, and rise steeply towards the limits, as
// measured moments do (Riener and Edrich 1999, 10.1016/S0021-9290(99)00044-3: a few Nm in the
// middle of the range); their sizes here are rounded guesses of that order. Soft tissue is an
// elastic foundation (Johnson, Contact Mechanics, 1987, section 4.3) as thick as what lies between
// skin and bone.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/binding.h"
#include "skinning/constraints/self_collision.h"
#include "skinning/multibody/articulated_body.h"

namespace ecorche::inline v1 {

struct FleshOptions {
  // Modulus of skin, fat and relaxed muscle pressed against bone, Pa. Bulk tissue of the buttocks:
  // 10 to 50 kPa (Oomens et al. 2003, 10.1016/S0021-9290(02)00411-1 for the order). Larger: smaller
  // contacts, higher peaks.
  double modulus = 40e3;
  double thinnest = 0.006, thickest = 0.06;  // m, bounds of the thickness that counts
};

struct Patient : ArticulatedModel {
  TriMesh skin;                       // rest, world
  std::vector<JointWeights> weights;  // #V
  std::vector<int> carrier;           // #V, joint of the largest weight
  std::vector<double> area;           // #V, at rest, m^2
  std::vector<double> thickness;      // #V, of tissue over bone, m
  std::vector<int> region;            // #V, into `regions`
  std::vector<std::string> regions;   // "buttocks", "thigh_l", ...
  SelfCollisionTables limbs;          // that keep out of each other and of the trunk
  FleshOptions tissue;
};

// Of a character with our joints. `mass`: kg. Throws std::invalid_argument for a skeleton without
// our joints, or weights of another skin.
Patient make_patient(const Anatomy& anatomy, const TriMesh& skin,
                     const std::vector<JointWeights>& weights, double mass,
                     const FleshOptions& tissue = {});

// Thickness of the tissue as it is in a pose: over the nearest bone, each where its joint has it.
// `skin`: as posed, world, #V x 3.
void measure_tissue(const Anatomy& anatomy, const Pose& pose, const Points& skin, Patient& patient);

// A single rigid body with a skin, kg: for comparison with closed solutions. `inertia` about the
// centre of the skin's bounding box, where its only joint is.
Patient make_rigid_patient(const TriMesh& skin, double mass, const Vec3& inertia, double thickness,
                           const FleshOptions& tissue = {});

}  // namespace ecorche::inline v1
