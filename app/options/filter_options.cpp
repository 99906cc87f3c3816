#include "app/options/filter_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <string_view>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/similar_names.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kNames = {"lock", "smooth", "speed", "length", "fps",  "mirror",
                                         "loop", "blend",  "path",  "bend",   "turn", "slope"};

// NAME[=VALUE][,KEY=VALUE..]. A comma that no KEY= of the filter follows belongs to the value, as
// in names of files.
struct FilterWord {
  std::string text, name, value;
  std::map<std::string, std::string> keys;

  FilterWord(const std::string& word, const std::vector<std::string>& known_keys);
  [[noreturn]] void refuse(const std::string& why) const {
    throw UsageError(fmt::format("--filter {}: {}", printable(text), why));
  }
  double number(const std::string& of, std::vector<std::string> units, double low, double high,
                const std::string& what) const;
  std::string key(const std::string& of, const std::string& otherwise) const {
    const auto found = keys.find(of);
    return found == keys.end() ? otherwise : found->second;
  }
};

FilterWord::FilterWord(const std::string& word, const std::vector<std::string>& known_keys)
    : text(word) {
  std::string rest = word;
  for (std::size_t comma = rest.rfind(','); comma != std::string::npos; comma = rest.rfind(',')) {
    const std::size_t equals = rest.find('=', comma);
    if (equals == std::string::npos) break;
    const std::string key = rest.substr(comma + 1, equals - comma - 1);
    if (std::ranges::find(known_keys, key) == known_keys.end()) break;
    if (!keys.emplace(key, rest.substr(equals + 1)).second) refuse(key + " is given twice");
    rest.resize(comma);
  }
  name = rest.substr(0, rest.find('='));
  if (name.size() < rest.size()) value = rest.substr(name.size() + 1);
}

// A number with one of the units or none.
double FilterWord::number(const std::string& of, std::vector<std::string> units, double low,
                          double high, const std::string& what) const {
  std::string_view digits = of;
  double factor = 1;
  for (const std::string& unit : units)
    if (digits.size() > unit.size() && digits.ends_with(unit)) {
      if (unit == "ms") factor = 1e-3;
      if (unit == "%") factor = 1e-2;
      digits.remove_suffix(unit.size());
      break;
    }
  double out = 0;
  if (!parse_number(digits, out)) {
    const std::string unit = units.empty() ? "" : " (in " + units.back() + ")";
    refuse(fmt::format("'{}' is no number; give {}{} from {} to {}", printable(of), what, unit, low,
                       high));
  }
  out *= factor;
  if (!(out >= low && out <= high))
    refuse(
        fmt::format("{} is out of range; give {} from {} to {}", printable(of), what, low, high));
  return out;
}

double seconds(const FilterWord& word, const std::string& of, double low, double high,
               const std::string& what) {
  return word.number(of, {"ms", "s"}, low, high, what);
}

double angle(const FilterWord& word, double most, const std::string& what) {
  return kDegree * word.number(word.value, {"deg"}, -most, most, what);
}

LoopOptions to_loop(const FilterWord& word) {
  LoopOptions out;
  const std::string travel = word.key("travel", "keep"), ends = word.key("ends", "find");
  if (travel != "keep" && travel != "out")
    word.refuse(fmt::format("travel={} is none; there are keep and out", printable(travel)));
  if (ends != "find" && ends != "keep")
    word.refuse(fmt::format("ends={} is none; there are find and keep", printable(ends)));
  out.keep_travel = travel == "keep";
  out.find = ends == "find";
  if (word.keys.contains("over"))
    out.over = seconds(word, word.keys.at("over"), 0.01, 10, "a time");
  return out;
}

MotionFilter to_path(const FilterWord& word) {
  if (word.value == "straight") return StraightenPath{};
  const Table table{fs::path(word.value)};
  FollowPoints out;
  for (int row = 0; row < table.rows(); ++row) {
    const Eigen::Vector2d point(table.number(row, "x"), table.number(row, "z"));
    if (point.cwiseAbs().maxCoeff() > 1000)
      throw InputError(table.where(row) + ": a point more than 1000 m away; x and z are metres");
    if (!out.points.empty() && (point - out.points.back()).norm() < 0.01)
      throw InputError(table.where(row) +
                       ": a point less than 1 cm from the one before; leave one out");
    out.points.push_back(point);
  }
  if (out.points.size() < 2)
    throw InputError(fmt::format("{}: {} points of a path; give two or more, one a row (x, z in m)",
                                 printable(word.value), out.points.size()));
  return out;
}

MotionFilter to_blend(const FilterWord& word, const SecondMotion& second) {
  const bool mixed = word.keys.contains("share");
  if (mixed && (word.keys.contains("at") || word.keys.contains("over")))
    word.refuse("share mixes both from beginning to end; leave out at and over, or share");
  if (!mixed && !word.keys.contains("at"))
    word.refuse("say where it begins (at=1.5s), or how much of it is mixed in (share=0.5)");
  if (mixed) {
    const double share = word.number(word.keys.at("share"), {"%"}, 0, 1, "a share");
    return MixWith{second(word.value), share};
  }
  Transition transition;
  transition.at = seconds(word, word.keys.at("at"), 0, 1e5, "a time");
  if (word.keys.contains("over"))
    transition.over = seconds(word, word.keys.at("over"), 0, 100, "a time");
  return GoOver{second(word.value), transition};
}

const std::vector<std::string>& keys_of(const std::string& name) {
  static const std::vector<std::string> none, loop = {"travel", "ends", "over"},
                                              blend = {"at", "over", "share"};
  return name == "loop" ? loop : name == "blend" ? blend : none;
}

MotionFilter to_filter(const FilterWord& word, const SecondMotion& second) {
  const std::string& name = word.name;
  const std::string guess = did_you_mean(name, kNames);
  if (std::ranges::find(kNames, name) == kNames.end())
    word.refuse(fmt::format("'{}' is no filter{}{} there are {}", printable(name), guess,
                            guess.empty() ? ";" : "", fmt::join(kNames, ", ")));
  const bool bare = name == "mirror" || name == "loop";
  if (bare && !word.value.empty())
    word.refuse(fmt::format("{} takes no '{}'", name, printable(word.value)));
  if (!bare && word.value.empty()) word.refuse(fmt::format("it needs a value ({}=..)", name));
  if (name == "lock") return LockFeet{word.number(word.value, {"%"}, 0, 1, "a strength")};
  if (name == "smooth") return SmoothFrames{seconds(word, word.value, 0, 10, "a width")};
  if (name == "speed") return WarpTime{word.number(word.value, {"x"}, 0.02, 50, "a factor")};
  if (name == "length") return FitLength{seconds(word, word.value, 0.01, 1e5, "a time")};
  if (name == "fps") return ChangeRate{word.number(word.value, {}, 1, 1000, "frames a second")};
  if (name == "mirror") return MirrorMotion{};
  if (name == "loop") return to_loop(word);
  if (name == "path") return to_path(word);
  if (name == "bend") return BendPath{angle(word, 720, "an angle to the left")};
  if (name == "turn") return TurnMotion{angle(word, 360, "an angle to the left")};
  if (name == "slope") return SlopeGround{angle(word, 30, "an angle upwards")};
  return to_blend(word, second);
}

// What a loop's rounds cannot be led through any more.
bool fits_after_loop(const std::string& name) {
  return name != "loop" && name != "blend" && name != "path" && name != "bend";
}

}  // namespace

void add_filter_option(CLI::App& verb, std::vector<std::string>& filters) {
  verb.add_option(
          "--filter", filters,
          "Change the motion; several in the order given. lock=0.5: how firmly feet stand, 0 to 1. "
          "smooth=0.2s: means over that width; feet that stand stay. speed=0.5, length=2s, fps=24. "
          "mirror. loop[,travel=out][,ends=keep][,over=0.25s]: the end leads into the beginning. "
          "blend=FILE,at=1.5s[,over=0.3s]: go over to another motion; blend=FILE,share=0.5: mix "
          "both. path=straight, path=POINTS.csv (x, z in m), bend=90 and turn=90 degrees to the "
          "left. slope=8: ground that rises by 8 degrees")
      ->allow_extra_args(false);
}

std::vector<MotionFilter> to_filters(const std::vector<std::string>& words,
                                     const SecondMotion& second) {
  std::vector<MotionFilter> out;
  bool looped = false;
  for (const std::string& text : words) {
    const FilterWord word(text, keys_of(text.substr(0, text.find_first_of("=,"))));
    if (looped && !fits_after_loop(word.name))
      word.refuse("it comes after loop, whose rounds it would break; put it before");
    out.push_back(to_filter(word, second));
    looped |= word.name == "loop";
  }
  return out;
}

}  // namespace ecorche
