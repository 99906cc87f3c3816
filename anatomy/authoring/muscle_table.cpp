#include "anatomy/authoring/muscle_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>

#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kMillilitre = 1e-6;
constexpr double kFar = 5e3;          // mm; no coordinate of a body is larger
constexpr std::size_t kMaxPath = 32;  // as many as posing takes
constexpr std::size_t kMaxStrips = 64;
constexpr std::size_t kMaxIntersections = 8;
constexpr std::size_t kMaxFileBytes = 4u << 20;
constexpr double kMinLineLength = 2e-3;  // m, shortest line from origin to insertion

// Source frame from millimetres left of the mid-plane, up, forward.
Vec3 from_file(double left, double up, double front) {
  return Vec3(left * kMillimetre + kSourceMidPlane, up * kMillimetre, front * kMillimetre);
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// One pass over a muscle file. Each keyword has one reader; a muscle is checked when it ends.
class MuscleReader {
 public:
  MuscleReader(std::string_view text, const std::string& name, MuscleTable& table)
      : scan_(text, name), name_(name), table_(table) {
    for (std::size_t i = 0; i < table.landmarks.size(); ++i)
      landmarks_.emplace(table.landmarks[i].id, int(i));
    for (std::size_t i = 0; i < table.wraps.size(); ++i)
      wraps_.emplace(table.wraps[i].name, int(i));
    for (const TableMuscle& muscle : table.muscles) names_.emplace(muscle.name, 0);
  }

  void read() {
    while (scan_.next_line()) {
      const std::string_view keyword = scan_.word();
      if (keyword.empty() || keyword.starts_with('#')) continue;
      if (keyword == "carrier")
        read_carrier();
      else if (keyword == "wrap")
        read_wrap();
      else if (keyword == "muscle")
        begin_muscle();
      else if (!muscle_)
        fail(fmt::format("'{}' outside a muscle; expected muscle, wrap or carrier", keyword));
      else if (keyword == "strip")
        begin_strip();
      else if (in_strip_)
        read_strip_line(keyword);
      else
        read_muscle_line(keyword);
    }
    end_muscle();
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    scan_.fail(muscle_ ? fmt::format("{}: {}", muscle_->name, message) : message);
  }

  std::string where() const { return fmt::format("{}:{}", name_, scan_.line_number()); }

  // The rest of the line as prose.
  std::string words(std::string_view keyword) {
    const std::string_view line = scan_.line();
    const std::string_view rest = trimmed(line.substr(line.find(keyword) + keyword.size()));
    if (rest.empty()) fail(fmt::format("'{}' needs some words", keyword));
    return std::string(rest);
  }

  std::string name_word(std::string_view what) {
    const std::string_view word = scan_.word();
    if (word.empty() || word.starts_with('#')) fail(fmt::format("{} is missing", what));
    return std::string(word);
  }

  double number(std::string_view what, double low, double high) {
    const std::string_view word = scan_.word();
    double value = 0;
    if (word.empty() || word.starts_with('#')) fail(fmt::format("{} is missing", what));
    if (!parse_number(word, value))
      fail(fmt::format("{}: '{}' is not a finite number", what, word));
    if (value < low || value > high)
      fail(fmt::format("{}: {} is not within {} .. {}", what, value, low, high));
    return value;
  }

  void end_of_line() {
    const std::string_view word = scan_.word();
    if (!word.empty() && !word.starts_with('#'))
      fail(fmt::format("unexpected '{}' at the end of the line", word));
  }

  void expect(std::string_view keyword) {
    const std::string word = name_word(keyword);
    if (word != keyword) fail(fmt::format("expected '{}', found '{}'", keyword, word));
  }

  int landmark_word() {
    const std::string id = name_word("a landmark");
    const auto found = landmarks_.find(id);
    if (found == landmarks_.end())
      fail(fmt::format("unknown landmark '{}'; data/landmarks lists them", id));
    return found->second;
  }

  Vec3 vector(std::string_view what, double limit) {
    const double x = number(what, -limit, limit), y = number(what, -limit, limit);
    return Vec3(x, y, number(what, -limit, limit));
  }

  Vec3 optional_offset() {
    TextScan probe = scan_;
    const std::string_view next = probe.word();
    if (next.empty() || next.starts_with('#') || next == "with") return Vec3::Zero();
    return vector("offset", kFar) * kMillimetre;
  }

  // Of `with CARRIER`, which may be left away.
  std::string optional_carrier() {
    TextScan probe = scan_;
    if (probe.word() != "with") return {};
    scan_ = probe;
    const std::string name = name_word("a carrier");
    if (std::ranges::none_of(table_.carriers,
                             [&](const JointBlend& soft) { return soft.name == name; }))
      fail(fmt::format("unknown carrier '{}'; carriers.txt lists them", name));
    return name;
  }

  void read_carrier() {
    end_muscle();
    JointBlend carrier;
    carrier.where = where();
    carrier.name = name_word("the carrier's name");
    for (const JointBlend& other : table_.carriers)
      if (other.name == carrier.name)
        fail(fmt::format("carrier '{}' is given twice", carrier.name));
    expect("between");
    carrier.joints[0] = name_word("a joint");
    carrier.joints[1] = name_word("a joint");
    const std::string mode = name_word("'share' or 'heights'");
    if (mode == "share") {
      carrier.share = number("share", 0, 1);
    } else if (mode == "heights") {
      carrier.high = number("height", 0, kFar) * kMillimetre;
      carrier.low = number("height", 0, kFar) * kMillimetre;
      if (carrier.high <= carrier.low) fail("the first height must be the higher one");
    } else {
      fail(fmt::format("expected 'share' or 'heights', found '{}'", mode));
    }
    end_of_line();
    table_.carriers.push_back(carrier);
  }

  void read_wrap() {
    end_muscle();
    TableWrap wrap;
    wrap.where = where();
    wrap.name = name_word("the wrap's name");
    if (wraps_.contains(wrap.name)) fail(fmt::format("wrap '{}' is given twice", wrap.name));
    const std::string kind = name_word("sphere, cylinder or ellipsoid");
    expect("at");
    wrap.landmark = landmark_word();
    wrap.offset = vector("offset", kFar) * kMillimetre;
    if (kind == "ellipsoid") {
      wrap.kind = Wrap::Kind::ellipsoid;
      expect("axes");
      for (double& radius : wrap.radii) radius = number("semi axis", 0.1, 1e3) * kMillimetre;
    } else if (kind == "sphere" || kind == "cylinder") {
      expect("radius");
      wrap.radii.setConstant(number("radius", 0.1, 1e3) * kMillimetre);
      if (kind == "cylinder") {
        wrap.kind = Wrap::Kind::cylinder;
        expect("half");
        wrap.radii.z() = number("half length", 0.1, 1e3) * kMillimetre;
        expect("axis");
        wrap.axis = vector("axis", 1e3);
        if (wrap.axis.norm() < 1e-3) fail("the cylinder's axis has no length");
        wrap.axis.normalize();
      }
    } else {
      fail(fmt::format("unknown kind '{}'; expected sphere, cylinder or ellipsoid", kind));
    }
    end_of_line();
    wraps_.emplace(wrap.name, int(table_.wraps.size()));
    table_.wraps.push_back(wrap);
  }

  void begin_muscle() {
    end_muscle();
    table_.muscles.emplace_back();
    muscle_ = &table_.muscles.back();
    muscle_->where = where();
    muscle_->name = name_word("the muscle's name");
    if (!names_.emplace(muscle_->name, 0).second) fail("the muscle is given twice");
    end_of_line();
  }

  void read_muscle_line(std::string_view keyword) {
    TableMuscle& m = *muscle_;
    if (keyword == "label")
      m.label = words(keyword);
    else if (keyword == "group")
      m.group = words(keyword);
    else if (keyword == "layer")
      m.layer = words(keyword);
    else if (keyword == "shape")
      m.shape = words(keyword);
    else if (keyword == "from")
      m.origin = words(keyword);
    else if (keyword == "to")
      m.insertion = words(keyword);
    else if (keyword == "action")
      m.action = words(keyword);
    else if (keyword == "source")
      m.sources.push_back(words(keyword));
    else if (keyword == "note")
      m.note = words(keyword);
    else if (keyword == "compare")
      read_compare(m);
    else if (keyword == "sheet")
      m.sheet = true;
    else if (keyword == "volume") {
      m.volume_male = number("male volume in ml", 0.01, 5e3) * kMillilitre;
      m.volume_female = number("female volume in ml", 0.01, 5e3) * kMillilitre;
      end_of_line();
    } else if (keyword == "fibre") {
      m.fibre_length = number("fibre length in cm", 0.1, 100) * 1e-2;
      end_of_line();
    } else if (keyword == "pennation") {
      m.pennation = number("pennation in degrees", 0, 89) * std::numbers::pi / 180;
      end_of_line();
    } else if (keyword == "tendon") {
      m.tendon_fraction = number("tendon fraction", 0, 0.99);
      end_of_line();
    } else if (keyword == "force") {
      m.max_force = number("isometric force in N", 0.1, 1e5);
      end_of_line();
    } else if (keyword == "tense") {
      m.tense_thickness = number("thickness at full effort over the relaxed", 0.5, 3);
      end_of_line();
    } else {
      fail(fmt::format("unknown keyword '{}'", keyword));
    }
  }

  void read_compare(TableMuscle& m) {
    for (std::string_view word = scan_.word(); !word.empty() && !word.starts_with('#');
         word = scan_.word())
      m.compare.emplace_back(word);
    if (m.compare.empty()) fail("'compare' needs names of paths");
  }

  void begin_strip() {
    end_strip();
    if (muscle_->strips.size() >= kMaxStrips) fail(fmt::format("more than {} strips", kMaxStrips));
    muscle_->strips.emplace_back();
    muscle_->strips.back().where = where();
    in_strip_ = true;
    end_of_line();
  }

  void read_strip_line(std::string_view keyword) {
    TableStrip& strip = muscle_->strips.back();
    if (keyword == "origin" || keyword == "via" || keyword == "insertion") {
      read_point(strip, keyword);
    } else if (keyword == "over") {
      const std::string name = name_word("a wrap");
      const auto found = wraps_.find(name);
      if (found == wraps_.end()) fail(fmt::format("unknown wrap '{}'; wraps.txt lists them", name));
      const std::string_view word = scan_.word();
      double radius = 0;
      if (!word.empty() && !word.starts_with('#') &&
          (!parse_number(word, radius) || radius < 0.1 || radius > 1e3))
        fail(fmt::format("wrap '{}': '{}' is not a radius in mm", name, word));
      strip.wraps.push_back({found->second, radius * kMillimetre});
    } else if (keyword == "belly") {
      strip.belly_begin = number("begin of the belly", 0, 1);
      strip.belly_end = number("end of the belly", 0, 1);
      if (strip.belly_begin >= strip.belly_end) fail("the belly ends before it begins");
      end_of_line();
    } else if (keyword == "intersection") {
      read_intersection(strip);
    } else if (keyword == "raphe") {
      strip.raphe = number("width of the raphe", 0, 0.5);
      end_of_line();
    } else if (keyword == "section") {
      read_section(strip);
    } else {
      fail(fmt::format("unknown keyword '{}' in a strip", keyword));
    }
  }

  void read_point(TableStrip& strip, std::string_view keyword) {
    const bool first = strip.path.empty();
    if (first != (keyword == "origin"))
      fail(first ? "the path must begin with an origin"
                 : "a path has one origin, at its beginning");
    if (closed_) fail("a point after the insertion");
    if (strip.path.size() >= kMaxPath) fail(fmt::format("more than {} path points", kMaxPath));
    TablePoint point;
    point.landmark = landmark_word();
    point.offset = optional_offset();
    if (keyword == "via") point.glides = optional_carrier();
    end_of_line();
    if (!first && (position(table_, point) - position(table_, strip.path.back())).norm() < 1e-4)
      fail(fmt::format("the {} lies on the point before it", keyword));
    strip.path.push_back(point);
    closed_ = keyword == "insertion";
  }

  void read_intersection(TableStrip& strip) {
    std::vector<double>& places = strip.intersections;
    if (places.size() >= kMaxIntersections)
      fail(fmt::format("more than {} intersections", kMaxIntersections));
    places.push_back(number("place of the intersection", 0, 1));
    end_of_line();
    if (places.size() > 1 && places.back() <= places[places.size() - 2])
      fail(fmt::format("intersection at {}: they rise along the strip", places.back()));
  }

  void read_section(TableStrip& strip) {
    TableSection section;
    section.s = number("place of the section", 0, 1);
    section.radii.x() = number("width in mm", 0.1, 500) * kMillimetre / 2;
    section.radii.y() = number("thickness in mm", 0.1, 500) * kMillimetre / 2;
    section.width = vector("width direction", 1e3);
    if (section.width.norm() < 1e-3) fail("the width direction has no length");
    section.width.normalize();
    end_of_line();
    if (strip.sections.empty() ? section.s != 0 : section.s <= strip.sections.back().s)
      fail(fmt::format("section at {}: sections rise from 0 to 1", section.s));
    strip.sections.push_back(section);
  }

  void end_strip() {
    if (!in_strip_) return;
    const TableStrip& strip = muscle_->strips.back();
    if (strip.path.size() < 2 || !closed_)
      fail(fmt::format("a strip with {} path point(s) and {} insertion", strip.path.size(),
                       closed_ ? "an" : "no"));
    if ((position(table_, strip.path.front()) - position(table_, strip.path.back())).norm() <
        kMinLineLength)
      fail("the origin is the insertion");
    if (strip.sections.size() < 2 || strip.sections.back().s != 1)
      fail("a strip needs sections from 0 to 1");
    for (const double place : strip.intersections)
      if (place <= strip.belly_begin || place >= strip.belly_end)
        fail(fmt::format("intersection at {}: it lies within the belly", place));
    in_strip_ = closed_ = false;
  }

  void end_muscle() {
    if (!muscle_) return;
    end_strip();
    const TableMuscle& m = *muscle_;
    if (m.strips.empty()) fail("no strip");
    if (m.volume_male <= 0) fail("no volume");
    if (m.fibre_length <= 0) fail("no fibre length");
    for (const auto& [key, value] : {std::pair<const char*, const std::string&>{"label", m.label},
                                     {"group", m.group},
                                     {"layer", m.layer},
                                     {"from", m.origin},
                                     {"to", m.insertion}})
      if (value.empty()) fail(fmt::format("no '{}'", key));
    muscle_ = nullptr;
  }

  TextScan scan_;
  std::string name_;
  MuscleTable& table_;
  std::unordered_map<std::string, int> landmarks_, wraps_, names_;
  TableMuscle* muscle_ = nullptr;
  bool in_strip_ = false;
  bool closed_ = false;  // the strip has its insertion
};

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder,
                                            const char* extension) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  if (error) throw InputError(fmt::format("{}: {}", folder.string(), error.message()));
  if (files.empty()) throw InputError(fmt::format("{}: no {} files", folder.string(), extension));
  std::sort(files.begin(), files.end());
  return files;
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file.string()));
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  if (error || bytes > kMaxFileBytes)
    throw LimitError(fmt::format("{}: larger than {} bytes", file.string(), kMaxFileBytes));
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace

int find_landmark(const MuscleTable& table, std::string_view id) {
  for (std::size_t i = 0; i < table.landmarks.size(); ++i)
    if (table.landmarks[i].id == id) return int(i);
  return -1;
}

Vec3 position(const MuscleTable& table, const TablePoint& point) {
  return table.landmarks[point.landmark].position + point.offset;
}

void read_landmark_text(std::string_view text, const std::string& name, MuscleTable& table) {
  std::unordered_map<std::string, int> known;
  for (const SourceLandmark& landmark : table.landmarks) known.emplace(landmark.id, 0);
  const Table rows(text, name);
  for (int i = 0; i < rows.rows(); ++i) {
    SourceLandmark landmark;
    landmark.id = rows.text(i, "id");
    landmark.carrier = rows.text(i, "bone");
    landmark.rule = rows.text(i, "rule");
    landmark.where = rows.where(i);
    if (landmark.id.empty() || landmark.carrier.empty())
      throw InputError(fmt::format("{}: a landmark needs an id and a bone", rows.where(i)));
    if (!known.emplace(landmark.id, 0).second)
      throw InputError(fmt::format("{}: landmark '{}' is given twice", rows.where(i), landmark.id));
    const Vec3 mm(rows.number(i, "left_mm"), rows.number(i, "up_mm"), rows.number(i, "front_mm"));
    if (mm.cwiseAbs().maxCoeff() > kFar)
      throw InputError(fmt::format("{}: landmark '{}' lies {} mm away", rows.where(i), landmark.id,
                                   mm.cwiseAbs().maxCoeff()));
    landmark.position = from_file(mm.x(), mm.y(), mm.z());
    table.landmarks.push_back(std::move(landmark));
  }
}

void read_muscle_text(std::string_view text, const std::string& name, MuscleTable& table) {
  MuscleReader(text, name, table).read();
}

MuscleTable read_muscle_table(const std::filesystem::path& data_dir) {
  MuscleTable table;
  for (const auto& file : files_in(data_dir / "landmarks", ".csv"))
    read_landmark_text(read_file(file), file.filename().string(), table);
  // Carriers and wraps first: the muscles refer to them.
  const auto first = {data_dir / "muscles" / "carriers.txt", data_dir / "muscles" / "wraps.txt"};
  for (const auto& file : first) read_muscle_text(read_file(file), file.filename().string(), table);
  for (const auto& file : files_in(data_dir / "muscles", ".txt"))
    if (std::find(first.begin(), first.end(), file) == first.end())
      read_muscle_text(read_file(file), file.filename().string(), table);
  return table;
}

}  // namespace ecorche::inline v1
