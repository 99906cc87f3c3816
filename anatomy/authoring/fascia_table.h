// The table of fascia: sheets, bands and ligaments of one side, as written in data/fascia.txt, and
// their control points on the source skeleton.
//
// A sheet is rows of control points, each a landmark and a small offset. They need to lie within a
// few centimetres of where the sheet runs, not on it: it is laid on what a body has there
// (morph/fascia/lay_fascia.h). data/muscles/README.md describes the text format.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/muscle_table.h"

namespace ecorche::inline v1 {

struct TableFascia {
  std::string name, label, group, source;  // name without side suffix
  // rows run from the left edge to the mid-plane, and on as their own mirror images
  bool middle = false;
  double thickness = 1e-3;         // m
  double fade = 0;                 // m from the edge over which it passes into a belly below
  std::vector<std::string> bones;  // that carry it alone, without side; none: what it lies on
  int rows = 0, columns = 0;
  std::vector<TablePoint> points;  // rows * columns, row after row
  std::string where;
};

// A sheet before it is laid, in a body.
struct FasciaPlan {
  // What lies on muscles and bones; a sleeve about the ends of bones; one about the room between.
  enum class Form { sheet, capsule, disc };
  std::string name;
  Side side = Side::middle;
  std::string label, group;
  double thickness = 1e-3, fade = 0;  // m
  std::vector<std::string> bones;
  int rows = 0, columns = 0;
  std::vector<PathPoint> points;  // rows * columns, row after row
  Form form = Form::sheet;
  int near = 0;  // of a sleeve, how many of the bones its first row lies on; its last on the others
};

// Reads data/fascia.txt; `landmarks` as read_muscle_table() gives it. Throws InputError
// "fascia.txt:12: palmar_aponeurosis: ..." for anything that is not what the format says.
std::vector<TableFascia> read_fascia_table(const std::filesystem::path& data_dir,
                                           const MuscleTable& landmarks);
// `name` stands for the file in messages.
std::vector<TableFascia> read_fascia_text(std::string_view text, const std::string& name,
                                          const MuscleTable& landmarks);

// A sheet that goes by the plan's name, side, label, group and bones, without points.
FasciaSheet empty_sheet(const FasciaPlan& plan);

// Left and right plans on the source skeleton, each left one followed by its mirror image. Throws
// InputError for a bone or carrier that the skeleton lacks.
std::vector<FasciaPlan> place_fascia(const std::vector<TableFascia>& table,
                                     const MuscleTable& landmarks, const Anatomy& source);

}  // namespace ecorche::inline v1
