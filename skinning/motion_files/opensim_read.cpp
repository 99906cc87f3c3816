#include "skinning/motion_files/opensim_read.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "skinning/motion_files/clip_times.h"

namespace ecorche::inline v1 {
namespace {

// One turn of a joint: the coordinate's name without its side, and the axis on the right; on the
// left x and y of the axis are negative, which is the mirror image.
struct Turn {
  const char* coordinate;
  double x, y, z;
};

// A joint of the figure on the right side or in the middle: place in its parent, m (on the left z
// is negative), and its turns one after the other about axes that turn with it.
struct FigureJoint {
  const char* name;
  const char* parent;
  bool sided;
  double x, y, z;
  std::array<Turn, 3> turns;
};

constexpr std::size_t kMostNames = 40;  // in a warning
constexpr Turn kNoTurn{"", 0, 0, 1};
constexpr double kStandingPelvis = 0.93;  // m, of the figure's pelvis over its soles

// Places and axes: gait2392; arms of Hamner's model. Knees are taken at zero flexion. The places of
// head, fingers and toes' ends only tell directions.
constexpr std::array<FigureJoint, 16> kFigure = {{
    {"pelvis",
     "",
     false,
     0,
     0,
     0,
     {{{"pelvis_tilt", 0, 0, 1}, {"pelvis_list", 1, 0, 0}, {"pelvis_rotation", 0, 1, 0}}}},
    {"torso",
     "pelvis",
     false,
     -0.1007,
     0.0815,
     0,
     {{{"lumbar_extension", 0, 0, 1}, {"lumbar_bending", 1, 0, 0}, {"lumbar_rotation", 0, 1, 0}}}},
    {"head", "torso", false, 0.01, 0.46, 0, {kNoTurn, kNoTurn, kNoTurn}},
    {"femur",
     "pelvis",
     true,
     -0.0707,
     -0.0661,
     0.0835,
     {{{"hip_flexion", 0, 0, 1}, {"hip_adduction", 1, 0, 0}, {"hip_rotation", 0, 1, 0}}}},
    {"tibia", "femur", true, -0.0045, -0.3958, 0, {{{"knee_angle", 0, 0, 1}, kNoTurn, kNoTurn}}},
    {"ankle",
     "tibia",
     true,
     0,
     -0.43,
     0,
     {{{"ankle_angle", -0.105014, -0.174022, 0.979126}, kNoTurn, kNoTurn}}},
    {"foot",
     "ankle",
     true,
     -0.04877,
     -0.04195,
     0.00792,
     {{{"subtalar_angle", 0.787180, 0.604747, -0.120949}, kNoTurn, kNoTurn}}},
    {"toes",
     "foot",
     true,
     0.1788,
     -0.002,
     0.00108,
     {{{"mtp_angle", -0.580954, 0, 0.813936}, kNoTurn, kNoTurn}}},
    {"toes_end", "toes", true, 0.07, 0, 0, {kNoTurn, kNoTurn, kNoTurn}},
    {"humerus",
     "torso",
     true,
     0.003155,
     0.3715,
     0.17,
     {{{"arm_flex", 0, 0, 1}, {"arm_add", 1, 0, 0}, {"arm_rot", 0, 1, 0}}}},
    {"forearm",
     "humerus",
     true,
     0.013144,
     -0.286273,
     -0.009595,
     {{{"elbow_flex", 0.226047, 0.022269, 0.973862}, kNoTurn, kNoTurn}}},
    {"radius",
     "forearm",
     true,
     -0.006727,
     -0.013007,
     0.026083,
     {{{"pro_sup", 0.056398, 0.998406, 0.001952}, kNoTurn, kNoTurn}}},
    {"hand",
     "radius",
     true,
     -0.008797,
     -0.235841,
     0.013610,
     {{{"wrist_flex", 0, 0, 1}, {"wrist_dev", 1, 0, 0}, kNoTurn}}},
    {"index_01", "hand", true, 0, -0.09, 0.03, {kNoTurn, kNoTurn, kNoTurn}},
    {"pinky_01", "hand", true, 0, -0.08, -0.03, {kNoTurn, kNoTurn, kNoTurn}},
    {"head_end", "head", false, 0, 0.2, 0, {kNoTurn, kNoTurn, kNoTurn}},
}};

class TableReader {
 public:
  TableReader(std::string_view text, const std::string& name) : scan_(text, name) {
    out_.name = name;
  }

  CoordinateTable read() {
    read_head();
    read_columns();
    while (scan_.next_line())
      if (!scan_.at_line_end()) read_row();
    if (out_.rows.empty()) scan_.fail("no rows of numbers");
    if (claimed_ && *claimed_ != (long long)(out_.rows.size()))
      out_.warnings.push_back(fmt::format("{}: its head says {} rows, it holds {}", out_.name,
                                          *claimed_, out_.rows.size()));
    return std::move(out_);
  }

 private:
  void read_head() {
    while (scan_.next_line()) {
      std::string line(scan_.line());
      std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
      if (line == "endheader") return;
      if (line.starts_with("inDegrees=")) {
        const std::string value = line.substr(10);
        if (value != "yes" && value != "no")
          scan_.fail(fmt::format("inDegrees={}; expected yes or no", printable(value)));
        out_.degrees = value == "yes";
      }
      if (line.starts_with("datacolumns")) out_.degrees = true;
      long long rows = 0;
      for (const char* key : {"nRows=", "datarows"})
        if (line.starts_with(key) && parse_whole(line.substr(std::string(key).size()), rows))
          claimed_ = rows;
    }
    scan_.fail("no 'endheader'; is this a table of OpenSim?");
  }

  // Names of the coordinates; /jointset/JOINT/NAME/value of a table of states.
  void read_columns() {
    while (scan_.next_line())
      if (!scan_.at_line_end()) break;
    if (scan_.word() != "time") scan_.fail("the first column should be 'time'");
    std::set<std::string> known;
    while (!scan_.at_line_end()) {
      std::string name = printable(scan_.word());
      keep_.push_back(!name.ends_with("/speed"));
      if (!keep_.back()) continue;
      if (name.ends_with("/value")) name.resize(name.size() - 6);
      name = name.substr(name.rfind('/') + 1);
      if (name.size() > limits::kNameBytes) scan_.fail("a column's name is too long");
      if (!known.insert(name).second) scan_.fail(fmt::format("column '{}' twice", name));
      out_.columns.push_back(name);
    }
  }

  void read_row() {
    const double time = scan_.number("time");
    if (!out_.times.empty() && !(time > out_.times.back()))
      scan_.fail(fmt::format("time {} after {}; times should rise", time, out_.times.back()));
    std::vector<double> row;
    for (std::size_t c = 0, kept = 0; c < keep_.size(); ++c) {
      const double value =
          scan_.number(keep_[c] ? "column '" + out_.columns[kept++] + "'" : std::string("a speed"));
      if (std::abs(value) > 1e6 && keep_[c])
        scan_.fail(fmt::format("column '{}': {:g} is beyond 1e6", out_.columns[kept - 1], value));
      if (keep_[c]) row.push_back(value);
    }
    if (!scan_.at_line_end())
      scan_.fail(fmt::format("more than {} values; there are {} columns", keep_.size() + 1,
                             keep_.size() + 1));
    if (out_.rows.size() >= std::size_t(limits::kMotionFrames))
      throw LimitError(fmt::format("{}: more than {} rows", out_.name, limits::kMotionFrames));
    out_.times.push_back(time);
    out_.rows.push_back(std::move(row));
  }

  TextScan scan_;
  CoordinateTable out_;
  std::vector<bool> keep_;  // of the columns after time
  std::optional<long long> claimed_;
};

class FigureBuilder {
 public:
  FigureBuilder(const CoordinateTable& table) : table_(table) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) columns_[table.columns[c]] = int(c);
    out_.name = table.name;
    out_.warnings = table.warnings;
    out_.up = 'y';
    out_.metres_per_unit = 1;
  }

  MotionClip build() {
    for (const FigureJoint& joint : kFigure) {
      if (!joint.sided) add_joint(joint, "", 1);
      if (joint.sided)
        for (const char* side : {"_r", "_l"}) add_joint(joint, side, side[1] == 'r' ? 1 : -1);
    }
    for (const char* needed : {"hip_flexion_r", "hip_flexion_l", "knee_angle_r", "knee_angle_l"})
      if (!columns_.contains(needed))
        throw UnfitError(fmt::format(
            "{}: no column '{}'; joint angles have the coordinates of OpenSim's gait2392, Hamner's "
            "and Rajagopal's models (hip_flexion_r, knee_angle_r, ...); is it a table of forces or "
            "of another model?",
            table_.name, needed));
    place_root();
    for (const std::vector<double>& row : table_.rows) add_turns(row);
    out_.frame_count = int(table_.rows.size());
    scale();
    tell_gaps();
    return std::move(out_);
  }

 private:
  // Turn of a joint that the table moves.
  struct Moved {
    int column = -1;
    Vec3 axis;
    double unit = 1;  // rad, with its sense
  };

  void add_joint(const FigureJoint& joint, const std::string& side, double mirror) {
    ClipJoint made;
    made.name = joint.name + side;
    made.offset = Vec3(joint.x, joint.y, mirror * joint.z);
    const std::string parent = joint.parent;
    made.parent = joint.parent[0] == 0      ? -1
                  : names_.contains(parent) ? names_.at(parent)
                                            : names_.at(parent + side);
    std::vector<Moved> turns;
    for (const Turn& turn : joint.turns) {
      if (turn.coordinate[0] == 0) continue;
      const std::string name = turn.coordinate + side;
      const auto column = columns_.find(name);
      if (column == columns_.end()) {
        missing_.push_back(name);
        continue;
      }
      used_.insert(name);
      const Vec3 axis(mirror * turn.x, mirror * turn.y, turn.z);
      turns.push_back({column->second, axis.normalized(),
                       (table_.degrees ? kDegree : 1) * sense(turn.coordinate, column->second)});
    }
    if (!turns.empty() || made.parent < 0) {
      made.rotation_track = out_.rotation_tracks++;
      turns_.push_back(std::move(turns));
    }
    names_[made.name] = int(out_.joints.size());
    out_.joints.push_back(std::move(made));
  }

  // A knee bends backwards: about -z.
  double sense(const std::string& coordinate, int column) const {
    if (coordinate != "knee_angle") return 1;
    double low = 0, high = 0;
    for (const std::vector<double>& row : table_.rows) {
      low = std::min(low, row[std::size_t(column)]);
      high = std::max(high, row[std::size_t(column)]);
    }
    return high > -low ? -1 : 1;
  }

  void place_root() {
    out_.joints[0].translation_track = out_.translation_tracks++;
    const std::array<const char*, 3> names = {"pelvis_tx", "pelvis_ty", "pelvis_tz"};
    for (const std::vector<double>& row : table_.rows) {
      Vec3 root(0, kStandingPelvis, 0);
      for (int k = 0; k < 3; ++k)
        if (const auto column = columns_.find(names[std::size_t(k)]); column != columns_.end())
          root[k] = row[std::size_t(column->second)];
      out_.translations.push_back(root);
    }
    for (const char* name : names) {
      used_.insert(name);
      if (!columns_.contains(name)) missing_.emplace_back(name);
    }
  }

  void add_turns(const std::vector<double>& row) {
    for (const std::vector<Moved>& joint : turns_) {
      Mat3 R = Mat3::Identity();
      for (const Moved& turn : joint)
        R = R * Eigen::AngleAxisd(turn.unit * row[std::size_t(turn.column)], turn.axis)
                    .toRotationMatrix();
      out_.rotations.push_back(R);
    }
  }

  // The subject's size: a tenth of the frames have their pelvis lower over the lower sole than the
  // figure of that size.
  void scale() {
    if (!columns_.contains("pelvis_ty") || out_.frame_count == 0) return;
    std::vector<double> sizes;
    std::vector<Transform> X;
    for (int f = 0; f < out_.frame_count; ++f) {
      clip_kinematics(out_, f, X);
      double lowest = 0;
      for (const char* part : {"foot_r", "toes_r", "toes_end_r", "foot_l", "toes_l", "toes_end_l"})
        lowest = std::min(
            lowest, X[std::size_t(names_.at(part))].translation().y() - X[0].translation().y());
      if (lowest < 0) sizes.push_back(X[0].translation().y() / -lowest);
    }
    if (sizes.empty()) return;
    const auto tenth = sizes.begin() + std::ptrdiff_t(sizes.size() / 10);
    std::nth_element(sizes.begin(), tenth, sizes.end());
    if (!(*tenth > 0.4 && *tenth < 1.6)) {
      out_.warnings.push_back(
          fmt::format("{}: the pelvis stands {:.2f} times as high as legs reach; the size of its "
                      "subject is taken as usual",
                      out_.name, *tenth));
      return;
    }
    for (ClipJoint& joint : out_.joints) joint.offset *= *tenth;
  }

  void tell_gaps() {
    std::vector<std::string> strange;
    for (const std::string& column : table_.columns)
      if (!used_.contains(column)) strange.push_back(column);
    const auto tell = [&](std::vector<std::string>& names, const char* what) {
      if (names.empty()) return;
      const std::size_t count = names.size();
      if (count > kMostNames) names.resize(kMostNames);
      out_.warnings.push_back(fmt::format("{}: {} {}: {}{}", out_.name, count, what,
                                          fmt::join(names, ", "),
                                          count > kMostNames ? ", ..." : ""));
    };
    tell(missing_, "coordinates are missing, and stay nought");
    tell(strange, "columns are no coordinates that are known");
  }

  const CoordinateTable& table_;
  MotionClip out_;
  std::map<std::string, int> columns_, names_;
  std::vector<std::vector<Moved>> turns_;  // by rotation track
  std::vector<std::string> missing_;
  std::set<std::string> used_;
};

}  // namespace

CoordinateTable parse_coordinates(std::string_view text, const std::string& name) {
  return TableReader(text, name).read();
}

MotionClip clip_from_coordinates(const CoordinateTable& table, const std::optional<double>& fps) {
  MotionClip out = FigureBuilder(table).build();
  if (fps)
    out.fps = *fps;
  else
    set_times(table.times, out);
  return out;
}

}  // namespace ecorche::inline v1
