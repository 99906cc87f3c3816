// The tables and packages that tests read: those of the environment, of the source tree otherwise.
#pragma once

#include "anatomy/files/assets.h"

namespace ecorche {

inline const Assets& test_assets() {
  static const Assets assets = open_assets();
  return assets;
}

}  // namespace ecorche
