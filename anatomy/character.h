// A character: a body and the anatomy inside it.
#pragma once

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct Character {
  Anatomy anatomy;
  Body body;
};

}  // namespace ecorche::inline v1
