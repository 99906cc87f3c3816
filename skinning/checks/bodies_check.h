// The figures of anatomy_check.h for the template fitted into many bodies.
#pragma once

#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "morph/fit/fit_quality.h"
#include "morph/shapes/standard_bodies.h"
#include "skinning/checks/anatomy_check.h"

namespace ecorche::inline v1 {

// Twenty bodies of both sexes, thin to obese, short to tall, young to old: the standard ones, the
// athlete and four more. Unique names.
std::vector<BodySpec> checked_bodies();

struct BodyCheck {
  std::string name;
  double mass = 0, stature = 0;  // kg, m
  AnatomyCheck check;
  Tissues tissues;
  double target_volume = 0;  // of all muscles before dilation, m^3
  double dilation_ms = 0;
};

// Fits the template into each and measures it. `progress` counts bodies. `poses`: none for the rest
// pose alone. Throws as make_body and fit_anatomy do.
std::vector<BodyCheck> check_bodies(const Assets& assets, const std::vector<BodySpec>& bodies,
                                    const std::vector<LimitPose>& poses,
                                    const CheckProgress& progress = {});

std::string bodies_table(const std::vector<BodyCheck>& checks);
std::string bodies_csv(const std::vector<BodyCheck>& checks);

// Whether a body meets everything that is asked at rest, and in its poses where they were measured.
bool is_met(const BodyCheck& body);

}  // namespace ecorche::inline v1
