#include "skinning/motion_files/motion_table.h"

#include <fmt/format.h>

#include <iterator>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"

namespace ecorche::inline v1 {
namespace {

// Enough for a tenth of a micrometre or a millionth of a degree; no negative nought.
std::string number_motion_table(double value) {
  std::string text = fmt::format("{:.7f}", value);
  return text == "-0.0000000" ? text.substr(1) : text;
}

void append_rows(const MotionTable& table, char between, std::string& out) {
  for (std::size_t f = 0; f < table.rows.size(); ++f) {
    out += number_motion_table(double(f) / table.fps);
    for (const double value : table.rows[f]) {
      out += between;
      out += number_motion_table(value);
    }
    out += '\n';
  }
}

std::string as_csv(const MotionTable& table) {
  std::string out = "time [s]";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const std::string& unit = table.units.empty() ? table.unit : table.units[i];
    out += unit.empty() ? fmt::format(",{}", table.columns[i])
                        : fmt::format(",{} [{}]", table.columns[i], unit);
  }
  out += '\n';
  append_rows(table, ',', out);
  return out;
}

std::string as_opensim(const MotionTable& table) {
  std::string out =
      fmt::format("{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees={}\n", table.what,
                  table.rows.size(), table.columns.size() + 1, table.unit == "deg" ? "yes" : "no");
  if (!table.unit.empty() && table.unit != "deg") out += fmt::format("units={}\n", table.unit);
  out += "endheader\ntime";
  for (const std::string& column : table.columns) out += "\t" + column;
  out += '\n';
  append_rows(table, '\t', out);
  return out;
}

}  // namespace

void write_motion_table(const std::filesystem::path& file, const MotionTable& table) {
  const std::string kind = file.extension().string();
  if (kind != ".csv" && kind != ".sto" && kind != ".mot")
    throw UsageError(fmt::format("{}: a table is written as .csv, .sto or .mot", file.string()));
  write_file_atomically(file, kind == ".csv" ? as_csv(table) : as_opensim(table));
}

void write_trc(const std::filesystem::path& file, const MarkerMotion& markers) {
  const std::size_t frames = markers.frames.size(), count = markers.names.size();
  std::string out = fmt::format("PathFileType\t4\t(X/Y/Z)\t{}\n", file.filename().string());
  out +=
      "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNu"
      "mFrames\n";
  out +=
      fmt::format("{0}\t{0}\t{1}\t{2}\tm\t{0}\t1\t{1}\nFrame#\tTime", markers.fps, frames, count);
  for (const std::string& name : markers.names) out += fmt::format("\t{}\t\t", name);
  out += "\n\t";
  for (std::size_t i = 1; i <= count; ++i) out += fmt::format("\tX{0}\tY{0}\tZ{0}", i);
  out += "\n\n";
  for (std::size_t f = 0; f < frames; ++f) {
    out += fmt::format("{}\t{}", f + 1, number_motion_table(double(f) / markers.fps));
    for (const auto& p : markers.frames[f].rowwise())
      out += fmt::format("\t{}\t{}\t{}", number_motion_table(p.z()), number_motion_table(p.y()),
                         number_motion_table(-p.x()));
    out += '\n';
  }
  write_file_atomically(file, out);
}

}  // namespace ecorche::inline v1
