#include "anatomy/mesh_files/off_reader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/polygons.h"
#include "anatomy/mesh_files/vertex_values.h"

namespace ecorche::inline v1 {
namespace {

// What the keyword says of vertices.
struct OffKind {
  bool texture = false, colours = false, normals = false;
  bool four = false;  // coordinates, or as many as the file says
  bool is_known = false;
};

OffKind off_kind(std::string_view word) {
  OffKind out;
  const auto take = [&](std::string_view mark) {
    const bool found = word.starts_with(mark);
    if (found) word.remove_prefix(mark.size());
    return found;
  };
  out.texture = take("ST");
  out.colours = take("C");
  out.normals = take("N");
  out.four = take("4");
  out.four = take("n") || out.four;
  out.is_known = word == "OFF";
  return out;
}

class OffFile {
 public:
  OffFile(std::string_view text, const std::string& name)
      : scan_(text, name), name_(name), size_(text.size()) {}

  void read(const MeshReadOptions& options, MeshFile& out) {
    read_header();
    polygons_.coordinates.reserve(3 * vertices_);
    for (std::size_t i = 0; i < vertices_; ++i) read_vertex();
    for (std::size_t f = 0; f < faces_; ++f) read_face(f);
    MeshPart part;
    part.mesh = triangulate(polygons_, name_, out.notes, options.clouds);
    if (normals_.size() == 3 * vertices_) part.normals = unit_normals(normals_);
    if (colours_.size() == 3 * vertices_) part.colours = colours_in_range(colours_);
    if (uv_.size() == 2 * vertices_) part.texture = corner_texture(uv_, part.mesh.F);
    out.parts.push_back(std::move(part));
  }

 private:
  // The next word; comments run to the end of their line.
  std::string_view word(const char* what) {
    for (;;) {
      const std::string_view found = scan_.word();
      if (!found.empty() && found.front() != '#') return found;
      if (!scan_.next_line())
        throw InputError(fmt::format("{}: ends before the last {}", name_, what));
    }
  }
  // Whether the line goes on.
  std::string_view more() {
    const std::string_view found = scan_.word();
    return found.empty() || found.front() == '#' ? std::string_view() : found;
  }
  double number(const char* what) {
    double value = 0;
    const std::string_view found = word(what);
    if (!parse_number(found, value))
      scan_.fail(
          fmt::format("{} '{}' is not a finite number", what, printable(found.substr(0, 40))));
    return value;
  }
  long long whole(const char* what) {
    long long value = 0;
    const std::string_view found = word(what);
    if (!parse_whole(found, value) || value < 0)
      scan_.fail(
          fmt::format("{} '{}' is not a whole number >= 0", what, printable(found.substr(0, 40))));
    return value;
  }

  void read_header() {
    kind_ = off_kind(word("header"));
    if (kind_.four)
      throw UnfitError(name_ + ": OFF in more than three dimensions; save it as plain OFF");
    std::string_view first = word("count");
    if (first == "BINARY") throw UnfitError(name_ + ": binary OFF is not read; save it as text");
    long long counts[2] = {0, 0};
    if (!parse_whole(first, counts[0]) || counts[0] < 0)
      scan_.fail("the count of vertices is not a whole number >= 0");
    counts[1] = whole("count of faces");
    more();  // edges, which may be missing
    for (const long long count : counts)
      if (count > limits::kMeshElements)
        throw LimitError(fmt::format("{}: {} vertices and {} faces; the limit is {}", name_,
                                     counts[0], counts[1], limits::kMeshElements));
    if (6 * static_cast<unsigned long long>(counts[0]) +
            2 * static_cast<unsigned long long>(counts[1]) >
        size_)
      throw InputError(
          fmt::format("{}: the header promises {} vertices and {} faces, more than the file can "
                      "hold",
                      name_, counts[0], counts[1]));
    vertices_ = std::size_t(counts[0]);
    faces_ = std::size_t(counts[1]);
  }

  // What follows x, y and z stands on the line where z ends.
  void read_vertex() {
    for (const char* axis : {"x", "y", "z"}) polygons_.coordinates.push_back(number(axis));
    double values[16];
    std::size_t count = 0;
    for (auto found = more(); !found.empty(); found = more())
      if (count == 16 || !parse_number(found, values[count++]))
        scan_.fail("a vertex has more than its coordinates, and not in numbers");
    std::size_t at = 0;
    if (kind_.normals && count >= 3) normals_.insert(normals_.end(), values, values + (at = 3));
    const std::size_t left = count - at - (kind_.texture && count >= at + 2 ? 2 : 0);
    if (left >= 3) {
      for (std::size_t k = at; k < at + 3; ++k) colours_.push_back(float(values[k]));
      at += left;
    }
    if (kind_.texture && count >= 2)
      for (std::size_t k = count - 2; k < count; ++k)
        uv_.push_back(std::abs(values[k]) < 1e30 ? float(values[k]) : 0);
  }

  void read_face(std::size_t face) {
    const long long size = whole("count of a face's corners");
    if (size > static_cast<long long>(limits::kPolygonCorners))
      throw LimitError(fmt::format("{}: face {} has {} corners; the limit is {}", name_, face, size,
                                   limits::kPolygonCorners));
    for (long long k = 0; k < size; ++k) {
      const long long corner = whole("corner");
      if (corner >= static_cast<long long>(vertices_))
        scan_.fail(fmt::format("face {} names vertex {} of {}", face, corner, vertices_));
      polygons_.corners.push_back(int(corner));
    }
    polygons_.sizes.push_back(int(size));
    if (polygons_.corners.size() > limits::kMeshCorners)
      throw LimitError(
          fmt::format("{}: more than {} corners of faces", name_, limits::kMeshCorners));
    while (!more().empty()) continue;  // its colour
  }

  TextScan scan_;
  std::string name_;
  std::size_t size_, vertices_ = 0, faces_ = 0;
  OffKind kind_;
  Polygons polygons_;
  std::vector<double> normals_;
  std::vector<float> colours_, uv_;
};

}  // namespace

bool is_off_keyword(std::string_view word) { return off_kind(word).is_known; }

void parse_off(std::string_view text, const std::string& name, const MeshReadOptions& options,
               MeshFile& out) {
  OffFile(text, name).read(options, out);
}

}  // namespace ecorche::inline v1
