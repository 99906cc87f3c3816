#include "skinning/motion_files/trc_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kFarthestMarker = 1e7;  // in the file's unit
constexpr double kMostUneven = 0.5;      // frames off an even clock
constexpr int kNamedGaps = 8;            // in a line for people

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \r\n"), end = text.find_last_not_of(" \r\n");
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin + 1);
}

// What stands between cells: tabulators, or the semicolons or commas of a spreadsheet.
char separator_of(std::string_view line) {
  for (const char one : {'\t', ';', ','})
    if (line.find(one) != std::string_view::npos) return one;
  return '\t';
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> out;
  for (;;) {
    const std::size_t end = line.find(separator);
    out.push_back(without_blanks(line.substr(0, end)));
    if (end == std::string_view::npos) return out;
    line.remove_prefix(end + 1);
  }
}

// Cells of the head, which blanks may separate too.
std::vector<std::string> words_of(std::string_view line) {
  const std::string ends = {' ', '\r', '\n', separator_of(line)};
  std::vector<std::string> out;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(ends);
    if (begin == std::string_view::npos) return out;
    line.remove_prefix(begin);
    out.emplace_back(line.substr(0, line.find_first_of(ends)));
    line.remove_prefix(out.back().size());
  }
}

class TrcReader {
 public:
  TrcReader(std::string_view text, const std::string& name) : scan_(text, name) {
    out_.name = name;
  }

  MarkerTake read(const std::optional<double>& fps) {
    read_head();
    read_names();
    while (scan_.next_line())
      if (scan_.line().find_first_not_of(" \t\r") != std::string_view::npos) read_row();
    if (stated_frames_ && *stated_frames_ != (long long)(out_.frames.size()))
      out_.warnings.push_back(fmt::format("{}: its head says {} frames, it holds {}", out_.name,
                                          *stated_frames_, out_.frames.size()));
    set_rate(fps);
    const double metres = metres_of_unit(unit_);
    if (metres > 0)
      for (Points& places : out_.frames) places *= metres;
    else
      out_.warnings.push_back(fmt::format("{}: its unit '{}' is not known; taken as metres",
                                          out_.name, printable(unit_)));
    finish_take(unit_, out_);
    return std::move(out_);
  }

 private:
  // Keys and values, a line each: the values may be separated by blanks.
  void read_head() {
    if (!scan_.next_line() || !scan_.line().starts_with("PathFileType"))
      scan_.fail("a .trc begins with PathFileType");
    if (!scan_.next_line()) scan_.fail("it ends before its DataRate");
    separator_ = separator_of(scan_.line());
    const std::vector<std::string> keys = words_of(scan_.line());
    if (!scan_.next_line()) scan_.fail("it ends before the values of its head");
    const std::vector<std::string> values = words_of(scan_.line());
    for (std::size_t k = 0; k < std::min(keys.size(), values.size()); ++k) {
      double number = 0;
      long long whole = 0;
      if (keys[k] == "DataRate") {
        if (!number_of(values[k], number) || !(number > 0) || number > 1e5)
          scan_.fail(
              fmt::format("DataRate: '{}' is no rate; --motion-fps sets it", printable(values[k])));
        rate_ = number;
      }
      if (keys[k] == "NumFrames" && parse_whole(values[k], whole)) stated_frames_ = whole;
      if (keys[k] == "NumMarkers" && parse_whole(values[k], whole)) stated_markers_ = whole;
      if (keys[k] == "Units") unit_ = values[k];
    }
  }

  void read_names() {
    if (!scan_.next_line()) scan_.fail("it ends before the names of its markers");
    separator_ = separator_of(scan_.line());
    const std::vector<std::string_view> cells = cells_of(scan_.line(), separator_);
    if (cells.size() < 3 || !cells[0].starts_with("Frame") || cells[1] != "Time")
      scan_.fail(
          "a line 'Frame#', 'Time' and names of markers is expected, by tabulators, commas or "
          "semicolons");
    std::set<std::string> known;
    std::size_t twice = 0;
    for (std::size_t c = 2; c < cells.size(); ++c) {
      if (cells[c].empty()) continue;
      if ((c - 2) % 3 != 0)
        scan_.fail(fmt::format("marker '{}' is in column {}; each has three columns",
                               printable(cells[c].substr(0, 80)), c + 1));
      if (cells[c].size() > limits::kNameBytes) scan_.fail("a marker's name is too long");
      const std::string name = printable(cells[c]);
      const bool first = known.insert(name).second;
      if (first) out_.markers.push_back(name), columns_.push_back(c);
      if (!first) ++twice;
      if (known.size() > kMostMarkers)
        throw LimitError(fmt::format("{}: more than {} markers", out_.name, kMostMarkers));
    }
    if (out_.markers.empty()) scan_.fail("no marker has a name");
    if (twice > 0)
      out_.warnings.push_back(fmt::format(
          "{}: {} markers have the name of one before them, and are left out", out_.name, twice));
    else if (stated_markers_ && *stated_markers_ != (long long)(out_.markers.size()))
      out_.warnings.push_back(fmt::format("{}: its head says {} markers, it names {}", out_.name,
                                          *stated_markers_, out_.markers.size()));
  }

  // Between semicolons a decimal comma is one.
  bool number_of(std::string_view cell, double& value) const {
    if (separator_ != ';') return parse_number(cell, value);
    std::string plain(cell);
    std::ranges::replace(plain, ',', '.');
    return parse_number(plain, value);
  }

  void read_row() {
    const std::vector<std::string_view> cells = cells_of(scan_.line(), separator_);
    if (times_.empty() && cells[0].empty() && cells.size() > 2 && cells[2].starts_with("X")) return;
    double time = 0;
    if (cells.size() < 2 || !number_of(cells[1], time))
      scan_.fail(fmt::format("the second column should be a time, not '{}'",
                             cells.size() < 2 ? "" : printable(cells[1].substr(0, 80))));
    if (!times_.empty() && !(time > times_.back()))
      scan_.fail(fmt::format("time {} after {}; times should rise", time, times_.back()));
    if (out_.frames.size() >= std::size_t(limits::kMotionFrames))
      throw LimitError(fmt::format("{}: more than {} frames", out_.name, limits::kMotionFrames));
    times_.push_back(time);
    Points& places = out_.frames.emplace_back(Points::Constant(
        Eigen::Index(columns_.size()), 3, std::numeric_limits<double>::quiet_NaN()));
    for (std::size_t m = 0; m < columns_.size(); ++m)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t c = columns_[m] + k;
        if (c < cells.size()) places(Eigen::Index(m), Eigen::Index(k)) = coordinate(cells[c], m);
      }
  }

  double coordinate(std::string_view cell, std::size_t marker) const {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (cell.empty() || cell == "NaN" || cell == "nan" || cell == "NAN") return value;
    if (!number_of(cell, value) || std::abs(value) > kFarthestMarker)
      scan_.fail(fmt::format("marker '{}': '{}' is no place", out_.markers[marker],
                             printable(cell.substr(0, 80))));
    return value;
  }

  // Times are believed before the head, but they are often rounded to milliseconds.
  void set_rate(const std::optional<double>& fps) {
    if (!times_.empty()) out_.start = times_[0];
    out_.fps = fps.value_or(rate_.value_or(100));
    if (fps || times_.size() < 2) return;
    for (const double rate : {rate_.value_or(0), rate_of(times_)})
      if (insert_lost_frames(rate)) return;
    const double steps = double(times_.size() - 1), mean = steps / (times_.back() - times_[0]);
    if (!rate_ || std::abs(*rate_ - mean) * (times_.back() - times_[0]) > kMostUneven)
      out_.fps = rate_of(times_);
    if (rate_ && std::abs(*rate_ - out_.fps) > 0.01 * out_.fps)
      out_.warnings.push_back(
          fmt::format("{}: its head says {:.4g} frames a second, its times say {:.4g}", out_.name,
                      *rate_, out_.fps));
    double worst = 0;
    for (std::size_t f = 1; f < times_.size(); ++f)
      worst = std::max(worst, std::abs((times_[f] - times_[0]) * out_.fps - double(f)));
    if (worst > kMostUneven)
      out_.warnings.push_back(
          fmt::format("{}: its times are uneven by up to {:.2g} frames; they are taken as even",
                      out_.name, worst));
  }

  // Where the times are those of an even clock that leaps over whole frames, these are put in,
  // unseen. Whether they are.
  bool insert_lost_frames(double rate) {
    if (!(rate > 0)) return false;
    std::vector<std::size_t> place;  // of each frame by that clock
    for (const double time : times_) {
      const double at = (time - times_[0]) * rate, nearest = std::round(at);
      if (std::abs(at - nearest) > kMostUneven / 2) return false;
      if (nearest > limits::kMotionFrames || (!place.empty() && nearest <= double(place.back())))
        return false;
      place.push_back(std::size_t(nearest));
    }
    const std::size_t lost = place.back() + 1 - place.size();
    if (lost == 0 || 2 * lost > place.size()) return false;
    std::vector<Points> frames(place.back() + 1,
                               Points::Constant(Eigen::Index(columns_.size()), 3,
                                                std::numeric_limits<double>::quiet_NaN()));
    std::string where;
    int gaps = 0;
    for (std::size_t f = 0; f < place.size(); ++f) {
      frames[place[f]] = std::move(out_.frames[f]);
      const std::size_t first = f == 0 ? 0 : place[f - 1] + 1;
      if (place[f] == first || ++gaps > kNamedGaps) continue;
      where += where.empty() ? "" : ", ";
      where += place[f] == first + 1 ? fmt::format("{}f", first + 1)
                                     : fmt::format("{}f to {}f", first + 1, place[f]);
    }
    out_.frames = std::move(frames);
    out_.fps = rate;
    out_.warnings.push_back(fmt::format(
        "{}: its times leap over {} frames, which are taken as not seen: {}{}", out_.name, lost,
        where, gaps > kNamedGaps ? fmt::format(" and {} more", gaps - kNamedGaps) : ""));
    return true;
  }

  TextScan scan_;
  char separator_ = '\t';
  MarkerTake out_;
  std::optional<double> rate_;
  std::optional<long long> stated_frames_, stated_markers_;
  std::string unit_;
  std::vector<std::size_t> columns_;  // of the markers' x
  std::vector<double> times_;
};

}  // namespace

MarkerTake parse_trc(std::string_view text, const std::string& name,
                     const std::optional<double>& fps) {
  return TrcReader(text, name).read(fps);
}

}  // namespace ecorche::inline v1
