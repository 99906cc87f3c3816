// A chair that is made to measure, and how a person is kept upright on it.
#pragma once

#include <string>
#include <vector>

#include "skinning/lift/patient.h"
#include "skinning/lift/skin_contact.h"

namespace ecorche::inline v1 {

struct ChairOptions {
  double recline = 10;                   // of back and trunk from upright, degrees
  bool back = true, floor = true;        // false: no back, feet hang
  double foam = 40e3, thickness = 0.06;  // of seat and back: modulus, Pa, and m
};

// "seat", and "back" and "floor" where they are wanted, so that each just touches. The seat is
// level and ends short of the hollow of the knee, the back begins above the buttocks. `skin`: of
// the person in sitting_pose(), #V x 3. A skin without our regions (make_rigid_patient) gets a seat
// below all of it.
std::vector<Pad> make_chair(const Patient& patient, const Points& skin,
                            const ChairOptions& options = {});

// Stiffens the joints of a person who sits: by a little effort of the trunk, without a back by that
// which keeps a trunk from falling over.
void keep_seated(bool back, Patient& patient);

// The lowest point of a bone in a pose, world. Throws std::invalid_argument for a name that none
// has.
Vec3 lowest_of_bone(const Anatomy& anatomy, const std::string& bone, const Pose& pose);

}  // namespace ecorche::inline v1
