// A scan, sculpt or stranger's character as a command line names it, registered. Shared by fit and
// body register.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "anatomy/base_mesh/body_package.h"
#include "app/common_options.h"
#include "app/files/stranger.h"
#include "app/report.h"
#include "morph/registration/register_scan.h"

namespace CLI {
class App;
}

namespace ecorche {

struct RegisterFileOptions {
  std::filesystem::path landmarks{};
  std::string pose{}, unit{};
  double stature = 0;  // m; 0: not told
  // Called as stages begin (RegistrationOptions::watch); may be empty.
  std::function<void(const std::string& stage, const Points& posed)> watch{};
};

struct RegisteredFile {
  Scan scan;
  Registration registration;
  // The mesh of the file, to be moved; null for a bare cloud of points.
  std::shared_ptr<const Stranger> stranger;
};

// Reads, cleans and registers. Notes go to people, timings (`clean`, `register`) to the report.
// Throws as read_mesh_file, clean_scan, register_scan and the readers of hints; UsageError for an
// unknown pose.
RegisteredFile register_file(const std::filesystem::path& file, const RegistrationModel& model,
                             const RegisterFileOptions& options, const Common& common,
                             Report& report);

// Whether the file holds a skin on the base mesh, which needs no registration: its vertex count and
// edges. Throws as read_mesh_file.
bool is_base_skin(const std::filesystem::path& file, const BodyPackage& package);

// --landmarks, --pose, --stature; the unit's option is open_body.h's.
void add_registration_options(CLI::App& verb, RegisterFileOptions& options);

}  // namespace ecorche
