#include "anatomy/authoring/muscle_text.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

// The shortest decimals within half of `step`; never "-0".
std::string decimal(double value, double step) {
  const double steps = std::round(value / step);
  return fmt::format("{:.10g}", steps == 0 ? 0.0 : steps / std::round(1 / step));
}

std::string millimetres(double metres) { return decimal(1e3 * metres, 1e-4); }
std::string share(double value) { return decimal(value, 1e-6); }

std::string offset_text(const Vec3& metres) {
  return fmt::format("{} {} {}", millimetres(metres.x()), millimetres(metres.y()),
                     millimetres(metres.z()));
}

std::string point_text(const MuscleTable& table, const TablePoint& point) {
  std::string out = table.landmarks[std::size_t(point.landmark)].id;
  const std::string offset = offset_text(point.offset);
  if (offset != "0 0 0") out += " " + offset;
  if (!point.glides.empty()) out += " with " + point.glides;
  return out;
}

void add_strip(const MuscleTable& table, const TableStrip& strip, std::string& out) {
  out += "  strip\n";
  for (std::size_t k = 0; k < strip.path.size(); ++k)
    out += fmt::format("    {} {}\n",
                       k == 0                      ? "origin"
                       : k + 1 < strip.path.size() ? "via"
                                                   : "insertion",
                       point_text(table, strip.path[k]));
  for (const TableStrip::WrapUse& use : strip.wraps) {
    out += "    over " + table.wraps[std::size_t(use.wrap)].name;
    if (use.radius > 0) out += " " + millimetres(use.radius);
    out += "\n";
  }
  out += fmt::format("    belly {} {}\n", share(strip.belly_begin), share(strip.belly_end));
  for (const double place : strip.intersections)
    out += fmt::format("    intersection {}\n", share(place));
  if (strip.raphe > 0) out += fmt::format("    raphe {}\n", share(strip.raphe));
  for (const TableSection& section : strip.sections)
    out +=
        fmt::format("    section {} {} {}  {} {} {}\n", share(section.s),
                    millimetres(2 * section.radii.x()), millimetres(2 * section.radii.y()),
                    share(section.width.x()), share(section.width.y()), share(section.width.z()));
}

}  // namespace

std::string muscle_text(const MuscleTable& table, const TableMuscle& muscle) {
  std::string out = "muscle " + muscle.name + "\n";
  const auto line = [&out](const char* keyword, const std::string& words) {
    if (!words.empty()) out += fmt::format("  {} {}\n", keyword, words);
  };
  line("label", muscle.label);
  line("group", muscle.group);
  line("layer", muscle.layer);
  line("shape", muscle.shape);
  if (muscle.sheet) out += "  sheet\n";
  line("volume",
       decimal(1e6 * muscle.volume_male, 1e-4) + " " + decimal(1e6 * muscle.volume_female, 1e-4));
  line("fibre", decimal(1e2 * muscle.fibre_length, 1e-5));
  line("pennation", decimal(muscle.pennation * 180 / std::numbers::pi, 1e-4));
  if (muscle.tendon_fraction > 0) line("tendon", share(muscle.tendon_fraction));
  if (muscle.tense_thickness > 0) line("tense", share(muscle.tense_thickness));
  if (muscle.max_force > 0) line("force", decimal(muscle.max_force, 1e-3));
  line("from", muscle.origin);
  line("to", muscle.insertion);
  line("action", muscle.action);
  for (const std::string& source : muscle.sources) line("source", source);
  std::string compare;
  for (const std::string& path : muscle.compare) compare += (compare.empty() ? "" : " ") + path;
  line("compare", compare);
  line("note", muscle.note);
  for (const TableStrip& strip : muscle.strips) add_strip(table, strip, out);
  return out;
}

std::string wrap_text(const MuscleTable& table, const TableWrap& wrap) {
  const std::string at = table.landmarks[std::size_t(wrap.landmark)].id;
  const std::string offset = offset_text(wrap.offset);
  switch (wrap.kind) {
    case Wrap::Kind::sphere:
      return fmt::format("wrap {} sphere at {} {} radius {}\n", wrap.name, at, offset,
                         millimetres(wrap.radii.x()));
    case Wrap::Kind::cylinder:
      return fmt::format("wrap {} cylinder at {} {} radius {} half {} axis {} {} {}\n", wrap.name,
                         at, offset, millimetres(wrap.radii.x()), millimetres(wrap.radii.z()),
                         share(wrap.axis.x()), share(wrap.axis.y()), share(wrap.axis.z()));
    case Wrap::Kind::ellipsoid:
      break;
  }
  return fmt::format("wrap {} ellipsoid at {} {} axes {}\n", wrap.name, at, offset,
                     offset_text(wrap.radii));
}

}  // namespace ecorche::inline v1
