#include "morph/shapes/population.h"

#include <algorithm>
#include <random>
#include <set>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

constexpr const char* kOwnColumns[] = {"name", "sex", "age", "size"};

bool is_own(const std::string& column) {
  return std::find(std::begin(kOwnColumns), std::end(kOwnColumns), column) != std::end(kOwnColumns);
}

// A column that is no measure would be passed over in silence.
void check_columns(const std::vector<std::string>& columns, const MeasureTable& table,
                   const std::string& where) {
  for (const std::string& column : columns) {
    if (is_own(column)) continue;
    try {
      table.at(column);
    } catch (const Error& e) {
      throw UsageError(
          fmt::format("{}: {}; other columns are name, sex, age and size", where, e.what()));
    }
  }
}

void check_name(const std::string& name) {
  const auto fine = [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == '_' || c == '-';
  };
  if (name.empty() || name.size() > 100 || name[0] == '.' ||
      !std::all_of(name.begin(), name.end(), fine))
    throw InputError(
        fmt::format("name '{}': use up to 100 letters, digits and . _ -, not . first", name));
}

// One row as a table of its own, so that a broken row spoils no other.
Person read_person(const Table& row, const std::vector<std::string>& columns, int number,
                   std::optional<Sex> sex, const TapeMeasure& tape,
                   const std::vector<StandardSize>& sizes) {
  const MeasureTable& table = tape.table();
  const auto text = [&](const char* column) {
    return row.has_column(column) ? row.text(0, column) : std::string();
  };
  Person out;
  out.name = text("name").empty() ? fmt::format("person-{:04}", number) : text("name");
  check_name(out.name);
  const std::string said = text("sex");
  if (said.empty() && !sex)
    throw InputError("no sex: fill the column sex with male or female, or give --sex");
  if (!said.empty() && said != "male" && said != "female")
    throw InputError(fmt::format("sex '{}': expected male or female", said));
  out.sex = said.empty() ? *sex : said == "female" ? Sex::female : Sex::male;
  if (!text("age").empty()) {
    out.age = row.number(0, "age");
    if (!(*out.age >= 1 && *out.age <= 90))
      throw InputError(fmt::format("age {}: expected 1 .. 90 years", *out.age));
  }
  for (const std::string& column : columns) {
    if (is_own(column) || row.text(0, column).empty()) continue;
    const int k = table.at(column);
    out.targets.push_back({k, tape.parse(k, row.text(0, column), column)});
  }
  if (text("size").empty()) return out;
  for (const MeasureTarget& target : size_targets(find_size(sizes, out.sex, text("size")), table))
    if (std::none_of(out.targets.begin(), out.targets.end(),
                     [&](const MeasureTarget& own) { return own.measure == target.measure; }))
      out.targets.push_back(target);
  return out;
}

}  // namespace

People read_people(const std::filesystem::path& file, std::optional<Sex> sex,
                   const TapeMeasure& tape, const std::vector<StandardSize>& sizes) {
  const std::string name = printable(file.string()),
                    bytes = read_input_file(file, limits::kTableBytes);
  People out;
  std::string header;
  std::vector<std::string> columns;
  std::set<std::string> names;
  TextScan scan(bytes, name);
  while (scan.next_line()) {
    const std::string text(scan.line());
    const int line = scan.line_number();
    if (text.find_first_not_of(" \t\r,") == std::string::npos || text[0] == '#') continue;
    if (header.empty()) {
      header = text;
      columns = Table(header, fmt::format("{}:{}", name, line)).columns();
      check_columns(columns, tape.table(), fmt::format("{}:{}", name, line));
      continue;
    }
    try {
      const Table row(header + "\n" + text + "\n", name);
      Person person =
          read_person(row, columns, int(out.people.size() + out.bad.size()) + 1, sex, tape, sizes);
      if (!names.insert(person.name).second)
        throw InputError(fmt::format("name '{}': taken by a row above", person.name));
      out.people.push_back(std::move(person));
    } catch (const Error& e) {
      const std::string own = fmt::format("{}:2: ", name),
                        what = e.what();  // where the row stands in a table of its own
      if (out.people.size() + out.bad.size() >= limits::kPeople)
        throw LimitError(fmt::format("{}:{}: more than {} people", name, line, limits::kPeople));
      out.bad.push_back(
          {line, fmt::format("{}:{}: {}", name, line,
                             what.starts_with(own) ? what.substr(own.size()) : what)});
    }
  }
  if (header.empty())
    throw InputError(name + ": empty; expected a row of column names, then a row a person");
  if (out.people.empty() && out.bad.empty())
    throw InputError(
        fmt::format("{}: no rows after the column names; expected one a person", name));
  return out;
}

std::vector<Person> draw_people(int count, std::optional<Sex> sex, std::uint64_t seed) {
  std::vector<Person> out;
  for (int i = 0; i < count; ++i) {
    Person person;
    person.name = fmt::format("person-{:04}", i + 1);
    person.sex = sex ? *sex : i % 2 == 0 ? Sex::female : Sex::male;
    std::seed_seq mixed{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(i)};
    std::uint32_t words[2];
    mixed.generate(words, words + 2);
    person.draw = (std::uint64_t(words[0]) << 32) | words[1];
    out.push_back(std::move(person));
  }
  return out;
}

SolvedBody make_person(const TapeMeasure& tape, const ShapeSpace& space, const Person& person,
                       const SolveOptions& options) {
  if (person.draw) {
    SolvedBody out;
    out.z.resize(space.basis.cols());
    std::mt19937_64 random(*person.draw);
    std::normal_distribution<double> normal;
    for (double& x : out.z) x = normal(random);
    out.points = space_points(space, out.z);
    out.points.col(1).array() -= out.points.col(1).minCoeff();
    out.met = true;
    return out;
  }
  SolvedBody out = solve_measures(tape, space, person.targets, options);
  if (out.conflicts.empty()) return out;
  std::string why;
  for (const Conflict& conflict : out.conflicts)
    why += (why.empty() ? "" : "; ") + describe(conflict, tape, person.targets);
  throw UnfitError("no body has these measures: " + why);
}

}  // namespace ecorche::inline v1
