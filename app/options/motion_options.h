// Options for reading a motion file, retargeting it and skinning.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/options/filter_options.h"
#include "skinning/character/character_model.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"

namespace CLI {
class App;
}

namespace ecorche {

struct MotionOptions {
  std::filesystem::path map_file;              // --map
  std::string up;                              // --up
  std::filesystem::path markers;               // --markers; empty: names that are known
  double fps = 0;                              // --motion-fps; 0: the file's
  std::string take;                            // --take; empty: the first
  std::filesystem::path skeleton;              // --skeleton; empty: looked for
  std::string from, to;                        // --from, --to; empty: all of it
  std::string limits = "auto";                 // --limits
  bool through = false;                        // --no-apart
  bool free_feet = false, plant_feet = false;  // --no-plant, --plant
  std::vector<std::string> filters;            // --filter
};

// --skin: the skinning method; for choose_skin().
void add_skin_option(CLI::App& verb, std::string& method);

// --weights: for ActorOptions.
void add_weights_option(CLI::App& verb, std::filesystem::path& weights);

// --muscles: what carries them; for ActorOptions. to_muscle_motion() throws UsageError for another
// word than lines and map, and for a map with a skinning method other than "ecorche".
void add_muscles_option(CLI::App& verb, std::string& muscles);
MuscleMotion to_muscle_motion(const std::string& muscles, const std::string& method = "ecorche");

// --dynamics: dynamics of soft tissue. require_settling() throws UsageError for skinning methods
// other than "ecorche".
void add_dynamics_option(CLI::App& verb, bool& dynamics);
void require_settling(bool dynamics, const std::string& method);

// What the help texts say of an argument that is a motion file.
inline constexpr const char* kMotionFilesHelp =
    "Motion: .bvh, .glb, .gltf, .fbx, .dae, .amc, .mot, .sto, .npz, markers in .trc or .c3d, or "
    "DeepMimic's "
    ".txt";
// --definition: relief of the anatomy on the skin; `otherwise` says what is done without it.
// to_definition() is for ActorOptions; it throws UsageError for more than 0 with skinning methods
// other than "ecorche".
void add_definition_option(CLI::App& verb, std::optional<double>& definition,
                           const std::string& otherwise = "by the body's fat");
std::optional<double> to_definition(const std::optional<double>& definition,
                                    const std::string& method = "ecorche");

void add_motion_options(CLI::App& verb, MotionOptions& options);
// --from, --to: the part of the motion that is read.
void add_range_options(CLI::App& verb, MotionOptions& options);
// `second` opens the motion of a blend; without it a blend is a UsageError.
RetargetOptions to_retarget_options(const MotionOptions& options, const SecondMotion& second = {});
// Throws UsageError for what is no moment.
MotionReadOptions to_read_options(const MotionOptions& options);

}  // namespace ecorche
