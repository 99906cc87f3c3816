// The table of body measures and the landmarks they are taken between: data/body/measures.csv,
// data/body/landmarks.csv.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy/base_mesh/body_package.h"

namespace ecorche::inline v1 {

enum class MeasureKind { height, ahead, distance, path, girth, breadth, depth, sum, mass };
enum class PlaneKind { horizontal, across, midline, foot, hand };
enum class Search { none, largest, smallest };

struct SkinLandmark {
  std::string id;
  int vertex = 0;    // on the left side or the mid-plane
  std::string rule;  // how a person finds it
};

// A measure of a sum with its factor.
struct Term {
  int measure = 0;
  double factor = 1;
};

// Columns as described at the head of data/body/measures.csv. Lengths in metres.
struct Measure {
  std::string id, name, standard, note;
  MeasureKind kind = MeasureKind::height;
  std::vector<int> vertices;  // the landmarks, in order; on the right side where the table says so
  std::vector<Term> terms;    // of a sum; earlier rows
  PlaneKind plane = PlaneKind::horizontal;
  Search search = Search::none;
  double reach = 0;  // m
  bool hull = false;
  bool arms_off = false;  // points of the loop that lie on an arm do not count
  int clip_vertex = -1;   // paths: the part above or below the level of this vertex
  bool clip_above = false;
  double tolerance = 0.004;  // m; kg for the mass
  std::string survey_field;  // empty: the survey has none
  double survey_shift = 0;   // m
  double survey_slack = 0;   // m or kg: how far the survey's definition may differ from ours
};

// Another name of a measure: "bust_girth" of chest_girth.
struct MeasureName {
  std::string name;
  int measure = 0;
};

struct MeasureTable {
  std::vector<SkinLandmark> landmarks;
  std::vector<Measure> measures;
  std::vector<MeasureName> other_names;  // data/body/measure_names.csv

  // Number of a measure, by its id or another name, or nothing.
  std::optional<int> find(std::string_view id) const;
  // Number of a measure. Throws UsageError that lists the nearest names.
  int at(std::string_view id) const;
};

// Throws InputError that names file, line and value; also when a landmark does not lie where the
// table says on the package's base mesh (another mesh would give wrong measures without a word).
MeasureTable read_measure_table(const BodyPackage& package, const std::filesystem::path& folder);

// The base mesh's vertices of a table's landmarks, each with its name; those that both sides have
// end in _l and _r.
std::vector<std::pair<std::string, int>> landmark_vertices(const BodyPackage& package,
                                                           const MeasureTable& table);

}  // namespace ecorche::inline v1
