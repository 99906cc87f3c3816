// Tests on the body package; skipped where it has not been fetched.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/errors.h"
#include "tests/test_assets.h"

namespace ecorche {

class BodyFixture : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (package_ != nullptr) return;
    try {
      package_ = std::make_unique<BodyPackage>(read_body_package(test_assets()));
    } catch (const InputError& e) {
      reason_ = e.what();
    }
  }
  void SetUp() override {
    if (package_ == nullptr) GTEST_SKIP() << reason_;
  }
  static const BodyPackage& package() { return *package_; }

 private:
  static inline std::unique_ptr<BodyPackage> package_;
  static inline std::string reason_;
};

}  // namespace ecorche
