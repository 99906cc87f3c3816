// A character: a body and the anatomy inside it.
#pragma once

#include <memory>

#include "anatomy/anatomy.h"
#include "anatomy/own_skin.h"

namespace ecorche::inline v1 {

struct Character {
  Anatomy anatomy;
  Body body;
  std::shared_ptr<const OwnSkin>
      own{};  // null: body.skin is the body package's, or bound by itself
};

}  // namespace ecorche::inline v1
