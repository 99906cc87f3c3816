// The built-in template, for tests that the data packages are needed for.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "anatomy/errors.h"
#include "morph/template/template.h"
#include "morph/template/template_cache.h"
#include "tests/test_assets.h"

namespace ecorche {

// Null where the packages are not there.
inline const Template* the_template() {
  static const std::shared_ptr<const Template> built = []() -> std::shared_ptr<const Template> {
    try {
      return std::make_shared<Template>(read_template(test_assets()));
    } catch (const InputError&) {
      return nullptr;
    }
  }();
  return built.get();
}

}  // namespace ecorche

#define NEED_TEMPLATE()                                                        \
  const Template* shared = the_template();                                     \
  if (!shared) GTEST_SKIP() << "the data packages are not there (make setup)"; \
  const Template& tmpl = *shared
