// How a motion file is to be read and a skin moved: options shared by the verbs that do.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "skinning/motion_files/bvh_io.h"
#include "skinning/retarget/retarget.h"

namespace ecorche {

struct MotionOptions {
  std::filesystem::path map_file;              // --map
  std::string up;                              // --up
  double fps = 0;                              // --motion-fps; 0: the file's
  std::string limits = "auto";                 // --limits
  bool through = false;                        // --no-apart
  bool free_feet = false, plant_feet = false;  // --no-plant, --plant
};

// --skin: how the skin is moved; for choose_skin().
void add_skin_option(CLI::App& verb, std::string& method);

// --weights: for ActorOptions.
void add_weights_option(CLI::App& verb, std::filesystem::path& weights);

// --dynamics: loose flesh lags and settles. require_settling() throws UsageError for another skin
// than our own.
void add_dynamics_option(CLI::App& verb, bool& dynamics);
void require_settling(bool dynamics, const std::string& method);

void add_motion_options(CLI::App& verb, MotionOptions& options);
RetargetOptions to_retarget_options(const MotionOptions& options);
BvhReadOptions to_read_options(const MotionOptions& options);

}  // namespace ecorche
