// Standard sizes as bodies, and the size that fits a body best (the try-on method).
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "morph/measures/feature_points.h"
#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {

// A letter of a size table: ranges, m.
struct StandardSize {
  std::string name;
  Sex sex = Sex::male;
  double stature = 0;
  std::array<double, 2> chest{}, waist{}, hip{};
};

// Rows of data/body/sizes.csv, both sexes, in order. Throws InputError.
std::vector<StandardSize> read_sizes(const std::filesystem::path& folder);

// The size of that name (any case). Throws UsageError that lists the names.
const StandardSize& find_size(const std::vector<StandardSize>& sizes, Sex sex,
                              const std::string& name);

// The middle of its ranges, as targets.
std::vector<MeasureTarget> size_targets(const StandardSize& size, const MeasureTable& table);

// The eight figures a body is judged by: three lengths, five girths; bust, waist and hip at the
// feature points.
struct SizeFigure {
  std::string name;
  double value = 0;   // m
  double weight = 1;  // in the sum below
};
std::vector<SizeFigure> size_figures(const TapeMeasure& tape, const BodyPackage& package,
                                     const Points& skin);

// Weighted sum of squared differences, m^2.
double size_distance(const std::vector<SizeFigure>& body, const std::vector<SizeFigure>& size);

}  // namespace ecorche::inline v1
