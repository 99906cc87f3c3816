#include "tests/morph/synthetic_scans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <random>
#include <unordered_map>

#include <fmt/format.h>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/simplify.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche {
namespace {

constexpr double kNoise = 0.002;        // m, of each coordinate
constexpr double kOutliers = 0.05;      // of the points; a fifth of them on the body as spikes
constexpr double kShownWithin = 0.015;  // m

TriMesh without_unused(const TriMesh& mesh) {
  std::vector<int> row(std::size_t(mesh.V.rows()), -1);
  TriMesh out;
  out.F.resize(mesh.F.rows(), 3);
  int count = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      int& r = row[std::size_t(mesh.F(f, k))];
      if (r < 0) r = count++;
      out.F(f, k) = r;
    }
  out.V.resize(count, 3);
  for (std::size_t i = 0; i < row.size(); ++i)
    if (row[i] >= 0) out.V.row(row[i]) = mesh.V.row(Eigen::Index(i));
  return out;
}

std::uint64_t edge_key(int a, int b) {
  return (std::uint64_t(std::min(a, b)) << 32) | std::uint64_t(std::max(a, b));
}

// Splits the longest edges, near their middles, until there are some `faces` triangles.
TriMesh split_edges(TriMesh mesh, int faces, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.35, 0.65);
  while (mesh.F.rows() < faces) {
    std::vector<std::pair<double, std::uint64_t>> edges;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int a = mesh.F(f, k), b = mesh.F(f, (k + 1) % 3);
        if (a < b) edges.push_back({(mesh.V.row(a) - mesh.V.row(b)).norm(), edge_key(a, b)});
      }
    const std::size_t wanted =
        std::min(edges.size() / 2, std::size_t(faces - mesh.F.rows()) / 2 + 1);
    std::nth_element(edges.begin(), edges.begin() + std::ptrdiff_t(wanted), edges.end(),
                     std::greater<>());
    edges.resize(wanted);
    std::sort(edges.begin(), edges.end(), std::greater<>());
    std::unordered_map<std::uint64_t, int> middle;
    const Eigen::Index old = mesh.V.rows();
    mesh.V.conservativeResize(old + Eigen::Index(wanted), 3);
    for (std::size_t e = 0; e < wanted; ++e) {
      const double t = share(random);
      const int a = int(edges[e].second >> 32), b = int(edges[e].second & 0xffffffffu);
      mesh.V.row(old + Eigen::Index(e)) = t * mesh.V.row(a) + (1 - t) * mesh.V.row(b);
      middle[edges[e].second] = int(old) + int(e);
    }
    std::vector<std::array<int, 3>> out;
    out.reserve(std::size_t(faces) + 8);
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      // A split triangle is cut until no edge of it has a middle.
      std::vector<std::array<int, 3>> open{{mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2)}};
      while (!open.empty()) {
        const std::array<int, 3> t = open.back();
        open.pop_back();
        bool cut = false;
        for (int k = 0; k < 3 && !cut; ++k) {
          const int a = t[std::size_t(k)], b = t[std::size_t((k + 1) % 3)],
                    c = t[std::size_t((k + 2) % 3)];
          if (a >= old || b >= old) continue;
          const auto found = middle.find(edge_key(a, b));
          if (found == middle.end()) continue;
          open.push_back({a, found->second, c});
          open.push_back({found->second, b, c});
          cut = true;
        }
        if (!cut) out.push_back(t);
      }
    }
    mesh.F.resize(Eigen::Index(out.size()), 3);
    for (std::size_t f = 0; f < out.size(); ++f)
      mesh.F.row(Eigen::Index(f)) << out[f][0], out[f][1], out[f][2];
  }
  return mesh;
}

// The same surface in about so many triangles, whose corners are none of the base mesh's.
TriMesh remesh(const BodyPackage& package, const Points& posed, int faces, std::mt19937& random) {
  const TriMesh closed = without_unused(capped_skin(package, posed));
  const Refinement refinement = refine(closed.F, int(closed.V.rows()));
  TriMesh mesh{refine_points(refinement, closed.V), refinement.F};
  // Corners go some way along edges.
  std::uniform_real_distribution<double> step(0.1, 0.4);
  Points moved = mesh.V;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const int a = mesh.F(f, int(random() % 3)), b = mesh.F(f, int(random() % 3));
    if (a != b) moved.row(a) = mesh.V.row(a) + step(random) * (mesh.V.row(b) - mesh.V.row(a));
  }
  mesh.V = moved;
  const int coarse = std::min(faces, 180000);
  mesh = simplify(mesh, coarse);
  return faces > coarse ? split_edges(std::move(mesh), faces, random) : mesh;
}

struct Ball {
  Vec3 center;
  double radius;
};

// What the scanner did not see.
std::vector<Ball> holes(const BodyPackage& package, const Points& posed,
                        const std::vector<Landmark>& joints, std::mt19937& random) {
  std::uniform_real_distribution<double> even(0, 1);
  const auto joint = [&](const std::string& name) {
    for (const Landmark& l : joints)
      if (l.name == name) return l.position;
    throw InputError("no joint " + name);
  };
  std::vector<Ball> out;
  for (const char* side : {"_l", "_r"}) {
    const std::string s = side;
    if (even(random) < 0.6) {  // armpit: below the shoulder, towards the trunk
      const Vec3 arm = joint("arm" + s), neck = joint("neck");
      Vec3 in = neck - arm;
      in.y() = 0;
      out.push_back({arm + 0.03 * in.normalized() - Vec3(0, 0.1, 0), 0.05 + 0.02 * even(random)});
    }
    if (even(random) < 0.6) {  // sole
      const Vec3 foot = joint("foot" + s);
      for (const double z : {-0.02, 0.04, 0.1})
        out.push_back({Vec3(foot.x(), -0.035, foot.z() + z), 0.05});
    }
  }
  if (even(random) < 0.6) {  // crotch
    const Vec3 middle = (joint("thigh_l") + joint("thigh_r")) / 2;
    out.push_back({middle - Vec3(0, 0.09, 0), 0.05 + 0.02 * even(random)});
  }
  if (even(random) < 0.5) {  // top of the head
    Eigen::Index top = 0;
    double y = -1;
    const Vec3 head = joint("head");
    for (Eigen::Index i = 0; i < posed.rows(); ++i)
      if ((posed.row(i).transpose() - head).norm() < 0.25 && posed(i, 1) > y)
        y = posed(i, 1), top = i;
    out.push_back({posed.row(top).transpose(), 0.04 + 0.04 * even(random)});
  }
  for (int k = int(random() % 5); k > 0; --k)
    out.push_back({posed.row(Eigen::Index(random() % unsigned(package.skin_size))).transpose(),
                   0.02 + 0.04 * even(random)});
  return out;
}

struct Growing {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;

  void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const int first = int(points.size());
    points.insert(points.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }
};

void add_loose(Growing& out, int points, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(0, 1);
  const std::size_t body = out.points.size();
  Vec3 low = out.points[0], high = low;
  for (const Vec3& p : out.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  low -= Vec3(0.3, 0, 0.3);
  high += Vec3(0.3, 0.3, 0.3);
  for (int k = 0; k < points / 3; ++k) {
    const auto gauss = [&](double sd) -> Vec3 {
      return sd * Vec3(normal(random), normal(random), normal(random));
    };
    Vec3 at;
    if (random() % 2)
      at = out.points[random() % body] + gauss(0.05);
    else
      at = low + (high - low).cwiseProduct(Vec3(even(random), even(random), even(random)));
    out.add_triangle(at, at + gauss(0.006), at + gauss(0.006));
  }
}

void add_floor(Growing& out, std::mt19937& random) {
  std::normal_distribution<double> normal(0, 0.0015);
  std::uniform_real_distribution<double> size(0.4, 0.9);
  const double half = size(random);
  const int n = 24, first = int(out.points.size());
  const auto at = [&](int i, int k) { return first + i * n + k; };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k)
      out.points.push_back({half * (2.0 * i / (n - 1) - 1), -0.003 + normal(random),
                            half * (2.0 * k / (n - 1) - 1)});
  for (int i = 0; i + 1 < n; ++i)
    for (int k = 0; k + 1 < n; ++k) {
      out.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      out.triangles.push_back({at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)});
    }
}

template <class Number>
void put(std::string& out, Number value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string stl_bytes(const TriMesh& mesh) {
  std::string out(80, ' ');
  put(out, std::uint32_t(mesh.F.rows()));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) put(out, 0.0f);
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) put(out, float(mesh.V(mesh.F(f, k), c)));
    put(out, std::uint16_t(0));
  }
  return out;
}

std::string ply_bytes(const TriMesh& mesh) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.V.rows(), mesh.F.rows());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    for (int c = 0; c < 3; ++c) put(out, float(mesh.V(i, c)));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    out.push_back(3);
    for (int k = 0; k < 3; ++k) put(out, std::int32_t(mesh.F(f, k)));
  }
  return out;
}

std::string text_bytes(const TriMesh& mesh, bool obj) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  if (!obj) fmt::format_to(to, "OFF\n{} {} 0\n", mesh.V.rows(), mesh.F.rows());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    fmt::format_to(to, "{}{:.7g} {:.7g} {:.7g}\n", obj ? "v " : "", mesh.V(i, 0), mesh.V(i, 1),
                   mesh.V(i, 2));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    fmt::format_to(to, "{} {} {} {}\n", obj ? "f" : "3", mesh.F(f, 0) + obj, mesh.F(f, 1) + obj,
                   mesh.F(f, 2) + obj);
  return fmt::to_string(out);
}

}  // namespace

SyntheticScans::SyntheticScans(const BodyModel& model)
    : model_(model),
      skins_(model),
      default_(model.package(), "default"),
      game_(model.package(), "game_engine") {}

SyntheticScan SyntheticScans::make(unsigned seed) const {
  std::mt19937 random(seed * 7919u + 17u);
  std::uniform_real_distribution<double> even(0, 1);
  std::normal_distribution<double> normal;
  const BodyPackage& package = model_.package();
  const RealSkin person = skins_.make(seed);
  SyntheticScan out;
  out.rest = person.body.skin.V;
  out.sex = person.body.sex;
  const StandingPose pose = random_standing_pose(random);
  const bool game = random() % 2;
  const PosedPerson posed = (game ? game_ : default_).pose(out.rest, pose);

  const int faces = int(5000 * std::pow(200.0, even(random)));
  const TriMesh whole = remesh(package, posed.skin, faces, random);
  // Holes.
  const std::vector<Ball> gone = holes(package, posed.skin, posed.joints, random);
  Triangles kept(whole.F.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < whole.F.rows(); ++f) {
    const Vec3 center =
        (whole.V.row(whole.F(f, 0)) + whole.V.row(whole.F(f, 1)) + whole.V.row(whole.F(f, 2)))
            .transpose() /
        3;
    if (std::none_of(gone.begin(), gone.end(),
                     [&](const Ball& ball) { return (center - ball.center).norm() < ball.radius; }))
      kept.row(count++) = whole.F.row(f);
  }
  kept.conservativeResize(count, 3);
  const TriMesh clean = without_unused({whole.V, kept});

  const NearestSurface surface(clean);
  out.shown.resize(std::size_t(posed.skin.rows()));
  for (Eigen::Index i = 0; i < posed.skin.rows(); ++i)
    out.shown[std::size_t(i)] =
        surface.nearest(posed.skin.row(i).transpose()).distance < kShownWithin;

  // Noise, spikes, loose triangles, floor.
  Growing dirty;
  std::vector<int> rows;  // of `clean` that are no spikes
  for (Eigen::Index i = 0; i < clean.V.rows(); ++i) {
    Vec3 p =
        clean.V.row(i).transpose() + kNoise * Vec3(normal(random), normal(random), normal(random));
    if (even(random) < kOutliers / 5)
      p += 0.03 * Vec3(normal(random), normal(random), normal(random));
    else
      rows.push_back(int(i));
    dirty.points.push_back(p);
  }
  for (Eigen::Index f = 0; f < clean.F.rows(); ++f)
    dirty.triangles.push_back({clean.F(f, 0), clean.F(f, 1), clean.F(f, 2)});
  const std::vector<Vec3> noisy(dirty.points.begin(),
                                dirty.points.begin() + std::ptrdiff_t(clean.V.rows()));
  add_loose(dirty, int(0.8 * kOutliers * double(noisy.size())), random);
  const bool floor = even(random) < 0.2;
  if (floor) add_floor(dirty, random);

  // Unit, axes, place.
  struct Unit {
    const char* name;
    double metres;
  };
  constexpr Unit kUnits[] = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}};
  const Unit& unit = kUnits[random() % 4];
  const int up = int(random() % 3);
  constexpr const char* kUps[] = {"Y up", "Z up", "-Z up"};
  Mat3 axes = Mat3::Identity();
  if (up == 1) axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  if (up == 2) axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const double facing = 2 * std::numbers::pi * even(random);
  out.unit = unit.metres;
  out.axes = axes * Eigen::AngleAxisd(facing, Vec3::UnitY()).toRotationMatrix();
  out.shift = out.axes *
              Vec3(2 * even(random) - 1, random() % 2 ? 0 : even(random), 2 * even(random) - 1) /
              out.unit;
  const auto to_file = [&](const Vec3& world) -> Vec3 {
    return out.axes * world / out.unit + out.shift;
  };
  out.mesh.V.resize(Eigen::Index(dirty.points.size()), 3);
  for (std::size_t i = 0; i < dirty.points.size(); ++i)
    out.mesh.V.row(Eigen::Index(i)) = to_file(dirty.points[i]).transpose();
  out.mesh.F.resize(Eigen::Index(dirty.triangles.size()), 3);
  for (std::size_t f = 0; f < dirty.triangles.size(); ++f)
    out.mesh.F.row(Eigen::Index(f)) << dirty.triangles[f][0], dirty.triangles[f][1],
        dirty.triangles[f][2];
  out.clean.resize(Eigen::Index(rows.size()), 3);
  out.noisy.resize(Eigen::Index(rows.size()), 3);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out.clean.row(Eigen::Index(r)) = to_file(clean.V.row(rows[r]).transpose()).transpose();
    out.noisy.row(Eigen::Index(r)) = to_file(noisy[std::size_t(rows[r])]).transpose();
  }
  out.truth.resize(posed.skin.rows(), 3);
  for (Eigen::Index i = 0; i < posed.skin.rows(); ++i)
    out.truth.row(i) = to_file(posed.skin.row(i).transpose()).transpose();
  for (const Landmark& joint : posed.joints)
    out.joints.push_back({joint.name, to_file(joint.position)});
  constexpr const char* kFormats[] = {"ply", "obj", "off", "stl"};
  out.format = kFormats[random() % 4];
  out.name =
      fmt::format("{} {:.0f}, {}{}, {} faces, {}, {}, {}{}", out.sex == Sex::male ? "man" : "woman",
                  person.body.age, pose.name, game ? " (game rig)" : "", clean.F.rows(), unit.name,
                  kUps[up], out.format, floor ? ", floor" : "");
  return out;
}

void write_scan(const std::filesystem::path& file, const TriMesh& mesh, const std::string& format) {
  std::ofstream out(file, std::ios::binary);
  out << (format == "stl"   ? stl_bytes(mesh)
          : format == "ply" ? ply_bytes(mesh)
                            : text_bytes(mesh, format == "obj"));
  if (!out.flush()) throw OutputError(file.string() + ": cannot be written");
}

}  // namespace ecorche
