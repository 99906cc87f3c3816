#include "skinning/motion/activation_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSlack = 1e-6;  // beyond [0, 1], from rounding

struct Source {
  const Anatomy& anatomy;
  const MuscleAliases& aliases;
  std::string name;  // of the file, for messages
};

std::vector<int> find_muscles(const Source& source, const std::string& where,
                              const std::string& name) {
  if (name.size() > limits::kNameBytes)
    throw LimitError(fmt::format("{}: a name of {} bytes; the limit is {}", where, name.size(),
                                 limits::kNameBytes));
  std::vector<int> muscles = muscles_meant(source.anatomy, name, source.aliases);
  if (muscles.empty())
    throw InputError(fmt::format(
        "{}: no muscle is called '{}'; near it are {}. `ecorche template info` lists the names; "
        "`*` stands for any letters",
        where, printable(name.substr(0, 80)), nearest_names(source.anatomy, name, source.aliases)));
  return muscles;
}

double checked_value(const std::string& where, const std::string& name, double value) {
  if (!(value >= -kSlack && value <= 1 + kSlack))
    throw InputError(
        fmt::format("{}: '{}': activation {} is outside 0 .. 1; divide percentages by 100", where,
                    printable(name.substr(0, 80)), value));
  return std::clamp(value, 0.0, 1.0);
}

void check_rise(const std::string& where, const std::vector<double>& times) {
  const std::size_t n = times.size();
  if (n > 1 && !(times[n - 1] > times[n - 2]))
    throw InputError(
        fmt::format("{}: time {} does not rise after {}", where, times[n - 1], times[n - 2]));
}

Activations from_columns(const Source& source, const std::vector<std::string>& names,
                         const std::vector<std::string>& wheres, const std::vector<double>& times,
                         std::vector<std::vector<double>>& values) {
  if (times.empty()) throw InputError(source.name + ": no rows of values");
  Activations out;
  out.muscles = source.anatomy.muscles.size();
  for (std::size_t c = 0; c < names.size(); ++c) {
    ActivationCurve curve;
    curve.muscles = find_muscles(source, wheres[c], names[c]);
    curve.times = times;
    curve.values = std::move(values[c]);
    out.curves.push_back(std::move(curve));
  }
  return out;
}

Activations read_keyframes(const Source& source, const Table& table) {
  std::map<std::string, std::map<double, double>> keys;
  std::map<std::string, std::string> wheres;
  for (int row = 0; row < table.rows(); ++row) {
    const std::string& name = table.text(row, "muscle");
    const double time = table.number(row, "time"),
                 value = checked_value(table.where(row), name, table.number(row, "value"));
    wheres.try_emplace(name, table.where(row));
    if (!keys[name].try_emplace(time, value).second)
      throw InputError(fmt::format("{}: '{}' has a second value at {} s; keep one of them",
                                   table.where(row), printable(name.substr(0, 80)), time));
  }
  if (keys.empty()) throw InputError(source.name + ": no rows of values");
  Activations out;
  out.muscles = source.anatomy.muscles.size();
  for (const auto& [name, times] : keys) {
    ActivationCurve curve;
    curve.muscles = find_muscles(source, wheres[name], name);
    for (const auto& [time, value] : times) {
      curve.times.push_back(time);
      curve.values.push_back(value);
    }
    out.curves.push_back(std::move(curve));
  }
  return out;
}

Activations read_csv(const Source& source, std::string_view text) {
  const Table table(text, source.name);
  if (!table.has_column("time"))
    throw InputError(source.name +
                     ": no column 'time'; write time,muscle,value or time and a column a muscle");
  if (table.has_column("muscle") && table.has_column("value")) return read_keyframes(source, table);
  std::vector<std::string> names;
  for (const std::string& name : table.columns())
    if (name != "time") names.push_back(name);
  if (names.empty())
    throw InputError(fmt::format("{}: no column of a muscle beside 'time'", source.name));
  std::vector<double> times;
  std::vector<std::vector<double>> values(names.size());
  for (int row = 0; row < table.rows(); ++row) {
    times.push_back(table.number(row, "time"));
    check_rise(table.where(row), times);
    for (std::size_t c = 0; c < names.size(); ++c)
      values[c].push_back(checked_value(table.where(row), names[c], table.number(row, names[c])));
  }
  return from_columns(source, names, std::vector<std::string>(names.size(), source.name), times,
                      values);
}

std::string lower_activation_read(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool is_activation(const std::string& label) {
  const std::string text = lower_activation_read(label);
  return text.ends_with("/activation") || text.ends_with(".activation") ||
         text.ends_with("|activation");
}

Activations read_opensim(const Source& source, std::string_view text) {
  TextScan scan(text, source.name);
  bool head = true;
  while (head) {
    if (!scan.next_line())
      throw InputError(source.name +
                       ": no line 'endheader'; OpenSim tables have one before their labels");
    head = lower_activation_read(scan.word()) != "endheader";
  }
  std::vector<std::string> labels;
  while (labels.empty()) {
    if (!scan.next_line()) throw InputError(source.name + ": no line of labels after 'endheader'");
    for (std::string_view word = scan.word(); !word.empty(); word = scan.word()) {
      labels.emplace_back(word);
      if (labels.size() > limits::kTableColumns)
        throw LimitError(fmt::format("{}:{}: more than {} columns", source.name, scan.line_number(),
                                     limits::kTableColumns));
    }
  }
  const std::string where = fmt::format("{}:{}", source.name, scan.line_number());
  if (lower_activation_read(labels[0]) != "time" || labels.size() < 2)
    scan.fail("the first label is not 'time', or there is none after it");
  if (std::set<std::string>(labels.begin(), labels.end()).size() != labels.size())
    scan.fail("two columns of one label");
  const bool only_activations = std::any_of(labels.begin(), labels.end(), is_activation);
  std::vector<std::string> names;
  std::vector<char> used(labels.size(), 0);
  for (std::size_t c = 1; c < labels.size(); ++c) {
    used[c] = !only_activations || is_activation(labels[c]);
    if (used[c]) names.push_back(labels[c]);
  }
  std::vector<double> times;
  std::vector<std::vector<double>> values(names.size());
  while (scan.next_line()) {
    if (scan.at_line_end()) continue;
    times.push_back(scan.number("time"));
    const std::string line = fmt::format("{}:{}", source.name, scan.line_number());
    check_rise(line, times);
    std::size_t at = 0;
    for (std::size_t c = 1; c < labels.size(); ++c) {
      const double value = scan.number(labels[c]);
      if (used[c]) values[at].push_back(checked_value(line, labels[c], value)), ++at;
    }
    if (!scan.at_line_end()) scan.fail(fmt::format("more than {} values", labels.size()));
  }
  return from_columns(source, names, std::vector<std::string>(names.size(), where), times, values);
}

}  // namespace

Activations read_activations(const std::filesystem::path& file, const Anatomy& anatomy,
                             const MuscleAliases& aliases) {
  return parse_activations(read_input_file(file, limits::kTableBytes),
                           printable(file.filename().string()), anatomy, aliases);
}

Activations parse_activations(std::string_view text, const std::string& name,
                              const Anatomy& anatomy, const MuscleAliases& aliases) {
  const Source source{anatomy, aliases, name};
  const std::string extension =
      lower_activation_read(std::filesystem::path(name).extension().string());
  if (extension == ".csv") return read_csv(source, text);
  if (extension == ".sto" || extension == ".mot") return read_opensim(source, text);
  throw InputError(
      fmt::format("{}: unknown kind of activation table '{}'; .csv, .sto and .mot can be read",
                  source.name, extension));
}

}  // namespace ecorche::inline v1
