#include "anatomy/files/quantity.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

struct UnitName {
  std::string_view name;
  double factor;  // SI units a unit
};

constexpr double kInch = 0.0254, kFoot = 12 * kInch, kPound = 0.45359237;

constexpr UnitName kLengthUnits[] = {
    {"m", 1},        {"metre", 1},  {"metres", 1}, {"meter", 1},    {"meters", 1},
    {"cm", 0.01},    {"mm", 0.001}, {"in", kInch}, {"inch", kInch}, {"inches", kInch},
    {"\"", kInch},   {"''", kInch}, {"″", kInch},  {"ft", kFoot},   {"foot", kFoot},
    {"feet", kFoot}, {"'", kFoot},  {"′", kFoot},  {"dm", 0.1},
};
constexpr UnitName kMassUnits[] = {{"kg", 1},       {"g", 0.001},        {"lb", kPound},
                                   {"lbs", kPound}, {"st", 14 * kPound}, {"stone", 14 * kPound}};

void skip_blanks(std::string_view& text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
}

// Takes a number from the beginning.
std::optional<double> take_number(std::string_view& text) {
  skip_blanks(text);
  double value = 0;
  const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(std::size_t(after - text.data()));
  return value;
}

// Takes the longest unit's name from the beginning; what follows must not be a letter.
std::optional<double> take_unit(std::string_view& text, std::span<const UnitName> units) {
  skip_blanks(text);
  const UnitName* best = nullptr;
  for (const UnitName& unit : units)
    if (text.starts_with(unit.name) && (!best || unit.name.size() > best->name.size()))
      best = &unit;
  if (!best) return std::nullopt;
  text.remove_prefix(best->name.size());
  if (!text.empty() && std::isalpha(static_cast<unsigned char>(text.front()))) return std::nullopt;
  return best->factor;
}

struct Parsed {
  double value = 0;
  bool has_unit = false;
};

// A number and a unit; after feet or stones, inches or pounds may follow, with or without theirs.
std::optional<Parsed> parse_units(std::string_view text, std::span<const UnitName> units,
                                  double coarse, double fine) {
  const std::optional<double> number = take_number(text);
  if (!number) return std::nullopt;
  skip_blanks(text);
  if (text.empty()) return Parsed{*number, false};
  const std::optional<double> unit = take_unit(text, units);
  if (!unit) return std::nullopt;
  Parsed out{*number * *unit, true};
  skip_blanks(text);
  if (text.empty()) return out;
  if (*unit != coarse) return std::nullopt;
  const std::optional<double> rest = take_number(text);
  if (!rest || *rest < 0 || *rest * fine >= coarse) return std::nullopt;
  skip_blanks(text);
  if (!text.empty() && take_unit(text, units) != fine) return std::nullopt;
  skip_blanks(text);
  if (!text.empty()) return std::nullopt;
  out.value += *rest * fine;
  return out;
}

bool inside(double value, const LengthRange& range) {
  return value >= range.low && value <= range.high;
}

[[noreturn]] void refuse(std::string_view text, const std::string& what, const std::string& why) {
  throw UsageError(fmt::format("{} {}: {}", what, printable(std::string(text)), why));
}

// Which units a bare number might be meant in.
std::string meant_otherwise(std::string_view text, double value, const LengthRange& usual) {
  constexpr std::array<UnitName, 4> others{
      {{"cm", 0.01}, {"mm", 0.001}, {"in", kInch}, {"ft", kFoot}}};
  std::string out;
  for (const UnitName& unit : others)
    if (inside(value * unit.factor, usual))
      out += fmt::format("{}{}{}", out.empty() ? "" : " or ", text, unit.name);
  return out;
}

}  // namespace

double parse_length(std::string_view text, const std::string& what, const LengthRange& possible,
                    const LengthRange& usual) {
  const std::optional<Parsed> parsed = parse_units(text, kLengthUnits, kFoot, kInch);
  if (!parsed) {
    const bool comma = text.find(',') != std::string_view::npos;
    refuse(text, what,
           fmt::format("not a length; write it like 92cm, 0.92m, 920mm, 36.2in or 5ft10{}",
                       comma ? ", with a point for the decimals" : ""));
  }
  if (!parsed->has_unit) {
    const std::string others = meant_otherwise(text, parsed->value, usual);
    const bool metres = inside(parsed->value, possible);
    if (!metres || !others.empty()) {
      const std::string write = others.empty() ? "it like 92cm, 0.92m or 36in"
                                : metres       ? fmt::format("{}m or {}", text, others)
                                               : others;
      refuse(text, what, "a unit is missing; write " + write);
    }
  }
  if (!inside(parsed->value, possible))
    refuse(text, what,
           fmt::format("{:.4g} m is not possible; {:.3g} m to {:.3g} m is", parsed->value,
                       possible.low, possible.high));
  return parsed->value;
}

double parse_mass(std::string_view text, const std::string& what, double low, double high) {
  const std::optional<Parsed> parsed = parse_units(text, kMassUnits, 14 * kPound, kPound);
  if (!parsed) refuse(text, what, "not a mass; write it like 70kg, 154lb or 11st4");
  if (!(parsed->value >= low && parsed->value <= high))
    refuse(text, what,
           fmt::format("{:.4g} kg is not possible; {:.3g} kg to {:.3g} kg is", parsed->value, low,
                       high));
  return parsed->value;
}

}  // namespace ecorche::inline v1
