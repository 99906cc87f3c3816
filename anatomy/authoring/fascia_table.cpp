#include "anatomy/authoring/fascia_table.h"

#include <fmt/format.h>

#include <span>

#include "anatomy/authoring/path_carriers.h"
#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kFar = 500;  // mm from a landmark
constexpr int kMostRows = 64;

// One pass over the file. A sheet is checked when it ends.
class FasciaReader {
 public:
  FasciaReader(std::string_view text, const std::string& name, const MuscleTable& landmarks)
      : scan_(text, name), name_(name), landmarks_(landmarks) {}

  std::vector<TableFascia> read() {
    while (scan_.next_line()) {
      const std::string_view keyword = scan_.word();
      if (keyword.empty() || keyword.starts_with('#')) continue;
      if (keyword == "fascia")
        begin();
      else if (sheets_.empty())
        fail(fmt::format("'{}' outside a sheet; expected fascia", keyword));
      else
        read_line(keyword);
    }
    end();
    return std::move(sheets_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    scan_.fail(sheets_.empty() ? message : fmt::format("{}: {}", sheets_.back().name, message));
  }

  std::string words() {
    std::string out;
    for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word())
      out += (out.empty() ? "" : " ") + std::string(word);
    if (out.empty()) fail("some words are missing");
    return out;
  }

  double millimetres(std::string_view what, double low, double high) {
    const double value = scan_.number(what);
    if (value < low || value > high)
      fail(fmt::format("{}: {} is not within {} .. {}", what, value, low, high));
    return value * kMillimetre;
  }

  void end_of_line() {
    const std::string_view word = scan_.word();
    if (!word.empty() && !word.starts_with('#'))
      fail(fmt::format("unexpected '{}' at the end of the line", word));
  }

  void begin() {
    end();
    TableFascia& sheet = sheets_.emplace_back();
    sheet.name = std::string(scan_.word());
    sheet.where = fmt::format("{}:{}", name_, scan_.line_number());
    if (sheet.name.empty()) fail("the sheet's name is missing");
    end_of_line();
    for (std::size_t i = 0; i + 1 < sheets_.size(); ++i)
      if (sheets_[i].name == sheet.name) fail("the sheet is given twice");
  }

  void read_line(std::string_view keyword) {
    TableFascia& sheet = sheets_.back();
    if (keyword == "label")
      sheet.label = words();
    else if (keyword == "group")
      sheet.group = words();
    else if (keyword == "source")
      sheet.source = words();
    else if (keyword == "middle")
      sheet.middle = true;
    else if (keyword == "thickness")
      sheet.thickness = millimetres("thickness in mm", 0.1, 20);
    else if (keyword == "fade")
      sheet.fade = millimetres("fade in mm", 0, 200);
    else if (keyword == "on")
      for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word())
        sheet.bones.emplace_back(word);
    else if (keyword == "row")
      begin_row();
    else if (keyword == "point")
      read_point();
    else
      fail(fmt::format("unknown keyword '{}'", keyword));
  }

  void begin_row() {
    end_row();
    if (sheets_.back().rows++ == kMostRows) fail(fmt::format("more than {} rows", kMostRows));
    in_row_ = 0;
    end_of_line();
  }

  void read_point() {
    TableFascia& sheet = sheets_.back();
    if (sheet.rows == 0) fail("a point before the first row");
    const std::string id(scan_.word());
    TablePoint point;
    point.landmark = find_landmark(landmarks_, id);
    if (point.landmark < 0)
      fail(fmt::format("unknown landmark '{}'; data/landmarks lists them", id));
    if (!scan_.at_line_end())
      for (int k = 0; k < 3; ++k) point.offset[k] = millimetres("offset", -kFar, kFar);
    end_of_line();
    sheet.points.push_back(point);
    ++in_row_;
  }

  void end_row() {
    TableFascia& sheet = sheets_.back();
    if (sheet.rows == 0) return;
    if (sheet.rows == 1) sheet.columns = in_row_;
    if (in_row_ != sheet.columns || in_row_ < 2)
      fail(fmt::format("row {} has {} points, the first {}; rows have the same number, two or more",
                       sheet.rows, in_row_, sheet.columns));
  }

  void end() {
    if (sheets_.empty()) return;
    end_row();
    const TableFascia& sheet = sheets_.back();
    if (sheet.rows < 2) fail("a sheet needs two rows or more");
    if (sheet.label.empty()) fail("no 'label'");
    if (sheet.group.empty()) fail("no 'group'");
  }

  TextScan scan_;
  std::string name_;
  const MuscleTable& landmarks_;
  std::vector<TableFascia> sheets_;
  int in_row_ = 0;
};

FasciaPlan described(const TableFascia& from, Side side) {
  return {from.name + side_suffix(side),
          side,
          from.label,
          from.group,
          from.thickness,
          from.fade,
          {},
          from.rows,
          from.columns,
          {},
          FasciaPlan::Form::sheet,
          0};
}

std::vector<std::string> bones_of(const TableFascia& from, const PathCarriers& carriers) {
  std::vector<std::string> out;
  for (const std::string& bone : from.bones) {
    out.push_back(carriers.bone_name(bone));
    if (out.back().empty())
      throw InputError(fmt::format("{}: no bone '{}' in the skeleton", from.where, bone));
    if (from.middle && out.back() != bone)
      throw InputError(
          fmt::format("{}: 'middle' and 'on {}': a sheet across the mid-plane is carried by bones "
                      "that lie on it; name vertebrae, the sacrum or the sternum",
                      from.where, bone));
  }
  return out;
}

FasciaPlan place(const TableFascia& from, const MuscleTable& landmarks, const Anatomy& source,
                 Side side) {
  const PathCarriers carriers(landmarks, source, side);
  FasciaPlan plan = described(from, side);
  plan.bones = bones_of(from, carriers);
  for (const TablePoint& point : from.points) plan.points.push_back(carriers.carry(point));
  return plan;
}

// From left to right: each row, and its mirror image without what lies on the mid-plane.
FasciaPlan place_across(const TableFascia& from, const MuscleTable& landmarks,
                        const Anatomy& source) {
  const PathCarriers on_left(landmarks, source, Side::left),
      on_right(landmarks, source, Side::right);
  FasciaPlan plan = described(from, Side::middle);
  plan.bones = bones_of(from, on_left);
  plan.columns = 2 * from.columns - 1;
  for (int r = 0; r < from.rows; ++r) {
    const auto row = std::span(from.points).subspan(std::size_t(r * from.columns), from.columns);
    for (const TablePoint& point : row) plan.points.push_back(on_left.carry(point));
    plan.points.back().rest.x() = kSourceMidPlane;
    for (std::size_t c = row.size() - 1; c-- > 0;) plan.points.push_back(on_right.carry(row[c]));
  }
  return plan;
}

}  // namespace

std::vector<TableFascia> read_fascia_text(std::string_view text, const std::string& name,
                                          const MuscleTable& landmarks) {
  return FasciaReader(text, name, landmarks).read();
}

std::vector<TableFascia> read_fascia_table(const std::filesystem::path& data_dir,
                                           const MuscleTable& landmarks) {
  const std::filesystem::path file = data_dir / "fascia.txt";
  return read_fascia_text(read_input_file(file), file.filename().string(), landmarks);
}

FasciaSheet empty_sheet(const FasciaPlan& plan) {
  FasciaSheet out;
  out.name = plan.name;
  out.side = plan.side;
  out.label = plan.label;
  out.group = plan.group;
  out.bones = plan.bones;
  return out;
}

std::vector<FasciaPlan> place_fascia(const std::vector<TableFascia>& table,
                                     const MuscleTable& landmarks, const Anatomy& source) {
  std::vector<FasciaPlan> plans;
  for (const TableFascia& sheet : table) {
    if (sheet.middle) {
      plans.push_back(place_across(sheet, landmarks, source));
      continue;
    }
    plans.push_back(place(sheet, landmarks, source, Side::left));
    plans.push_back(place(sheet, landmarks, source, Side::right));
  }
  return plans;
}

}  // namespace ecorche::inline v1
