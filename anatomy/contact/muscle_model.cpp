#include "anatomy/contact/muscle_model.h"

#include "anatomy/contact/contact_candidates.h"

namespace ecorche::inline v1 {

MuscleModel make_muscle_model(const Anatomy& anatomy, const ContactBefore& before) {
  MuscleModel model;
  model.posing = make_posing_table(anatomy);
  model.contact = make_contact_table(anatomy, model.posing, before);
  return model;
}

void pose_muscles(const MuscleModel& model, const Skeleton& skeleton, const Pose& pose,
                  PosedAnatomy& posed, ContactWorkspace& workspace, int threads,
                  std::span<const double> activation) {
  pose_anatomy(model.posing, skeleton, pose, posed, threads, activation);
  resolve_posed_contact(model.contact, model.posing, posed, workspace,
                        threads > 1 ? Threads::all : Threads::one);
}

}  // namespace ecorche::inline v1
