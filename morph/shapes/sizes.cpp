#include "morph/shapes/sizes.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {

std::vector<StandardSize> read_sizes(const std::filesystem::path& folder) {
  const Table rows(folder / "sizes.csv");
  std::vector<StandardSize> out;
  for (int row = 0; row < rows.rows(); ++row) {
    const auto metres = [&](const char* column) { return 0.01 * rows.number(row, column); };
    StandardSize size;
    size.name = rows.text(row, "size");
    size.sex = rows.text(row, "sex") == "female" ? Sex::female : Sex::male;
    size.stature = metres("stature_cm");
    size.chest = {metres("chest_min_cm"), metres("chest_max_cm")};
    size.waist = {metres("waist_min_cm"), metres("waist_max_cm")};
    size.hip = {metres("hip_min_cm"), metres("hip_max_cm")};
    for (const auto& range : {size.chest, size.waist, size.hip})
      if (!(range[0] > 0 && range[1] > range[0]))
        throw InputError(fmt::format("{}: size {}: every range needs min below max",
                                     rows.where(row), size.name));
    out.push_back(std::move(size));
  }
  return out;
}

const StandardSize& find_size(const std::vector<StandardSize>& sizes, Sex sex,
                              const std::string& name) {
  const auto same = [&name](const std::string& other) {
    return std::equal(
        name.begin(), name.end(), other.begin(), other.end(),
        [](unsigned char a, unsigned char b) { return std::toupper(a) == std::toupper(b); });
  };
  std::string names;
  for (const StandardSize& size : sizes) {
    if (size.sex != sex) continue;
    if (same(size.name)) return size;
    names += (names.empty() ? "" : ", ") + size.name;
  }
  throw UsageError(fmt::format("--size {}: choose one of {}", name, names));
}

std::vector<MeasureTarget> size_targets(const StandardSize& size, const MeasureTable& table) {
  const auto middle = [](const std::array<double, 2>& range) {
    return 0.5 * (range[0] + range[1]);
  };
  return {{table.at("stature"), size.stature},
          {table.at("chest_girth"), middle(size.chest)},
          {table.at("waist_girth"), middle(size.waist)},
          {table.at("hip_girth"), middle(size.hip)}};
}

std::vector<SizeFigure> size_figures(const TapeMeasure& tape, const BodyPackage& package,
                                     const Points& skin) {
  // Clothes are bought by bust, waist and hip; lengths are altered more easily.
  constexpr double kMain = 1, kOther = 0.5, kLength = 0.25;
  const BodyFeatures features = find_features({skin.topRows(package.skin_size), package.triangles});
  const auto measured = [&](const char* id, double weight) {
    return SizeFigure{id, tape.take(tape.table().at(id), skin), weight};
  };
  return {measured("stature", kLength),
          {"crotch_height", features.crotch_height, kLength},
          measured("arm_length_outseam", kLength),
          measured("neck_base_girth", kOther),
          {"bust", features.bust.girth, kMain},
          measured("underbust_girth", kOther),
          {"waist", features.waist.girth, kMain},
          {"hip", features.hip.girth, kMain}};
}

double size_distance(const std::vector<SizeFigure>& body, const std::vector<SizeFigure>& size) {
  double sum = 0;
  for (std::size_t i = 0; i < body.size(); ++i)
    sum += body[i].weight * (body[i].value - size[i].value) * (body[i].value - size[i].value);
  return sum;
}

}  // namespace ecorche::inline v1
