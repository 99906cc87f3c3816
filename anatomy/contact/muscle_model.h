// Muscles compiled for motion: posing and contact of one anatomy. The surface that callers use.
#pragma once

#include <span>

#include "anatomy/contact/contact_candidates.h"
#include "anatomy/contact/contact_table.h"
#include "anatomy/contact/muscle_contact.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche::inline v1 {

// Constant after it is made. Copies share the posing table and copy the candidates.
struct MuscleModel {
  PosingTable posing;
  ContactTable contact;
};

// Throws as make_posing_table(). Some tenths of a second for a whole body. `before`: see there.
MuscleModel make_muscle_model(const Anatomy& anatomy, const ContactBefore& before = {});

// pose_anatomy(), then resolve_posed_contact(). No allocation once `posed` and `workspace` have
// been used. The same bytes at any number of threads.
void pose_muscles(const MuscleModel& model, const Skeleton& skeleton, const Pose& pose,
                  PosedAnatomy& posed, ContactWorkspace& workspace, int threads = 1,
                  std::span<const double> activation = {});

}  // namespace ecorche::inline v1
