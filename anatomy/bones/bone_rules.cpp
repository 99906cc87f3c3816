#include "anatomy/bones/bone_rules.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/mesh_files/stl_io.h"

namespace ecorche::inline v1 {

namespace {

constexpr double kMillimetre = 1e-3, kSquareCentimetre = 1e-4;

struct Step {
  std::vector<std::string> words;
  std::string where, text;

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}: rule step '{}': {}", where, text, message));
  }
  double number(std::size_t word) const {
    double value = 0;
    const std::string& w = words[word];
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc() || end != w.data() + w.size())
      fail(fmt::format("'{}' is not a number", w));
    return value;
  }
};

double key_value(const TriMesh& part, const std::string& key, const Step& step) {
  if (key == "faces") return double(part.F.rows());
  if (key == "area") return surface_area(part) / kSquareCentimetre;
  if (key == "back") {
    Eigen::Index hindmost = 0;
    part.V.col(0).minCoeff(&hindmost);
    return part.V(hindmost, 1) / kMillimetre;
  }
  const auto axis = std::string("xyz").find(key);
  if (key.size() != 1 || axis == std::string::npos) step.fail(fmt::format("unknown key '{}'", key));
  return surface_centroid(part)[axis] / kMillimetre;
}

using Parts = std::vector<const TriMesh*>;

Parts sorted_by(const Parts& parts, const Step& step) {
  const bool falling = step.words[2] == "falling";
  std::vector<std::pair<double, const TriMesh*>> keyed;
  for (const TriMesh* part : parts)
    keyed.emplace_back((falling ? -1 : 1) * key_value(*part, step.words[3], step), part);
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Parts sorted;
  for (const auto& [key, part] : keyed) sorted.push_back(part);
  return sorted;
}

Parts apply_step(const Parts& parts, const Step& step) {
  if (step.words.size() != 4 || (step.words[0] != "keep" && step.words[0] != "take")) {
    step.fail(
        "expected 'keep KEY LOW HIGH', 'keep N falling|rising KEY' or 'take N falling|rising KEY'");
  }
  Parts left;
  if (step.words[2] == "falling" || step.words[2] == "rising") {
    const Parts sorted = sorted_by(parts, step);
    const double wanted = step.number(1);
    if (wanted < 1 || wanted > double(sorted.size()))
      step.fail(fmt::format("only {} components are left", sorted.size()));
    const auto nth = sorted.begin() + std::ptrdiff_t(wanted);
    left.assign(step.words[0] == "take" ? nth - 1 : sorted.begin(), nth);
    return left;
  }
  for (const TriMesh* part : parts) {
    const double value = key_value(*part, step.words[1], step);
    if (value >= step.number(2) && value <= step.number(3)) left.push_back(part);
  }
  if (left.empty()) step.fail(fmt::format("leaves none of {} components", parts.size()));
  return left;
}

}  // namespace

TriMesh select_bone(const std::vector<TriMesh>& components, const std::string& rule,
                    const std::string& where) {
  Parts left;
  for (const TriMesh& part : components) left.push_back(&part);
  std::istringstream steps(rule);
  for (std::string text; std::getline(steps, text, ';');) {
    Step step{{}, where, text};
    std::istringstream words(text);
    for (std::string word; words >> word;) step.words.push_back(word);
    left = apply_step(left, step);
  }
  return join_meshes(left);
}

}  // namespace ecorche::inline v1
