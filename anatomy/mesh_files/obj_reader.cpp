#include "anatomy/mesh_files/obj_reader.h"

#include <algorithm>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/polygons.h"

namespace ecorche::inline v1 {
namespace {

// The vertex of a corner "7", "7/1", "7//3", "7/1/3" or counted from the end "-1"; 0-based.
// Vertices may follow their faces, so an index above `count` is only remembered in `highest`.
int corner_vertex(TextScan& scan, std::string_view word, long long count) {
  long long index = 0;
  for (std::size_t begin = 0, field = 0; begin <= word.size(); ++field) {
    const auto end = std::min(word.find('/', begin), word.size());
    const auto part = word.substr(begin, end - begin);
    long long value = 0;
    const bool number = parse_whole(part, value);
    if (field > 2 || (!number && (field == 0 || !part.empty())))
      scan.fail("a face corner is not 'vertex/texture/normal'");
    if (field == 0) index = value;
    begin = end + 1;
  }
  if (index == 0) scan.fail("a face corner is 0; OBJ counts vertices from 1");
  if (index < 0) index += count + 1;
  if (index < 1)
    scan.fail(fmt::format("a face corner counts back beyond the first of {} vertices", count));
  if (index > limits::kMeshElements)
    scan.fail(fmt::format("a face corner names vertex {}, beyond the limit", index));
  return int(index - 1);
}

}  // namespace

void parse_obj(std::string_view text, const std::string& name, MeshFile& out) {
  Polygons polygons;
  TextScan scan(text, name);
  int forward = -1, forward_line = 0;  // the highest vertex named before it came
  long long unknown = 0, statements = 0;
  while (scan.next_line()) {
    const auto key = scan.word();
    if (key.empty() || key.front() == '#') continue;
    ++statements;
    if (key == "v") {
      for (const char* axis : {"x", "y", "z"}) polygons.coordinates.push_back(scan.number(axis));
      if (polygons.coordinates.size() > 3 * std::size_t(limits::kMeshElements))
        throw LimitError(fmt::format("{}: more than {} vertices", name, limits::kMeshElements));
    } else if (key == "f") {
      const auto count = static_cast<long long>(polygons.coordinates.size() / 3);
      int size = 0;
      for (auto word = scan.word(); !word.empty(); word = scan.word(), ++size) {
        polygons.corners.push_back(corner_vertex(scan, word, count));
        if (polygons.corners.back() >= count && polygons.corners.back() > forward) {
          forward = polygons.corners.back();
          forward_line = scan.line_number();
        }
      }
      polygons.sizes.push_back(size);
      if (polygons.corners.size() > limits::kMeshCorners)
        throw LimitError(
            fmt::format("{}: more than {} corners of faces", name, limits::kMeshCorners));
    } else if (key == "mtllib") {
      out.notes.push_back(fmt::format("{}:{}: materials are not read", name, scan.line_number()));
    } else if (key != "vt" && key != "vn" && key != "vp" && key != "g" && key != "o" &&
               key != "s" && key != "usemtl" && key != "l" && key != "p") {
      ++unknown;
    }
  }
  if (polygons.coordinates.empty())
    throw InputError(
        fmt::format("{}: neither OBJ, PLY nor GLB; give a mesh in one of these", name));
  if (unknown * 2 > statements)
    throw InputError(
        fmt::format("{}: {} of {} lines are no OBJ statement", name, unknown, statements));
  const auto count = static_cast<long long>(polygons.coordinates.size() / 3);
  if (forward >= count)
    throw InputError(fmt::format("{}:{}: a face corner names vertex {} of {}", name, forward_line,
                                 forward + 1, count));
  out.parts.push_back({"", triangulate(polygons, name, out.notes)});
}

}  // namespace ecorche::inline v1
