#include "anatomy/mesh_files/pcd_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/vertex_values.h"

namespace ecorche::inline v1 {
namespace {

enum class FieldRole { none, x, y, z, normal_x, normal_y, normal_z, colour, confidence };

FieldRole field_role(std::string_view field) {
  constexpr std::pair<std::string_view, FieldRole> kFieldRoles[] = {
      {"x", FieldRole::x},
      {"y", FieldRole::y},
      {"z", FieldRole::z},
      {"normal_x", FieldRole::normal_x},
      {"normal_y", FieldRole::normal_y},
      {"normal_z", FieldRole::normal_z},
      {"nx", FieldRole::normal_x},
      {"ny", FieldRole::normal_y},
      {"nz", FieldRole::normal_z},
      {"rgb", FieldRole::colour},
      {"rgba", FieldRole::colour},
      {"confidence", FieldRole::confidence}};
  for (const auto& [name, role] : kFieldRoles)
    if (field == name) return role;
  return FieldRole::none;
}

struct Field {
  std::string name;
  FieldRole role = FieldRole::none;
  std::size_t bytes = 4, count = 1;
  char type = 'F';
  std::size_t offset = 0;  // in a point, or times the points in a compressed file
};

enum class PcdCoding { ascii, binary, compressed };

struct PcdHeader {
  std::vector<Field> fields;
  std::size_t width = 0, height = 1, points = 0, point_bytes = 0, size = 0;
  PcdCoding coding = PcdCoding::ascii;
};

// The header's lines in the order of the format; those of one value per field follow FIELDS.
class PcdHeaderReader {
 public:
  PcdHeaderReader(std::string_view bytes, const std::string& name)
      : bytes_(bytes), name_(name), scan_(bytes.substr(0, std::size_t{1} << 20), name, '\n') {}

  PcdHeader read() {
    bool ends = false;
    while (!ends && scan_.next_line()) {
      const std::string_view key = scan_.word();
      if (!key.empty() && key.front() != '#') ends = statement(key);
    }
    if (!ends) throw InputError(name_ + ": the header does not end with DATA");
    out_.size = std::min(bytes_.size(),
                         std::size_t(scan_.line().data() + scan_.line().size() - bytes_.data()));
    while (out_.size < bytes_.size() && bytes_[out_.size] != '\n') ++out_.size;
    out_.size = std::min(out_.size + 1, bytes_.size());
    check();
    return std::move(out_);
  }

 private:
  bool statement(std::string_view key) {
    if (key == "FIELDS" || key == "COLUMNS") {
      for (auto word = scan_.word(); !word.empty(); word = scan_.word()) {
        if (out_.fields.size() == 256) scan_.fail("more than 256 fields");
        out_.fields.push_back({printable(word), field_role(word)});
      }
    } else if (key == "SIZE") {
      for (Field& field : out_.fields) field.bytes = std::size_t(scan_.whole("size", 1, 8));
    } else if (key == "TYPE") {
      for (Field& field : out_.fields) {
        const std::string_view type = scan_.word();
        if (type != "F" && type != "I" && type != "U") scan_.fail("a type is none of F, I and U");
        field.type = type.front();
      }
    } else if (key == "COUNT") {
      for (Field& field : out_.fields) field.count = std::size_t(scan_.whole("count", 0, 65536));
    } else if (key == "WIDTH") {
      out_.width = std::size_t(scan_.whole("width", 0, INT64_MAX));
    } else if (key == "HEIGHT") {
      out_.height = std::size_t(scan_.whole("height", 0, INT64_MAX));
    } else if (key == "POINTS") {
      points_ = std::size_t(scan_.whole("count of points", 0, INT64_MAX));
    } else if (key == "DATA") {
      const std::string_view coding = scan_.word();
      if (coding != "ascii" && coding != "binary" && coding != "binary_compressed")
        scan_.fail("unknown coding; expected ascii, binary or binary_compressed");
      out_.coding = coding == "ascii"    ? PcdCoding::ascii
                    : coding == "binary" ? PcdCoding::binary
                                         : PcdCoding::compressed;
      return true;
    } else if (key != "VERSION" && key != "VIEWPOINT") {
      scan_.fail(fmt::format("unknown statement '{}'", printable(key.substr(0, 40))));
    }
    return false;
  }

  void check() {
    const std::size_t most = std::size_t(limits::kMeshElements);
    for (const std::size_t count : {out_.width, out_.height, points_.value_or(0)})
      if (count > most)
        throw LimitError(
            fmt::format("{}: {} points; the limit is {}", name_, count, limits::kMeshElements));
    out_.points = out_.width * out_.height;
    if (points_ && *points_ != out_.points)
      throw InputError(fmt::format("{}: {} points, but width {} times height {}", name_, *points_,
                                   out_.width, out_.height));
    if (out_.points > most)
      throw LimitError(
          fmt::format("{}: {} points; the limit is {}", name_, out_.points, limits::kMeshElements));
    for (Field& field : out_.fields) {
      const bool fits = field.type == 'F' ? field.bytes == 4 || field.bytes == 8
                                          : field.bytes == 1 || field.bytes == 2 ||
                                                field.bytes == 4 || field.bytes == 8;
      if (!fits)
        throw InputError(fmt::format("{}: field '{}': type {} of {} bytes", name_, field.name,
                                     field.type, field.bytes));
      if (field.role != FieldRole::none && field.count != 1)
        throw InputError(
            fmt::format("{}: field '{}': {} values a point", name_, field.name, field.count));
      if (field.role == FieldRole::colour && field.bytes != 4) field.role = FieldRole::none;
      field.offset = out_.point_bytes;
      out_.point_bytes += field.bytes * field.count;
    }
    for (const FieldRole axis : {FieldRole::x, FieldRole::y, FieldRole::z})
      if (std::ranges::count(out_.fields, axis, &Field::role) != 1)
        throw InputError(name_ + ": the fields must have x, y and z once each");
  }

  std::string_view bytes_;
  std::string name_;
  TextScan scan_;
  PcdHeader out_;
  std::optional<std::size_t> points_;
};

double binary_value(const char* at, char type, std::size_t bytes) {
  const auto as = [&](auto value) {
    std::memcpy(&value, at, sizeof value);
    return double(value);
  };
  if (type == 'F') return bytes == 4 ? as(float{}) : as(double{});
  const bool sign = type == 'I';
  switch (bytes) {
    case 1:
      return sign ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return sign ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return sign ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return sign ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

// A point's values by role; a colour is 0xAARRGGBB.
struct PcdPoint {
  double values[9] = {};
  std::uint32_t colour = 0;

  double& of(FieldRole role) { return values[std::size_t(role)]; }
};

class PcdPoints {
 public:
  explicit PcdPoints(const PcdHeader& header) {
    for (const Field& field : header.fields) has_[std::size_t(field.role)] = true;
  }

  void add(PcdPoint& point) {
    const double x = point.of(FieldRole::x), y = point.of(FieldRole::y), z = point.of(FieldRole::z);
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
      ++dropped_;
      return;
    }
    places_.insert(places_.end(), {x, y, z});
    if (has(FieldRole::normal_x) && has(FieldRole::normal_y) && has(FieldRole::normal_z)) {
      double n[3] = {point.of(FieldRole::normal_x), point.of(FieldRole::normal_y),
                     point.of(FieldRole::normal_z)};
      if (!std::isfinite(n[0]) || !std::isfinite(n[1]) || !std::isfinite(n[2]))
        n[0] = n[1] = n[2] = 0;
      normals_.insert(normals_.end(), n, n + 3);
    }
    if (has(FieldRole::colour))
      for (const int shift : {16, 8, 0})
        colours_.push_back(float(point.colour >> shift & 0xFF) / 255);
    if (has(FieldRole::confidence)) {
      const double value = point.of(FieldRole::confidence);
      confidence_.push_back(std::isfinite(value) ? float(value) : 0);
    }
  }

  MeshPart part(const std::string& name, std::vector<std::string>& notes) const {
    MeshPart out;
    const Eigen::Index count = Eigen::Index(places_.size() / 3);
    if (count == 0)
      throw UnfitError(fmt::format("{}: none of its {} points is finite", name, dropped_));
    if (dropped_ > 0)
      notes.push_back(fmt::format("{}: left out {} points that are not finite", name, dropped_));
    out.mesh.V = Eigen::Map<const Points>(places_.data(), count, 3);
    out.mesh.F.resize(0, 3);
    if (!normals_.empty()) out.normals = unit_normals(normals_);
    out.colours = Eigen::Map<const Colours>(colours_.data(), Eigen::Index(colours_.size() / 3), 3);
    out.confidence =
        Eigen::Map<const Eigen::VectorXf>(confidence_.data(), Eigen::Index(confidence_.size()));
    return out;
  }

 private:
  bool has(FieldRole role) const { return has_[std::size_t(role)]; }

  bool has_[9] = {};
  std::vector<double> places_, normals_;
  std::vector<float> colours_, confidence_;
  std::size_t dropped_ = 0;
};

// `nan` in all spellings, and numbers beyond a double's range, are what is not finite.
double ascii_value(TextScan& scan, std::string_view word, const Field& field) {
  double value = 0;
  if (parse_number(word, value)) return value;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument)
    scan.fail(
        fmt::format("field '{}': '{}' is not a number", field.name, printable(word.substr(0, 40))));
  return NAN;
}

void read_ascii(std::string_view text, const std::string& name, const PcdHeader& header,
                PcdPoints& out) {
  TextScan scan(text, name, '\n');
  for (std::size_t i = 0; i < header.points; ++i) {
    std::string_view first;
    while (first.empty()) {
      if (!scan.next_line())
        throw InputError(fmt::format("{}: ends before the last of {} points", name, header.points));
      first = scan.word();
    }
    PcdPoint point;
    for (const Field& field : header.fields)
      for (std::size_t k = 0; k < field.count; ++k) {
        const std::string_view word = first.empty() ? scan.word() : first;
        first = {};
        if (word.empty()) scan.fail(fmt::format("field '{}' is missing", field.name));
        const double value = ascii_value(scan, word, field);
        if (field.role == FieldRole::none) continue;
        point.of(field.role) = value;
        if (field.role != FieldRole::colour) continue;
        const float packed = float(value);
        if (field.type == 'F')
          std::memcpy(&point.colour, &packed, 4);
        else if (value >= 0 && value <= UINT32_MAX)
          point.colour = std::uint32_t(value);
      }
    out.add(point);
  }
}

// `step`: from a point's value to the next point's; `start`: of a field's first value.
template <class Start, class Step>
void read_binary(std::string_view bytes, const PcdHeader& header, Start start, Step step,
                 PcdPoints& out) {
  for (std::size_t i = 0; i < header.points; ++i) {
    PcdPoint point;
    for (const Field& field : header.fields) {
      if (field.role == FieldRole::none) continue;
      const char* const at = bytes.data() + start(field) + i * step(field);
      point.of(field.role) = binary_value(at, field.type, field.bytes);
      if (field.role == FieldRole::colour) std::memcpy(&point.colour, at, 4);
    }
    out.add(point);
  }
}

std::string unpacked_points(std::string_view bytes, const std::string& name,
                            const PcdHeader& header) {
  std::uint32_t sizes[2] = {0, 0};
  if (bytes.size() < sizeof sizes)
    throw InputError(name + ": ends before the sizes of its compressed data");
  std::memcpy(sizes, bytes.data(), sizeof sizes);
  if (sizes[0] > bytes.size() - sizeof sizes)
    throw InputError(fmt::format("{}: {} compressed bytes promised, {} are there", name, sizes[0],
                                 bytes.size() - sizeof sizes));
  if (sizes[1] != header.points * header.point_bytes)
    throw InputError(fmt::format("{}: {} bytes uncompressed, but {} points of {} bytes", name,
                                 sizes[1], header.points, header.point_bytes));
  return lzf_unpacked(bytes.substr(sizeof sizes, sizes[0]), sizes[1], name);
}

}  // namespace

bool is_pcd(std::string_view head) {
  return head.starts_with("# .PCD") || head.starts_with("#.PCD") ||
         (head.starts_with("VERSION ") && head.find("\nFIELDS ") != std::string_view::npos);
}

std::string lzf_unpacked(std::string_view packed, std::size_t size, const std::string& name) {
  const auto fail = [&](const char* what) {
    throw InputError(fmt::format("{}: its compressed data {}", name, what));
  };
  // Three bytes give 264 at most.
  if (size / 88 > packed.size()) fail("cannot hold what is promised");
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto next = [&]() -> std::size_t {
    if (at == packed.size()) fail("ends within a run");
    return static_cast<unsigned char>(packed[at++]);
  };
  while (at < packed.size()) {
    const std::size_t control = next();
    if (control < 32) {
      if (control + 1 > packed.size() - at) fail("ends within a run");
      if (control + 1 > size - out.size()) fail("holds more than is promised");
      out.append(packed, at, control + 1);
      at += control + 1;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) length += next();
    length += 2;
    const std::size_t back = ((control & 31) << 8) + next() + 1;
    if (back > out.size()) fail("refers to before its beginning");
    if (length > size - out.size()) fail("holds more than is promised");
    const std::size_t from = out.size() - back;
    for (std::size_t k = 0; k < length; ++k) out += out[from + k];
  }
  if (out.size() != size) fail("holds less than is promised");
  return out;
}

void parse_pcd(std::string_view bytes, const std::string& name, const MeshReadOptions& options,
               MeshFile& out) {
  const PcdHeader header = PcdHeaderReader(bytes, name).read();
  const std::string_view data = bytes.substr(header.size);
  PcdPoints points(header);
  if (header.coding == PcdCoding::ascii) {
    read_ascii(data, name, header, points);
  } else if (header.coding == PcdCoding::binary) {
    if (data.size() / header.point_bytes < header.points)
      throw InputError(fmt::format("{}: {} points of {} bytes promised, {} bytes are there", name,
                                   header.points, header.point_bytes, data.size()));
    read_binary(
        data, header, [](const Field& field) { return field.offset; },
        [&](const Field&) { return header.point_bytes; }, points);
  } else {
    const std::string unpacked = unpacked_points(data, name, header);
    read_binary(
        unpacked, header, [&](const Field& field) { return field.offset * header.points; },
        [](const Field& field) { return field.bytes * field.count; }, points);
  }
  MeshPart part = points.part(name, out.notes);
  if (!options.clouds)
    throw UnfitError(
        fmt::format("{}: {} points but no faces; a surface is needed", name, part.mesh.V.rows()));
  out.parts.push_back(std::move(part));
}

}  // namespace ecorche::inline v1
