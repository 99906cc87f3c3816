// Many people: rows of a CSV of measures, or draws from the shape space, each made into a body by
// itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "morph/shapes/sizes.h"
#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {

struct Person {
  std::string name;  // of the file without its ending: letters, digits, . _ -
  Sex sex = Sex::male;
  std::optional<double> age;  // years
  std::vector<MeasureTarget> targets;
  std::optional<std::uint64_t>
      draw;  // instead of targets: a body drawn from the space with this seed
};

// A row that cannot be meant.
struct BadRow {
  int line = 0;
  std::string what;  // "people.csv:17: ..."
};

struct People {
  std::vector<Person> people;  // in the order of the rows
  std::vector<BadRow> bad;
};

// First row: names of columns: `name`, `sex`, `age` (all optional), `size` (XS .. XL), and measures
// of `body measure --list`. Cells are quantities ("92cm"; a bare number is metres or kilograms);
// empty ones are not asked for. Lines that start with # are remarks. Bad rows are set aside. Throws
// InputError for a file that cannot be read, UsageError for a column that is not known.
People read_people(const std::filesystem::path& file, std::optional<Sex> sex,
                   const TapeMeasure& tape, const std::vector<StandardSize>& sizes);

// `count` people drawn from the law of the space, by turns female and male when `sex` is left out.
// Person i depends on `seed` and i alone.
std::vector<Person> draw_people(int count, std::optional<Sex> sex, std::uint64_t seed);

// The body of a person. Throws UnfitError that names the conflicts.
SolvedBody make_person(const TapeMeasure& tape, const ShapeSpace& space, const Person& person,
                       const SolveOptions& options);

}  // namespace ecorche::inline v1
