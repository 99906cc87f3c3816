// Where markers are stuck on a body, and what they are called.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A place on a body that stands at attention (lay_markers.h); x left, y up, z forwards.
struct MarkerPlace {
  std::string name;          // "asis_l"
  Side side = Side::middle;  // the right side is the mirror image of the left: x is turned already
  std::string joint;         // that carries it: "pelvis"
  std::string at, toward;    // joints: it begins at one, and goes `share` of the way to the other
  double share = 0;
  Vec3 offset = Vec3::Zero();  // m, for a stature of 1.75 m
  Vec3 out = Vec3::Zero();     // then to the skin in this direction; nought: it stays inside
  double spread = 0.02;        // m, standard deviation of where people stick it
};

struct MarkerSet {
  std::string name;                           // "plug-in"
  std::map<std::string, std::string> places;  // by plain_marker_name()
};

struct MarkerTables {
  std::map<std::string, MarkerPlace> places;
  std::vector<MarkerSet> sets;
  MarkerSet own;  // comes before the sets
};

// Upper case, without a subject's name before ':' or '|', without blanks, '.', '_' and '-'.
std::string plain_marker_name(std::string_view name);

// places.csv and names.csv of a folder. Throws InputError as Table; for a place that is not there.
MarkerTables read_marker_tables(const std::filesystem::path& folder);

// A table of people's own: columns `marker` and `place`, or in place of the latter, or where it is
// empty, `joint` and whatever of the other columns of places.csv is not nought. Throws InputError
// with file and line.
void add_own_markers(const std::filesystem::path& file, MarkerTables& tables);

// The place of each marker, null for one that no table knows. A name of several sets is that of the
// set that knows most of these markers.
std::vector<const MarkerPlace*> find_marker_places(const MarkerTables& tables,
                                                   const std::vector<std::string>& markers);

}  // namespace ecorche::inline v1
