// Bodies that the program is judged and shown on.
#pragma once

#include <vector>

#include "morph/shapes/body_model.h"

namespace ecorche::inline v1 {

// The bodies that fits are judged on: average man and woman, thin, heavy, muscular, short, tall,
// old, young. Unique names.
std::vector<BodySpec> standard_bodies();

// The long jumper: lean, muscular, 1.85 m.
BodySpec athlete();

}  // namespace ecorche::inline v1
