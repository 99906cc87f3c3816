#include "anatomy/base_mesh/skin_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

using Edge = std::pair<int, int>;

constexpr double kSameEdges = 0.99;
constexpr double kShortest = 0.45, kTallest = 2.8;  // m: from a newborn to the tallest person

// Share of the base mesh's quad edges that a mesh has among its vertices from `first` on.
double shared_edges(const TriMesh& mesh, const BodyPackage& package, int first = 0) {
  std::set<Edge> edges;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.F(f, k) - first, b = mesh.F(f, (k + 1) % 3) - first;
      if (a >= 0 && b >= 0 && a < package.skin_size && b < package.skin_size)
        edges.insert(std::minmax(a, b));
    }
  }
  long long found = 0;
  for (Eigen::Index q = 0; q < package.quads.rows(); ++q) {
    for (int k = 0; k < 4; ++k)
      found += edges.contains(std::minmax(package.quads(q, k), package.quads(q, (k + 1) % 4)));
  }
  return double(found) / double(4 * package.quads.rows());
}

[[noreturn]] void refuse_two(const std::string& name, const std::string& what) {
  throw UnfitError(
      fmt::format("{}: holds two skins or more ({}); save one person a file", name, what));
}

// Vertices at one place made one, in the order in which places first appear: exporters split a skin
// along the seams of its texture, and put copies beside the vertices or after all of them.
TriMesh welded(const TriMesh& mesh) {
  std::map<std::array<double, 3>, int> first;
  std::vector<int> joined;
  TriMesh out;
  out.V.resize(mesh.V.rows(), 3);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const std::array<double, 3> place{mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2)};
    const auto [at, is_new] = first.emplace(place, int(first.size()));
    if (is_new) out.V.row(at->second) = mesh.V.row(v);
    joined.push_back(at->second);
  }
  out.V.conservativeResize(first.size(), 3);
  out.F = mesh.F.unaryExpr([&joined](int v) { return joined[v]; });
  return out;
}

// The one part of a file that is a skin split along seams; nothing where there is none.
std::optional<TriMesh> find_split_skin(const MeshFile& file, const std::string& name,
                                       const BodyPackage& package) {
  std::optional<TriMesh> found;
  for (const MeshPart& part : file.parts) {
    if (part.mesh.V.rows() <= package.skin_size) continue;
    TriMesh mesh = welded(part.mesh);
    if (mesh.V.rows() == part.mesh.V.rows() || mesh.V.rows() < package.skin_size) continue;
    if (shared_edges(mesh, package) <= kSameEdges) continue;
    if (found || (mesh.V.rows() >= 2 * package.skin_size &&
                  shared_edges(mesh, package, package.skin_size) > kSameEdges))
      refuse_two(name, fmt::format("'{}'", part.name));
    found = std::move(mesh);
  }
  return found;
}

// The part of a file that is the skin, or a message that says why there is none.
TriMesh find_skin(const MeshFile& file, const std::string& name, const BodyPackage& package,
                  std::vector<std::string>& notes) {
  std::string counts;
  double best = 0;
  const MeshPart* found = nullptr;
  for (const auto& part : file.parts) {
    if (counts.size() < 200)
      counts += fmt::format("{}{}", counts.empty() ? "" : ", ", part.mesh.V.rows());
    if (part.mesh.V.rows() < package.skin_size) continue;
    const double share = shared_edges(part.mesh, package);
    best = std::max(best, share);
    if (share <= kSameEdges) continue;
    if (found) refuse_two(name, fmt::format("'{}' and '{}'", found->name, part.name));
    if (part.mesh.V.rows() >= 2 * package.skin_size &&
        shared_edges(part.mesh, package, package.skin_size) > kSameEdges)
      refuse_two(name, fmt::format("{} vertices", part.mesh.V.rows()));
    found = &part;
  }
  if (found) return found->mesh;
  if (std::optional<TriMesh> split = find_split_skin(file, name, package)) {
    notes.push_back(
        fmt::format("{}: split along the seams of its texture; vertices at one place are taken as "
                    "one, {} in all",
                    name, split->V.rows()));
    return std::move(*split);
  }
  const auto advice =
      "a skin must keep the base mesh's vertices and their order: export without merging, "
      "splitting or re-ordering";
  if (best > 0) {
    throw UnfitError(fmt::format("{}: {} vertices, but only {:.0f} % of the base mesh's edges; {}",
                                 name, counts, 100 * best, advice));
  }
  throw UnfitError(fmt::format("{}: {} vertices; the base mesh's skin has {}; {}", name, counts,
                               package.skin_size, advice));
}

Points centred(const Points& points) { return points.rowwise() - points.colwise().mean(); }

const char* axis_name(const Vec3& axis) {
  constexpr const char* kNames[] = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  Eigen::Index k = 0;
  axis.cwiseAbs().maxCoeff(&k);
  return kNames[2 * k + (axis[k] < 0)];
}

// The rotation (or, for left-handed axes, reflection) that turns the file's axes into ours: the
// best fit to the base mesh, brought to the nearest turn by right angles when that is less than 15
// degrees away.
Mat3 file_to_world(const Points& skin, const BodyPackage& package, BareSkin& out) {
  const Points from = centred(skin), to = centred(package.points.topRows(package.skin_size));
  const Mat3 moments = to.transpose() * from;
  const Svd3 parts = svd(moments);
  const Mat3 fitted = parts.U * parts.V.transpose();
  out.mirrored = fitted.determinant() < 0;
  Mat3 nearest = Mat3::Identity();
  double best = -4;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turn = Mat3::Zero();
      for (int k = 0; k < 3; ++k) turn(k, order[k]) = (signs >> k & 1) != 0 ? -1 : 1;
      if ((turn.determinant() < 0) == out.mirrored && (turn.transpose() * fitted).trace() > best) {
        best = (turn.transpose() * fitted).trace();
        nearest = turn;
      }
    }
  } while (std::next_permutation(order.begin(), order.end()));
  const double angle = std::acos(std::clamp((best - 1) / 2, -1.0, 1.0));
  const bool aligned = angle < 15 * std::numbers::pi / 180;
  const Mat3 turn = aligned ? nearest : fitted;
  out.up = aligned ? axis_name(turn.row(1).transpose()) : "oblique";
  out.front = aligned ? axis_name(turn.row(2).transpose()) : "oblique";
  return turn;
}

struct Unit {
  const char *name, *plural;
  double metres;
};
// The first four lie so far apart that at most one of them gives a human height.
constexpr Unit kUnits[] = {{"m", "metres", 1},          {"dm", "decimetres", 0.1},
                           {"cm", "centimetres", 0.01}, {"mm", "millimetres", 0.001},
                           {"in", "inches", 0.0254},    {"ft", "feet", 0.3048}};
constexpr std::size_t kGuessed = 4;

bool human(double height) { return height >= kShortest && height <= kTallest; }

double find_unit(double height, const std::string& name, std::vector<std::string>& notes) {
  // What is a toddler in centimetres and a grown person in inches is asked for.
  constexpr double kToddler = 0.87, kShortAdult = 1.2;
  for (const Unit& unit : std::span(kUnits).first(kGuessed)) {
    const double tall = height * unit.metres;
    if (!human(tall)) continue;
    if (unit.metres == 0.01 && tall < kToddler && height * 0.0254 > kShortAdult) {
      throw UnfitError(
          fmt::format("{}: {:.1f} units tall, a child of {:.2f} m in centimetres or an adult of "
                      "{:.2f} m in inches; say --unit cm or --unit in (--skin-unit of `body`)",
                      name, height, tall, height * 0.0254));
    }
    notes.push_back(fmt::format("{}: read as {} ({:.3f} m tall)", name, unit.plural, tall));
    return unit.metres;
  }
  throw UnfitError(
      fmt::format("{}: {:g} units tall, which is no human height in m, dm, cm or mm; scale it to "
                  "metres, or say --unit (--skin-unit of `body`)",
                  name, height));
}

// Mean angle between triangles that share an edge, rad. Skin is smooth; what is not has been read
// in the wrong order or spoilt.
double roughness(const TriMesh& mesh) {
  struct Flank {
    Edge edge;
    Eigen::Index face;
  };
  std::vector<Flank> flanks;
  std::vector<Vec3> normals;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    normals.push_back((b - a).cross(c - a).stableNormalized());
    for (int k = 0; k < 3; ++k)
      flanks.push_back({std::minmax(mesh.F(f, k), mesh.F(f, (k + 1) % 3)), f});
  }
  std::ranges::sort(flanks, {}, [](const Flank& x) { return std::tuple(x.edge, x.face); });
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i + 1 < flanks.size(); ++i) {
    if (flanks[i].edge != flanks[i + 1].edge) continue;
    const Vec3 &n = normals[flanks[i].face], &m = normals[flanks[i + 1].face];
    sum += std::acos(std::clamp(n.dot(m), -1.0, 1.0));
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

void check_smooth(const TriMesh& skin, const std::string& name) {
  constexpr double kMost = 40;  // smooth bodies have 9 to 11 degrees
  const double angle = roughness(skin) * kDegreesPerRadian;
  if (angle > kMost) {
    throw UnfitError(
        fmt::format("{}: a crumpled surface: its triangles meet at {:.0f} degrees on average (a "
                    "skin at about 10, at most {:.0f}); smooth it, "
                    "or look whether its vertices were moved out of their order",
                    name, angle, kMost));
  }
}

// Direction from the middle of one part to the middle of another.
Vec3 limb_direction(const Points& skin, const std::vector<VertexPart>& parts, BodyPart from,
                    BodyPart to, Side side) {
  const auto centre = [&](BodyPart part) {
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].part != part || parts[i].side != side) continue;
      sum += skin.row(i).transpose();
      ++count;
    }
    return Vec3(sum / count);
  };
  return (centre(to) - centre(from)).normalized();
}

void check_pose(const Points& skin, const std::string& name, const BodyPackage& package) {
  constexpr double kMost = 20;  // degrees; shapes themselves differ by up to 8
  struct Limb {
    const char* name;
    BodyPart from, to;
  };
  constexpr Limb kLimbs[] = {{"upper arm", BodyPart::upper_arm, BodyPart::forearm},
                             {"forearm", BodyPart::forearm, BodyPart::hand},
                             {"thigh", BodyPart::thigh, BodyPart::shank},
                             {"shank", BodyPart::shank, BodyPart::foot}};
  const auto parts = vertex_parts(package);
  const Points base = package.points.topRows(package.skin_size);
  for (const auto& limb : kLimbs) {
    for (const Side side : {Side::left, Side::right}) {
      const Vec3 here = limb_direction(skin, parts, limb.from, limb.to, side),
                 there = limb_direction(base, parts, limb.from, limb.to, side);
      const double angle =
          std::acos(std::clamp(here.dot(there), -1.0, 1.0)) * 180 / std::numbers::pi;
      if (angle > kMost) {
        throw UnfitError(
            fmt::format("{}: the {} {} is turned {:.0f} degrees from the base mesh's pose (at most "
                        "{:.0f}); save the skin in its rest pose",
                        name, side == Side::left ? "left" : "right", limb.name, angle, kMost));
      }
    }
  }
}

}  // namespace

std::optional<double> metres_in(const std::string& unit) {
  const auto* found = std::ranges::find(kUnits, unit, &Unit::name);
  return found == std::end(kUnits) ? std::nullopt : std::optional(found->metres);
}

bool has_base_skin(const MeshFile& file, const BodyPackage& package) {
  const bool whole = std::any_of(file.parts.begin(), file.parts.end(), [&](const MeshPart& part) {
    return part.mesh.V.rows() >= package.skin_size && shared_edges(part.mesh, package) > kSameEdges;
  });
  return whole || find_split_skin(file, "", package).has_value();
}

BareSkin bare_skin(const MeshFile& file, const std::string& name, const BodyPackage& package,
                   std::optional<double> unit) {
  BareSkin out;
  out.notes = file.notes;
  const TriMesh mesh = find_skin(file, name, package, out.notes);
  const bool helpers = mesh.V.rows() == package.points.rows();
  if (mesh.V.rows() > package.skin_size) {
    out.notes.push_back(fmt::format(
        "{}: {} vertices; the first {} are the skin{}", name, mesh.V.rows(), package.skin_size,
        helpers ? ", the rest the base mesh's helper geometry" : ", the rest is left out"));
  }
  const Points skin = mesh.V.topRows(package.skin_size);
  if (!(centred(skin).rowwise().norm().maxCoeff() > 0))
    throw UnfitError(fmt::format("{}: all vertices lie in one point", name));
  const Mat3 turn = file_to_world(skin, package, out);
  // Centred first: files far from the origin keep their precision.
  const Vec3 middle = skin.colwise().mean();
  out.points = ((helpers ? mesh.V : skin).rowwise() - middle.transpose()) * turn.transpose();
  const auto body = [&] { return out.points.topRows(package.skin_size); };
  const double height = body().col(1).maxCoeff() - body().col(1).minCoeff();
  if (unit && !human(height * *unit)) {
    throw UnfitError(
        fmt::format("{}: {:g} units tall, {:.3g} m in the given unit, which is no human height "
                    "({:g} to {:g} m)",
                    name, height, height * *unit, kShortest, kTallest));
  }
  out.unit = unit ? *unit : find_unit(height, name, out.notes);
  out.points *= out.unit;
  double midplane = 0;
  for (int i = 0; i < package.skin_size; ++i)
    midplane += out.points(i, 0) + out.points(package.mirror[i], 0);
  const double depth =
      package.points.topRows(package.skin_size).col(2).mean() - body().col(2).mean();
  out.points.rowwise() +=
      Eigen::RowVector3d(-midplane / (2.0 * package.skin_size), -body().col(1).minCoeff(), depth);
  check_pose(body(), name, package);
  if (out.up != "+Y" || out.front != "+Z")
    out.notes.push_back(fmt::format("{}: turned from up {} and front {} to up +Y and front +Z",
                                    name, out.up, out.front));
  if (out.mirrored)
    out.notes.push_back(fmt::format("{}: mirrored, because its axes are left-handed", name));
  out.body.skin = skin_mesh(package, out.points);
  check_smooth(out.body.skin, name);
  out.body.name = printable(std::filesystem::path(name).stem().string());
  out.body.age = 0;
  return out;
}

BareSkin read_bare_skin(const std::filesystem::path& file, const BodyPackage& package,
                        std::optional<double> unit) {
  return bare_skin(read_mesh_file(file), printable(file.string()), package, unit);
}

}  // namespace ecorche::inline v1
