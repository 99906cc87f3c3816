// What a motion does to joints, muscles and skin, as tables a row a frame. Shared by the verbs that
// play motions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "app/files/actor.h"
#include "skinning/motion/activation.h"
#include "skinning/motion_files/motion_table.h"

namespace CLI {
class App;
}

namespace ecorche {

// --table WHAT=FILE, and outputs told by their ending.
struct TableRequest {
  // "angles", "markers", "lengths", "velocities", "bellies", "tendons", "activations",
  // "moment-arms:COORDINATE"
  std::string what;
  std::filesystem::path file;
};

void add_table_option(CLI::App& verb, std::vector<std::string>& texts);

// Throws UsageError for what there is not, or another ending than .csv, .sto, .mot (markers: .trc).
std::vector<TableRequest> table_requests(const std::vector<std::string>& texts);

// Whether an output is a table by its ending: .mot (angles), .trc (markers).
bool is_table(const std::filesystem::path& output);
TableRequest table_request(const std::filesystem::path& output);

// Throws UsageError for moment arms about a coordinate that the skeleton has not.
void require_coordinates(const std::vector<TableRequest>& requests, const Skeleton& skeleton);

class MotionTables {
 public:
  // Throws as require_coordinates(), UnfitError for markers on a skin without landmarks.
  MotionTables(const Assets& assets, std::vector<TableRequest> requests, const Actor& actor,
               const Motion& motion, const Activations& activations);

  void add(const CharacterState& frame);
  // Works out what is not read off the frames, and writes all files. Throws OutputError.
  void write();

 private:
  MotionTable table_of(const std::string& what) const;
  MotionTable angles() const;
  MotionTable activation_table() const;
  MotionTable moment_arms(const std::string& coordinate) const;

  std::vector<TableRequest> requests_;
  const Actor& actor_;
  const Motion& motion_;
  const Activations& activations_;
  std::vector<int> marker_vertices_;
  MarkerMotion markers_;
};

}  // namespace ecorche
