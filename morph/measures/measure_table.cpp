#include "morph/measures/measure_table.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/similar_names.h"

namespace ecorche::inline v1 {
namespace {

template <class Value>
Value lookup(const std::map<std::string, Value>& words, const Table& table, int row,
             const char* column) {
  const auto found = words.find(table.text(row, column));
  if (found == words.end())
    throw InputError(fmt::format("{}: {} '{}' is none of the known ones", table.where(row), column,
                                 table.text(row, column)));
  return found->second;
}

std::vector<SkinLandmark> read_landmarks(const BodyPackage& package,
                                         const std::filesystem::path& file) {
  const Table table(file);
  std::vector<SkinLandmark> out;
  for (int row = 0; row < table.rows(); ++row) {
    const double vertex = table.number(row, "vertex");
    if (!(vertex >= 0 && vertex < package.skin_size && vertex == std::floor(vertex)))
      throw InputError(fmt::format("{}: vertex {} is not one of the skin's {}", table.where(row),
                                   vertex, package.skin_size));
    SkinLandmark landmark{table.text(row, "id"), int(vertex), table.text(row, "rule")};
    const Vec3 stated = 1e-3 * Vec3(table.number(row, "left_mm"), table.number(row, "up_mm"),
                                    table.number(row, "front_mm"));
    const Vec3 found = package.points.row(landmark.vertex);
    if ((found - stated).norm() > 1e-3)
      throw InputError(
          fmt::format("{}: landmark '{}' lies {:.1f} mm from where the table says; the body "
                      "package has another base mesh",
                      table.where(row), landmark.id, 1e3 * (found - stated).norm()));
    out.push_back(std::move(landmark));
  }
  return out;
}

class MeasureReader {
 public:
  MeasureReader(const BodyPackage& package, const Table& rows, MeasureTable& out)
      : package_(package), rows_(rows), out_(out) {}

  void read(int row) {
    static const std::map<std::string, MeasureKind> kinds{
        {"height", MeasureKind::height},     {"ahead", MeasureKind::ahead},
        {"distance", MeasureKind::distance}, {"path", MeasureKind::path},
        {"girth", MeasureKind::girth},       {"breadth", MeasureKind::breadth},
        {"depth", MeasureKind::depth},       {"sum", MeasureKind::sum},
        {"mass", MeasureKind::mass}};
    static const std::map<std::string, PlaneKind> planes{
        {"", PlaneKind::horizontal},   {"horizontal", PlaneKind::horizontal},
        {"across", PlaneKind::across}, {"midline", PlaneKind::midline},
        {"foot", PlaneKind::foot},     {"hand", PlaneKind::hand}};
    static const std::map<std::string, Search> searches{
        {"", Search::none}, {"max", Search::largest}, {"min", Search::smallest}};
    Measure m;
    m.id = rows_.text(row, "id");
    m.name = rows_.text(row, "name");
    m.standard = rows_.text(row, "standard");
    m.note = rows_.text(row, "note");
    m.kind = lookup(kinds, rows_, row, "kind");
    m.plane = lookup(planes, rows_, row, "plane");
    m.search = lookup(searches, rows_, row, "search");
    m.reach = 1e-3 * rows_.number_or(row, "reach_mm", 0);
    const std::string& hull = rows_.text(row, "hull");
    m.hull = hull.starts_with("yes");
    m.arms_off = hull.ends_with("armless");
    m.tolerance = (m.kind == MeasureKind::mass ? 1 : 1e-3) * rows_.number(row, "tolerance_mm");
    m.survey_field = rows_.text(row, "ansur");
    m.survey_shift = 1e-3 * rows_.number_or(row, "shift_mm", 0);
    m.survey_slack = (m.kind == MeasureKind::mass ? 1 : 1e-3) * rows_.number_or(row, "slack_mm", 0);
    std::istringstream words(rows_.text(row, "landmarks"));
    for (std::string word; words >> word;) read_word(row, word, m);
    check_count(row, m);
    out_.measures.push_back(std::move(m));
  }

 private:
  int vertex(int row, const std::string& id) const {
    for (const auto& landmark : out_.landmarks)
      if (landmark.id == id) return landmark.vertex;
    throw InputError(
        fmt::format("{}: unknown landmark '{}'; landmarks.csv lists them", rows_.where(row), id));
  }

  // "+waist_breadth", "-0.5*hip_breadth".
  void read_term(int row, const std::string& word, Measure& m) const {
    const bool negative = word[0] == '-';
    const auto star = word.find('*');
    double factor = 1;
    bool good = negative || word[0] == '+';
    if (star != std::string::npos) {
      const char *from = word.data() + 1, *to = word.data() + star;
      const auto [end, error] = std::from_chars(from, to, factor);
      good = good && error == std::errc() && end == to && std::isfinite(factor);
    }
    const auto known =
        out_.find(std::string_view(word).substr(star == std::string::npos ? 1 : star + 1));
    if (!good || !known)
      throw InputError(
          fmt::format("{}: '{}' is not + or -, perhaps a factor and *, and a measure "
                      "of an earlier row",
                      rows_.where(row), word));
    m.terms.push_back({*known, negative ? -factor : factor});
  }

  void read_word(int row, const std::string& word, Measure& m) const {
    if (m.kind == MeasureKind::sum) return read_term(row, word, m);
    const auto colon = word.find(':');
    const std::string prefix = colon == std::string::npos ? "" : word.substr(0, colon);
    const int found = vertex(row, colon == std::string::npos ? word : word.substr(colon + 1));
    if (prefix.empty())
      m.vertices.push_back(found);
    else if (prefix == "r")
      m.vertices.push_back(package_.mirror[found]);
    else if (prefix == "above" || prefix == "below")
      m.clip_vertex = found, m.clip_above = prefix == "above";
    else
      throw InputError(fmt::format("{}: '{}': expected r:, above: or below: before a landmark",
                                   rows_.where(row), word));
  }

  void check_count(int row, const Measure& m) const {
    std::size_t least = 1, most = 1;
    if (m.kind == MeasureKind::distance || m.kind == MeasureKind::ahead) least = most = 2;
    if (m.kind == MeasureKind::path) least = 2, most = 8;
    if (m.kind == MeasureKind::sum || m.kind == MeasureKind::mass) least = most = 0;
    if (m.kind == MeasureKind::girth || m.kind == MeasureKind::breadth ||
        m.kind == MeasureKind::depth) {
      if (m.plane == PlaneKind::midline || m.plane == PlaneKind::foot) least = most = 2;
      if (m.plane == PlaneKind::across || m.plane == PlaneKind::hand) least = most = 3;
    }
    if (m.vertices.size() < least || m.vertices.size() > most)
      throw InputError(fmt::format("{}: measure '{}' has {} landmarks, not {} .. {}",
                                   rows_.where(row), m.id, m.vertices.size(), least, most));
  }

  const BodyPackage& package_;
  const Table& rows_;
  MeasureTable& out_;
};

}  // namespace

std::optional<int> MeasureTable::find(std::string_view id) const {
  for (std::size_t k = 0; k < measures.size(); ++k)
    if (measures[k].id == id) return int(k);
  for (const MeasureName& other : other_names)
    if (other.name == id) return other.measure;
  return std::nullopt;
}

int MeasureTable::at(std::string_view id) const {
  if (const auto found = find(id)) return *found;
  std::vector<std::string> names;
  for (const Measure& m : measures) names.push_back(m.id);
  for (const MeasureName& other : other_names) names.push_back(other.name);
  throw UsageError(fmt::format("unknown measure '{}'{}\n`ecorche list measures` names all {}.",
                               printable(std::string(id)), did_you_mean(id, names),
                               measures.size()));
}

MeasureTable read_measure_table(const BodyPackage& package, const std::filesystem::path& folder) {
  MeasureTable out;
  out.landmarks = read_landmarks(package, folder / "landmarks.csv");
  const Table rows(folder / "measures.csv");
  MeasureReader reader(package, rows, out);
  for (int row = 0; row < rows.rows(); ++row) reader.read(row);
  const Table others(folder / "measure_names.csv");
  for (int row = 0; row < others.rows(); ++row)
    out.other_names.push_back({others.text(row, "name"), out.at(others.text(row, "measure"))});
  return out;
}

std::vector<std::pair<std::string, int>> landmark_vertices(const BodyPackage& package,
                                                           const MeasureTable& table) {
  std::vector<std::pair<std::string, int>> out;
  for (const SkinLandmark& landmark : table.landmarks) {
    const int other = package.mirror[landmark.vertex];
    if (other == landmark.vertex) {
      out.emplace_back(landmark.id, landmark.vertex);
    } else {
      out.emplace_back(landmark.id + "_l", landmark.vertex);
      out.emplace_back(landmark.id + "_r", other);
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
