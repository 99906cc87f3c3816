// The bone package's own skeleton, for tests that it is needed for.
#pragma once

#include <gtest/gtest.h>

#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "tests/test_assets.h"

#define NEED_SOURCE_SKELETON(source)              \
  Anatomy source;                                 \
  try {                                           \
    source = read_source_skeleton(test_assets()); \
  } catch (const InputError& e) {                 \
    GTEST_SKIP() << e.what();                     \
  }
