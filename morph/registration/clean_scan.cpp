#include "morph/registration/clean_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Eigenvalues>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_islands.h"
#include "anatomy/mesh_files/head_islands.h"
#include "morph/registration/cloud_neighbours.h"
#include "morph/registration/cloud_normals.h"
#include "morph/registration/mesh_winding.h"
#include "morph/registration/scan_removal.h"
#include "morph/registration/scan_unit.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kFewest = 300;     // bare points
constexpr int kMost = 400'000;   // points handed on
constexpr int kAround = 8;       // neighbours that tell noise
constexpr int kNormalFrom = 24;  // neighbours that give a normal

double area_of(const Scan& scan) {
  return std::accumulate(scan.area.begin(), scan.area.end(), 0.0);
}

constexpr double kStray = 0.005;

// The largest along the file's axes, a share of the points left out at either end.
double extent_of(const Points& points, double stray = kStray) {
  double extent = 0;
  std::vector<double> along(points.rows());
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    Eigen::Map<Eigen::VectorXd>(along.data(), points.rows()) = points * axis;
    const std::ptrdiff_t cut = std::ptrdiff_t(stray * double(along.size()));
    const auto low = along.begin() + cut, high = along.end() - 1 - cut;
    std::ranges::nth_element(along, low);
    const double from = *low;
    std::ranges::nth_element(along, high);
    extent = std::max(extent, *high - from);
  }
  return extent;
}

// The faces of a part that `takes` takes, over all its vertices.
template <class Takes>
MeshPart faces_of(const MeshPart& part, const Takes& takes) {
  MeshPart out;
  out.name = part.name;
  out.mesh.F.resize(part.mesh.F.rows(), 3);
  Eigen::Index faces = 0;
  for (Eigen::Index f = 0; f < part.mesh.F.rows(); ++f)
    if (takes(f)) out.mesh.F.row(faces++) = part.mesh.F.row(f);
  out.mesh.F.conservativeResize(faces, 3);
  if (faces > 0) out.mesh.V = part.mesh.V;
  return out;
}

// A part whose materials are of several kinds, as a part for each kind.
void split_by_materials(const MeshPart& part, std::vector<MeshPart>& out) {
  constexpr std::array kKinds{PartKind::body, PartKind::clothes,     PartKind::headgear,
                              PartKind::hair, PartKind::eyes,        PartKind::mouth,
                              PartKind::prop, PartKind::surroundings};
  std::vector<PartKind> kinds;
  for (const std::string& material : part.materials)
    kinds.push_back(kind_of_part({}, std::span(&material, 1)));
  const auto kind_of_face = [&](Eigen::Index f) {
    const int material = part.face_materials[f];
    return material < 0 || material >= int(kinds.size()) ? PartKind::body : kinds[material];
  };
  for (const PartKind kind : kKinds) {
    MeshPart piece = faces_of(part, [&](Eigen::Index f) { return kind_of_face(f) == kind; });
    if (piece.mesh.F.rows() == 0) continue;
    for (std::size_t m = 0; m < kinds.size(); ++m)
      if (kinds[m] == kind) piece.materials.push_back(part.materials[m]);
    out.push_back(std::move(piece));
  }
}

// Whether the name says nothing and materials of the faces differ.
bool is_mixed(const MeshPart& part) {
  return part.materials.size() > 1 &&
         Eigen::Index(part.face_materials.size()) == part.mesh.F.rows() && part.mesh.F.rows() > 0 &&
         kind_of_part(part.name, {}) == PartKind::body;
}

// The file with its mixed parts divided, where there are any.
std::optional<MeshFile> divided_by_materials(const MeshFile& file) {
  if (std::ranges::none_of(file.parts, is_mixed)) return std::nullopt;
  MeshFile out;
  out.unit = file.unit;
  out.up = file.up;
  for (const MeshPart& part : file.parts) {
    if (is_mixed(part))
      split_by_materials(part, out.parts);
    else
      out.parts.push_back(part);
  }
  return out;
}

// The box of the faces' corners, of all vertices where there are no faces.
Eigen::AlignedBox3d box_of(const TriMesh& mesh) {
  Eigen::AlignedBox3d box;
  const auto take = [&](Eigen::Index v) {
    if (mesh.V.row(v).allFinite()) box.extend(Vec3(mesh.V.row(v)));
  };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) take(mesh.F(f, k));
  for (Eigen::Index v = 0; mesh.F.rows() == 0 && v < mesh.V.rows(); ++v) take(v);
  return box;
}

// For each part 1 for the vertices of islands that its name puts into the head and that lie
// elsewhere; nothing for parts without such.
std::vector<std::vector<char>> strays_of(const MeshFile& file, std::span<const PartKind> kinds) {
  struct Place {
    std::size_t part;
    int island;
  };
  Eigen::AlignedBox3d figure;
  std::vector<HeadIsland> islands;
  std::vector<Place> places;
  std::vector<std::vector<int>> island_of(kinds.size());
  for (std::size_t p = 0; p < kinds.size(); ++p) {
    const TriMesh& mesh = file.parts[p].mesh;
    if (shows_body(kinds[p]) || is_in_head(kinds[p])) figure.extend(box_of(mesh));
    if (!is_in_head(kinds[p]) || mesh.F.rows() == 0) continue;
    island_of[p] = mesh_islands(mesh);
    std::map<int, Eigen::AlignedBox3d> boxes;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
      for (int k = 0; k < 3; ++k)
        if (const Vec3 at = mesh.V.row(mesh.F(f, k)); at.allFinite())
          boxes[island_of[p][mesh.F(f, k)]].extend(at);
    for (const auto& [island, box] : boxes) {
      islands.push_back({kinds[p], box});
      places.push_back({p, island});
    }
  }
  const std::vector<char> in_head = lies_in_head(islands, figure, file.up);
  std::vector<std::vector<char>> out(kinds.size());
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (in_head[i]) continue;
    out[places[i].part].resize(island_of[places[i].part].size(), 0);
    out[places[i].part][places[i].island] = 1;  // its lowest vertex
  }
  for (std::size_t p = 0; p < out.size(); ++p)
    for (std::size_t v = 0; v < out[p].size(); ++v) out[p][v] = out[p][island_of[p][v]];
  return out;
}

// What strays from a head's parts is body, as a part of its own.
void part_strays(const std::vector<std::vector<char>>& strays, MeshFile& file,
                 std::vector<PartKind>& kinds) {
  for (std::size_t p = 0; p < strays.size(); ++p) {
    if (strays[p].empty()) continue;
    const MeshPart part = std::move(file.parts[p]);
    const auto strayed = [&](Eigen::Index f) { return strays[p][part.mesh.F(f, 0)] != 0; };
    file.parts[p] = faces_of(part, [&](Eigen::Index f) { return !strayed(f); });
    file.parts[p].materials = part.materials;
    file.parts.push_back(faces_of(part, strayed));
    file.parts.back().materials = part.materials;
    kinds.push_back(PartKind::body);
  }
}

// With the materials that decided, where the name alone did not.
std::string name_of(const MeshPart& part, PartKind kind) {
  if (part.materials.empty() || (!part.name.empty() && kind_of_part(part.name, {}) == kind))
    return part.name;
  const std::string materials = fmt::format("{}", fmt::join(part.materials, ", "));
  return part.name.empty() ? materials : fmt::format("{} ({})", part.name, materials);
}

std::vector<PartKind> kinds_by_name(const MeshFile& file) {
  std::vector<PartKind> kinds;
  for (const MeshPart& part : file.parts) kinds.push_back(kind_of_part(part.name, part.materials));
  return kinds;
}

void tell_kinds(const MeshFile& file, std::vector<PartKind>& kinds, Scan& about) {
  if (std::ranges::none_of(kinds, shows_body)) std::ranges::fill(kinds, PartKind::body);
  std::vector<std::string> clothes;
  for (std::size_t p = 0; p < kinds.size(); ++p) {
    const MeshPart& part = file.parts[p];
    if (part.mesh.V.rows() == 0) continue;
    if (!shows_body(kinds[p])) about.left_out.push_back(name_of(part, kinds[p]));
    if (is_covering(kinds[p])) clothes.push_back(name_of(part, kinds[p]));
  }
  if (!about.left_out.empty())
    about.notes.push_back(fmt::format("no body by name: {}", fmt::join(about.left_out, ", ")));
  if (!clothes.empty())
    about.notes.push_back(fmt::format("clothes by name: {}", fmt::join(clothes, ", ")));
}

// A sample of the file's finite points, in its units.
Points sample_points(const MeshFile& file, std::span<const PartKind> kinds) {
  constexpr Eigen::Index kSample = 200'000;
  Eigen::Index all = 0;
  for (std::size_t p = 0; p < kinds.size(); ++p)
    if (shows_body(kinds[p])) all += file.parts[p].mesh.V.rows();
  const Eigen::Index step = std::max<Eigen::Index>(1, all / kSample);
  Points out(all / step + Eigen::Index(kinds.size()), 3);
  Eigen::Index used = 0;
  for (std::size_t p = 0; p < kinds.size(); ++p) {
    if (!shows_body(kinds[p])) continue;
    const Points& V = file.parts[p].mesh.V;
    for (Eigen::Index i = 0; i < V.rows(); i += step)
      if (V.row(i).allFinite()) out.row(used++) = V.row(i);
  }
  out.conservativeResize(used, 3);
  return out;
}

void refuse_flat(const Points& points, const std::string& name) {
  const Vec3 mean = points.colwise().mean();
  const Points apart = points.rowwise() - mean.transpose();
  const Vec3 spread =
      Eigen::SelfAdjointEigenSolver<Mat3>(apart.transpose() * apart).eigenvalues().cwiseMax(0);
  constexpr double kFlat = 0.004;
  if (!(spread[2] > 0) || !std::isfinite(spread[2]))
    throw UnfitError(
        fmt::format("{}: all points lie in one place; a scan of a person is needed", name));
  if (std::sqrt(spread[0] / spread[2]) < kFlat)
    throw UnfitError(
        fmt::format("{}: all points lie in one plane or line, which is no person", name));
}

// Vertices at edges of a single face.
std::vector<char> mesh_borders(const Scan& scan) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * scan.F.rows());
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f)
    for (int c = 0; c < 3; ++c) {
      const int a = scan.F(f, c), b = scan.F(f, (c + 1) % 3);
      edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::ranges::sort(edges);
  std::vector<char> border(scan.points.rows(), 0);
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last] == edges[first]) ++last;
    if (last - first == 1) border[edges[first].first] = border[edges[first].second] = 1;
  }
  return border;
}

void drop(Scan& scan, const std::vector<char>& keep, const char* what) {
  const auto gone = std::ranges::count(keep, 0);
  if (gone == 0) return;
  const double share = 100.0 * double(gone) / double(keep.size());
  keep_points(scan, keep);
  if (what != nullptr)
    scan.notes.push_back(fmt::format("{} taken away: {:.2f} % of the points", what, share));
}

void need_points(const Scan& scan, const std::string& name) {
  const Eigen::Index least = scan.F.rows() > 0 ? kFewest / 3 : kFewest;
  if (scan.points.rows() < least)
    throw UnfitError(
        fmt::format("{}: {} points are left, of which no person can be told; at "
                    "least {} are needed",
                    name, scan.points.rows(), least));
}

// Noise of clouds, then what their points lack.
void complete_cloud(Scan& scan, const std::string& name) {
  const bool wound = area_of(scan) > 0;  // thinned from faces
  drop(scan, without_outliers(scan.points, nearest_neighbours(scan.points, kAround)), "noise");
  need_points(scan, name);
  if (wound) return;
  const CloudNeighbours near = nearest_neighbours(scan.points, kNormalFrom);
  const Points told = scan.normals;
  scan.normals = plane_normals(scan.points, near);
  scan.area = cloud_areas(near);
  const std::optional<Vec3> camera = depth_camera(scan.points);
  scan.one_view = camera.has_value();
  if (camera) {
    scan.seen_from = *camera;
    scan.notes.push_back("a depth frame: seen from the origin alone");
  }
  orient_normals(scan.points, near, camera, scan.normals);
  for (Eigen::Index i = 0; i < told.rows(); ++i)
    if (scan.normals.row(i).dot(told.row(i)) < 0) scan.normals.row(i) *= -1;
}

Scan clean_at(const MeshFile& file, std::span<const PartKind> kinds, double unit,
              const std::string& name) {
  Scan scan = gather_points(file, kinds, unit);
  need_points(scan, name);
  if (scan.F.rows() > 0) {
    constexpr int kRounds = 3;
    int spikes = 0;
    for (int round = 0; round < kRounds; ++round) spikes += level_spikes(scan);
    if (spikes > 0) scan.notes.push_back(fmt::format("{} spikes levelled", spikes));
    measure_faces(scan);
    const WindingReport winding = wind_outwards(scan);
    if (winding.inside_out)
      scan.notes.push_back("the mesh was inside out");
    else if (winding.turned > 0)
      scan.notes.push_back(fmt::format("{} faces were wound the other way", winding.turned));
  } else {
    complete_cloud(scan, name);
  }
  constexpr int kPieces = 12;
  drop(scan, without_planes(scan, nearest_neighbours(scan.points, kPieces)), nullptr);
  need_points(scan, name);
  drop(scan, without_islands(scan, nearest_neighbours(scan.points, kAround)), nullptr);
  need_points(scan, name);
  if (scan.F.rows() > 0) {
    scan.border = mesh_borders(scan);
    drop(scan, without_insides(scan), "insides");
    need_points(scan, name);
    return scan;
  }
  if (scan.points.rows() > kMost) {
    const double before = area_of(scan);
    std::vector<char> keep(scan.points.rows(), 0);
    for (const int i : spread_points(scan, kMost)) keep[i] = 1;
    keep_points(scan, keep);
    const float more = float(before / std::max(area_of(scan), 1e-9));
    for (float& area : scan.area) area *= more;
  }
  scan.border =
      cloud_borders(scan.points, scan.normals, nearest_neighbours(scan.points, kNormalFrom));
  return scan;
}

}  // namespace

Scan clean_scan(const MeshFile& whole, const CleanScanOptions& options) {
  std::optional<MeshFile> divided = divided_by_materials(whole);
  std::vector<PartKind> kinds = kinds_by_name(divided ? *divided : whole);
  const std::vector<std::vector<char>> strays = strays_of(divided ? *divided : whole, kinds);
  if (std::ranges::any_of(strays, [](const auto& of_part) { return !of_part.empty(); })) {
    if (!divided) divided = whole;
    part_strays(strays, *divided, kinds);
  }
  const MeshFile& file = divided ? *divided : whole;
  Scan about;
  tell_kinds(file, kinds, about);
  const Points sample = sample_points(file, kinds);
  if (sample.rows() < 3) throw UnfitError(fmt::format("{}: there are no points", options.name));
  refuse_flat(sample, options.name);
  const double rough = extent_of(sample);
  if (!(rough > 0)) throw UnfitError(fmt::format("{}: its points have no extent", options.name));

  // The unit tells what is 8 mm; what is left of the scan then tells the unit.
  ScanUnit unit{1, true, ""};
  if (options.unit)
    unit.metres = *options.unit;
  else
    unit = guess_unit(rough, 0, file.unit);
  Scan scan = clean_at(file, kinds, unit.metres, options.name);
  if (!options.unit) {
    constexpr int kRounds = 2;
    constexpr double kTip = 2e-4;
    for (int round = 0; round < kRounds; ++round) {
      const double extent = extent_of(scan.points) / unit.metres;
      ScanUnit better = guess_unit(extent, area_of(scan) / (unit.metres * unit.metres), file.unit);
      if (options.stature)
        better = {*options.stature * unit.metres / extent_of(scan.points, kTip), true,
                  "unit: by the stature"};
      const double change = std::abs(std::log(better.metres / unit.metres));
      unit = better;
      constexpr double kSame = 0.02, kAlike = 0.3;
      if (change < (options.stature ? 1e-6 : kSame)) break;
      if (change < kAlike) {  // the same points in another measure
        const double factor = unit.metres / scan.unit;
        scan.points *= factor;
        for (float& area : scan.area) area *= float(factor * factor);
        break;
      }
      scan = clean_at(file, kinds, unit.metres, options.name);
    }
  } else {
    unit.note = fmt::format("unit: {:g} m, as asked", unit.metres);
  }
  scan.unit = unit.metres;
  scan.unit_known = unit.known;
  scan.unit_told = options.unit.has_value();
  scan.stature = options.stature;
  if (!scan.up) scan.up = file.up;
  scan.left_out = about.left_out;
  scan.notes.insert(scan.notes.begin(), unit.note);
  scan.notes.insert(scan.notes.end(), about.notes.begin(), about.notes.end());
  return scan;
}

}  // namespace ecorche::inline v1
