// Tables of a motion, a row a frame, for spreadsheets and OpenSim: .csv, .sto, .mot; and markers as
// .trc.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct MotionTable {
  std::string what;                  // "lengths of muscles"
  std::string unit;                  // of all columns: "m", "m/s", "deg", ""; with `units` of each
  std::vector<std::string> columns;  // without time
  std::vector<std::string> units;    // #columns, or empty: all have `unit`
  double fps = 0;
  std::vector<std::vector<double>> rows;  // #frames x #columns
};

// .csv: one line of headings, units in brackets ("time [s],soleus_l [m]"). .sto and .mot: OpenSim's
// head and columns by tabulators; degrees are declared by inDegrees, other units by a line of their
// own. Throws OutputError; UsageError for another ending.
void write_motion_table(const std::filesystem::path& file, const MotionTable& table);

struct MarkerMotion {
  std::vector<std::string> names;
  double fps = 0;
  std::vector<Points> frames;  // #frames, each #names x 3, world, m
};

// Metres, in OpenSim's axes: x forward, y up, z right. Throws OutputError.
void write_trc(const std::filesystem::path& file, const MarkerMotion& markers);

}  // namespace ecorche::inline v1
