#include "anatomy/mesh_files/ply_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/polygons.h"

namespace ecorche::inline v1 {
namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Scalar> scalar_of(std::string_view word) {
  if (word == "char" || word == "int8") return Scalar::int8;
  if (word == "uchar" || word == "uint8") return Scalar::uint8;
  if (word == "short" || word == "int16") return Scalar::int16;
  if (word == "ushort" || word == "uint16") return Scalar::uint16;
  if (word == "int" || word == "int32") return Scalar::int32;
  if (word == "uint" || word == "uint32") return Scalar::uint32;
  if (word == "float" || word == "float32") return Scalar::float32;
  if (word == "double" || word == "float64") return Scalar::float64;
  return std::nullopt;
}

std::size_t bytes_of(Scalar type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[std::size_t(type)];
}

struct Property {
  std::string name;
  Scalar type = Scalar::float32;
  bool is_list = false;
  Scalar count_type = Scalar::uint8;
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

enum class Coding { ascii, little, big };

struct Header {
  Coding coding = Coding::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes up to and with the line end_header
};

Property parse_property(TextScan& scan) {
  Property property;
  auto type = scan.word();
  property.is_list = type == "list";
  if (property.is_list) {
    const auto count_type = scalar_of(scan.word());
    if (!count_type || *count_type >= Scalar::float32)
      scan.fail("the count of a list must be of a whole type");
    property.count_type = *count_type;
    type = scan.word();
  }
  const auto known = scalar_of(type);
  if (!known) scan.fail("unknown property type; expected char .. double");
  property.type = *known;
  property.name = scan.word();
  return property;
}

Header parse_header(std::string_view bytes, const std::string& name) {
  Header header;
  const char end = bytes.starts_with("ply\r") && !bytes.starts_with("ply\r\n") ? '\r' : '\n';
  TextScan scan(bytes.substr(0, std::size_t{1} << 20), name, end);
  bool formatted = false;
  while (scan.next_line()) {
    const auto key = scan.word();
    if (key == "format") {
      const auto coding = scan.word();
      formatted = true;
      if (coding == "ascii")
        header.coding = Coding::ascii;
      else if (coding == "binary_little_endian")
        header.coding = Coding::little;
      else if (coding == "binary_big_endian")
        header.coding = Coding::big;
      else
        scan.fail("unknown format; expected ascii, binary_little_endian or binary_big_endian");
    } else if (key == "element") {
      Element element;
      element.name = printable(scan.word());
      element.count = scan.whole("element count", 0, INT64_MAX);
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) scan.fail("a property before any element");
      header.elements.back().properties.push_back(parse_property(scan));
    } else if (key == "end_header") {
      if (!formatted) scan.fail("the header has no format");
      header.size = scan.line().data() + scan.line().size() - bytes.data();
      while (header.size < bytes.size() && bytes[header.size] != end) ++header.size;
      header.size = std::min(header.size + 1, bytes.size());
      return header;
    } else if (key != "ply" && key != "comment" && key != "obj_info" && !key.empty()) {
      scan.fail("unknown statement in the header");
    }
  }
  throw InputError(fmt::format("{}: the header does not end", name));
}

// Values one after the other, from words or from bytes.
class Values {
 public:
  Values(std::string_view bytes, const Header& header, const std::string& name)
      : rest_(bytes.substr(header.size)),
        coding_(header.coding),
        scan_(coding_ == Coding::ascii ? rest_ : std::string_view(), name),
        name_(name) {}

  double next(Scalar type, const char* what) {
    return coding_ == Coding::ascii ? next_word(what) : next_binary(type, what);
  }

  // Whether `count` items of at least so many values and bytes can still be there.
  bool can_hold(long long count, std::size_t values, std::size_t bytes) const {
    const std::size_t least =
        std::max<std::size_t>(coding_ == Coding::ascii ? 2 * values : bytes, 1);
    return static_cast<unsigned long long>(count) <= (rest_.size() + 1) / least;
  }

 private:
  double next_word(const char* what) {
    while (scan_.at_line_end()) {
      if (!scan_.next_line())
        throw InputError(fmt::format("{}: ends before the last {}", name_, what));
    }
    return scan_.number(what);
  }

  double next_binary(Scalar type, const char* what) {
    const std::size_t size = bytes_of(type);
    if (rest_.size() - at_ < size)
      throw InputError(fmt::format("{}: ends before the last {}", name_, what));
    unsigned char raw[8] = {};
    const bool turn = (coding_ == Coding::big) == (std::endian::native == std::endian::little);
    for (std::size_t k = 0; k < size; ++k)
      raw[k] = static_cast<unsigned char>(rest_[at_ + (turn ? size - 1 - k : k)]);
    at_ += size;
    const auto as = [&](auto value) {
      std::memcpy(&value, raw, sizeof value);
      return double(value);
    };
    double value = 0;
    switch (type) {
      case Scalar::int8:
        value = as(std::int8_t{});
        break;
      case Scalar::uint8:
        value = as(std::uint8_t{});
        break;
      case Scalar::int16:
        value = as(std::int16_t{});
        break;
      case Scalar::uint16:
        value = as(std::uint16_t{});
        break;
      case Scalar::int32:
        value = as(std::int32_t{});
        break;
      case Scalar::uint32:
        value = as(std::uint32_t{});
        break;
      case Scalar::float32:
        value = as(float{});
        break;
      case Scalar::float64:
        value = as(double{});
        break;
    }
    return value;
  }

  std::string_view rest_;
  Coding coding_;
  std::size_t at_ = 0;
  TextScan scan_;
  std::string name_;
};

void read_vertex(const Element& element, long long row, Values& values, Polygons& out,
                 const std::string& name) {
  double xyz[3] = {0, 0, 0};
  for (const auto& property : element.properties) {
    const double value = values.next(property.type, "vertex");
    if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
      xyz[property.name[0] - 'x'] = value;
  }
  for (double v : xyz) {
    if (!std::isfinite(v)) throw InputError(fmt::format("{}: vertex {} is not finite", name, row));
  }
  out.coordinates.insert(out.coordinates.end(), xyz, xyz + 3);
}

// One row of an element with lists: the list named vertex_indices is a face; other values are read
// over.
void read_row_with_lists(const Element& element, long long row, Values& values, Polygons* faces,
                         const std::string& name) {
  for (const auto& property : element.properties) {
    if (!property.is_list) {
      values.next(property.type, element.name.c_str());
      continue;
    }
    const double count = values.next(property.count_type, "list length");
    if (!(count >= 0 && count == std::floor(count)) ||
        !values.can_hold(static_cast<long long>(count), 1, bytes_of(property.type))) {
      throw InputError(fmt::format("{}: {} {}: a list of {} does not fit into the file", name,
                                   element.name, row, count));
    }
    const bool is_face =
        faces != nullptr && (property.name == "vertex_indices" || property.name == "vertex_index");
    for (long long k = 0; k < static_cast<long long>(count); ++k) {
      const double index = values.next(property.type, "list entry");
      if (!is_face) continue;
      if (!(index >= 0 && index < double(faces->coordinates.size() / 3) &&
            index == std::floor(index))) {
        throw InputError(fmt::format("{}: face {} names vertex {} of {}", name, row, index,
                                     faces->coordinates.size() / 3));
      }
      faces->corners.push_back(int(index));
    }
    if (is_face && faces->corners.size() > limits::kMeshCorners)
      throw LimitError(
          fmt::format("{}: more than {} corners of faces", name, limits::kMeshCorners));
    if (is_face) faces->sizes.push_back(int(count));
  }
}

}  // namespace

void parse_ply(std::string_view bytes, const std::string& name, MeshFile& out) {
  const Header header = parse_header(bytes, name);
  Values values(bytes, header, name);
  Polygons polygons;
  for (const auto& element : header.elements) {
    std::size_t least = 0;
    bool has_lists = false;
    int coordinates = 0;
    for (const auto& property : element.properties) {
      least += bytes_of(property.is_list ? property.count_type : property.type);
      has_lists = has_lists || property.is_list;
      coordinates += property.name == "x" || property.name == "y" || property.name == "z";
    }
    if (!values.can_hold(element.count, element.properties.size(), least)) {
      throw InputError(
          fmt::format("{}: the header promises {} of element '{}', more than the file can hold",
                      name, element.count, printable(element.name)));
    }
    if (element.count > limits::kMeshElements)
      throw LimitError(fmt::format("{}: {} of an element; the limit is {}", name, element.count,
                                   limits::kMeshElements));
    if (element.count > 0 && element.properties.empty())
      throw InputError(fmt::format("{}: an element without properties", name));
    const bool is_vertex = element.name == "vertex";
    if (is_vertex && (coordinates != 3 || has_lists || !polygons.coordinates.empty())) {
      throw InputError(
          fmt::format("{}: the vertex element must come once, with x, y, z and no lists", name));
    }
    for (long long row = 0; row < element.count; ++row) {
      if (is_vertex)
        read_vertex(element, row, values, polygons, name);
      else
        read_row_with_lists(element, row, values, element.name == "face" ? &polygons : nullptr,
                            name);
    }
  }
  out.parts.push_back({"", triangulate(polygons, name, out.notes)});
}

}  // namespace ecorche::inline v1
