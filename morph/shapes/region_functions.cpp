#include "morph/shapes/region_functions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {
namespace {

enum class Window { all, front, back, sides, bust, seat };

struct Region {
  std::string id;
  int measure = 0;
  double half = 0, tapered = 0, sd = 0;
  std::vector<double> profile, profile_weights, across;
  Window window = Window::all;
};

std::vector<double> numbers(const Table& table, int row, const char* column) {
  std::istringstream words(table.text(row, column));
  std::vector<double> out;
  for (double x = 0; words >> x;) out.push_back(x);
  if (!words.eof())
    throw InputError(fmt::format("{}: {} '{}': expected numbers with blanks between",
                                 table.where(row), column, table.text(row, column)));
  return out;
}

std::vector<Region> read_regions(const MeasureTable& measures, const std::filesystem::path& file) {
  static const std::map<std::string, Window> windows{
      {"all", Window::all},     {"front", Window::front}, {"back", Window::back},
      {"sides", Window::sides}, {"bust", Window::bust},   {"seat", Window::seat}};
  const Table table(file);
  std::vector<Region> out;
  for (int row = 0; row < table.rows(); ++row) {
    Region r;
    r.id = table.text(row, "id");
    r.measure = measures.at(table.text(row, "measure"));
    r.half = 1e-3 * table.number(row, "half_mm");
    r.tapered = table.number(row, "tapered");
    r.sd = 1e-3 * table.number(row, "sd_mm");
    r.profile = numbers(table, row, "profile");
    r.profile_weights = numbers(table, row, "weights");
    r.across = numbers(table, row, "across");
    if (r.profile_weights.empty()) r.profile_weights.assign(r.profile.size(), 1.0);
    const auto window = windows.find(table.text(row, "window"));
    if (window == windows.end() || r.profile.size() < 2 ||
        r.profile_weights.size() != r.profile.size() || !(r.half > 0))
      throw InputError(
          fmt::format("{}: region '{}': needs a known window, two or more profile controls with as "
                      "many weights, and half_mm > 0",
                      table.where(row), r.id));
    r.window = window->second;
    if ((r.window == Window::bust || r.window == Window::seat) && r.across.size() < 2)
      throw InputError(fmt::format("{}: region '{}': needs two or more controls across",
                                   table.where(row), r.id));
    out.push_back(std::move(r));
  }
  return out;
}

// Mean over the neighbours along edges, `rounds` times.
void smooth(const Triangles& F, std::vector<double>& value, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> sum(value.size(), 0.0), count(value.size(), 0.0);
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      for (int e = 0; e < 3; ++e) {
        const std::size_t a = F(f, e), b = F(f, (e + 1) % 3);
        sum[a] += value[b];
        count[a] += 1;
      }
    }
    for (std::size_t v = 0; v < value.size(); ++v)
      if (count[v] > 0) value[v] = 0.5 * (value[v] + sum[v] / count[v]);
  }
}

// Vertices that the plane's loop can grow into: how much each belongs to the part of the body that
// the loop lies on, 0 .. 1.
std::vector<double> membership(const BodyPackage& package, const std::vector<VertexPart>& parts,
                               int landmark) {
  const VertexPart own = parts[landmark];
  std::vector<double> share(parts.size(), 0.0);
  for (std::size_t v = 0; v < parts.size(); ++v) {
    bool joined = parts[v].part == own.part && parts[v].side == own.side;
    // The trunk's skin over hip and shoulder is moved by the limbs' bones; neck and trunk, thigh
    // and shank flow into each other.
    if (own.part == BodyPart::trunk || own.part == BodyPart::neck)
      joined = joined || parts[v].part == BodyPart::trunk || parts[v].part == BodyPart::neck ||
               parts[v].part == BodyPart::thigh;
    if (own.part == BodyPart::thigh || own.part == BodyPart::shank)
      joined = joined || (parts[v].side == own.side &&
                          (parts[v].part == BodyPart::thigh || parts[v].part == BodyPart::shank));
    if (own.part == BodyPart::upper_arm || own.part == BodyPart::forearm)
      joined = joined || (parts[v].side == own.side && (parts[v].part == BodyPart::upper_arm ||
                                                        parts[v].part == BodyPart::forearm));
    share[v] = joined ? 1 : 0;
  }
  smooth(package.triangles, share, 12);
  return share;
}

Points region_offsets(const BodyPackage& package, const TapeMeasure& tape, const Region& region,
                      const std::vector<VertexPart>& parts, const Points& V) {
  TapeTrace trace;
  tape.take(region.measure, V, nullptr, &trace);
  if (trace.empty() || trace[0].size() < 4)
    throw InputError(fmt::format("region '{}': its plane misses the skin", region.id));
  const std::vector<Vec3>& loop = trace[0];
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double width = 0;
  for (std::size_t i = 0; i + 1 < loop.size(); ++i) centre += loop[i] / double(loop.size() - 1);
  for (std::size_t i = 0; i + 1 < loop.size(); ++i)
    normal += (loop[i] - centre).cross(loop[i + 1] - centre);
  normal.normalize();
  const bool upright = std::abs(normal.y()) > 0.5;
  if (normal.y() < 0) normal = -normal;
  for (const Vec3& p : loop) width = std::max(width, std::abs(p.x() - centre.x()));
  const int landmark = tape.measure(region.measure).vertices[0];
  const std::vector<double> share = membership(package, parts, landmark);
  const bool limb = parts[landmark].side != Side::middle;
  const std::vector<double> ones(region.across.size(), 1.0);
  Points out = Points::Zero(V.rows(), 3);
  for (Eigen::Index v = 0; v < package.skin_size; ++v) {
    const Vec3 d = V.row(v).transpose() - centre;
    const double along = d.dot(normal), t = 0.5 + 0.5 * along / region.half;
    if (t <= 0 || t >= 1 || share[v] < 1e-3) continue;
    if (limb && upright && V(v, 0) * centre.x() < 0) continue;
    const Vec3 radial = d - along * normal;
    if (radial.norm() < 1e-6 || radial.norm() > 2.5 * width) continue;
    Vec3 direction = radial.normalized();
    const double turn = direction.z();  // 1 straight in front of the axis, -1 behind
    double amount = share[v] * tukey_window(t, region.tapered) *
                    rational_spline(region.profile, region.profile_weights, t);
    if (region.window == Window::front) amount *= std::max(0.0, turn) * std::max(0.0, turn);
    if (region.window == Window::back) amount *= std::min(0.0, turn) * std::min(0.0, turn);
    if (region.window == Window::sides) amount *= 1 - turn * turn;
    if (region.window == Window::bust || region.window == Window::seat) {
      const double facing = region.window == Window::bust ? 1 : -1;
      amount *= rational_spline(region.across, ones, std::min(1.0, std::abs(V(v, 0)) / width)) *
                std::max(0.0, facing * turn);
      direction = facing * Vec3::UnitZ();
    }
    out.row(v) = amount * direction.transpose();
  }
  return out;
}

}  // namespace

double rational_spline(std::span<const double> controls, std::span<const double> weights,
                       double u) {
  const int n = int(controls.size()), degree = std::min(3, n - 1), spans = n - degree;
  const auto knot = [&](int i) { return std::clamp((i - degree) / double(spans), 0.0, 1.0); };
  u = std::clamp(u, 0.0, 1.0);
  const int span = std::min(int(u * spans), spans - 1) + degree;
  double x[4], w[4];  // de Boor's algorithm on homogeneous controls
  for (int i = 0; i <= degree; ++i) {
    w[i] = weights[span - degree + i];
    x[i] = controls[span - degree + i] * w[i];
  }
  for (int level = 1; level <= degree; ++level) {
    for (int i = degree; i >= level; --i) {
      const double low = knot(span - degree + i), high = knot(span + 1 + i - level),
                   a = (u - low) / (high - low);
      x[i] = (1 - a) * x[i - 1] + a * x[i];
      w[i] = (1 - a) * w[i - 1] + a * w[i];
    }
  }
  return x[degree] / w[degree];
}

double tukey_window(double t, double tapered) {
  const double edge = std::min(t, 1 - t);
  if (edge <= 0) return 0;
  if (edge >= 0.5 * tapered) return 1;
  return 0.5 * (1 + std::cos(M_PI * (2 * edge / tapered - 1)));
}

std::vector<RegionFunction> region_functions(const BodyPackage& package, const TapeMeasure& tape,
                                             const Points& V, const std::filesystem::path& folder) {
  const std::vector<VertexPart> parts = vertex_parts(package);
  std::vector<RegionFunction> out;
  for (const Region& region : read_regions(tape.table(), folder / "regions.csv")) {
    Points one = region_offsets(package, tape, region, parts, V);
    Points both = one;
    const bool limb = parts[tape.measure(region.measure).vertices[0]].side != Side::middle;
    for (int v = 0; v < package.skin_size; ++v) {
      Vec3 mirrored = one.row(package.mirror[v]);
      mirrored.x() = -mirrored.x();
      both.row(v) = limb ? Vec3(one.row(v).transpose() + mirrored)
                         : Vec3(0.5 * (one.row(v).transpose() + mirrored));
    }
    out.push_back({region.id, region.sd * both});
  }
  return out;
}

}  // namespace ecorche::inline v1
