#include "app/pages/registration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/queries/nearest_surface.h"
#include "app/pages/html_page.h"
#include "viewer/camera.h"
#include "viewer/draw_mesh.h"
#include "viewer/gl/renderer.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr Eigen::Index kMeasured = 100000;  // scan points
constexpr double kFullDistance = 0.02;      // m, the strongest colour
constexpr int kCellWidth = 300, kCellHeight = 560;

std::string region_name(const VertexPart& part) {
  constexpr const char* kNames[] = {"head", "neck",  "trunk", "upper_arm", "forearm",
                                    "hand", "thigh", "shank", "foot"};
  return std::string(kNames[int(part.part)]) + side_suffix(part.side);
}

double sorted_quantile(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? NAN : sorted[std::size_t(share * double(sorted.size() - 1))];
}

// Pale to yellow to red.
Vec3f distance_color(double distance) {
  const float t = float(std::clamp(distance / kFullDistance, 0.0, 1.0));
  const Vec3f none(0.80f, 0.83f, 0.86f), some(0.98f, 0.80f, 0.25f), full(0.80f, 0.12f, 0.10f);
  return t < 0.4f ? Vec3f(none + t / 0.4f * (some - none))
                  : Vec3f(some + (t - 0.4f) / 0.6f * (full - some));
}

Points to_world(const Points& scan_points, const Scan& scan, const Registration& found) {
  Points out = found.scale / scan.unit * scan_points * found.axes.transpose();
  out.rowwise() += found.shift.transpose();
  return out;
}

// Without triangles, points are drawn as small tetrahedra.
DrawMesh cloud_mesh(const Points& points) {
  DrawMesh out;
  const Eigen::Index step = std::max<Eigen::Index>(1, points.rows() / 60000);
  const float size = 0.004f;
  const Vec3f corners[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  for (Eigen::Index i = 0; i < points.rows(); i += step) {
    const std::uint32_t first = std::uint32_t(out.positions.size());
    for (const Vec3f& corner : corners) {
      out.positions.push_back(points.row(i).transpose().cast<float>() + size * corner);
      out.normals.push_back(corner.normalized());
    }
    for (const auto& f :
         {Triangle32(0, 1, 2), Triangle32(0, 2, 3), Triangle32(0, 3, 1), Triangle32(1, 3, 2)})
      out.triangles.push_back(f.array() + first);
  }
  return out;
}

class RegistrationPhotos {
 public:
  // Everything that is drawn lies between these corners of the world.
  RegistrationPhotos(const Vec3& low, const Vec3& high) : low_(low), high_(high) {}

  Image take(const DrawMesh& mesh, const Vec3f& color, const std::string& view,
             const std::string& title) {
    const Vec3 middle = 0.5 * (low_ + high_);
    const double high =
        std::max(1.1 * (high_.y() - low_.y()),
                 1.1 * (high_ - low_).head<3>().maxCoeff() * kCellHeight / (2.0 * kCellWidth));
    return shoot(mesh, color, view, title, middle, high);
  }

  // A square about a point, from outside along `away`.
  Image close_up(const DrawMesh& mesh, const Vec3f& color, const Vec3& at, const Vec3& away,
                 double width) {
    const double azimuth = std::atan2(away.x(), away.z()),
                 elevation = std::asin(std::clamp(away.normalized().y(), -0.9, 0.9));
    return shoot(
        mesh, color,
        fmt::format("{:.1f},{:.1f}", kDegreesPerRadian * azimuth, kDegreesPerRadian * elevation),
        "", at, width * kCellHeight / kCellWidth);
  }

 private:
  Image shoot(const DrawMesh& mesh, const Vec3f& color, const std::string& view,
              const std::string& title, const Vec3& middle, double high) {
    DrawList list;
    list.lighting.follows_camera = true;
    list.lighting.ambient_strength = 0.55f;
    list.background_top = list.background_bottom = Vec3f(1.2f, 1.2f, 1.2f);
    list.meshes = {mesh};
    DrawItem item;
    item.surface.color = color;
    list.items = {item};
    const ViewAngles angles = view_angles(view);
    list.camera = orbit_camera(middle.cast<float>(), float(std::max(high, 0.5)), angles.azimuth,
                               angles.elevation, 0.3f);
    list.camera.ortho_height = float(high);
    Image out = renderer_.render(list, kCellWidth, kCellHeight);
    draw_text(out, title, 0.5f * kCellWidth, 18, {.size = 14, .align = Align::center});
    return out;
  }

  Renderer renderer_;
  Vec3 low_, high_;
};

Image side_by_side(const std::vector<Image>& parts) {
  Image whole = make_image(int(parts.size()) * kCellWidth, kCellHeight);
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (int row = 0; row < kCellHeight; ++row)
      std::copy_n(parts[i].pixel(0, row), 4 * std::size_t(kCellWidth),
                  whole.pixel(int(i) * kCellWidth, row));
  return whole;
}

// The worst places, each some 12 cm from the others: vertices of the skin.
std::vector<int> worst_places(const RegistrationDistances& distances, const Points& posed) {
  std::vector<int> order(distances.skin.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return distances.skin[std::size_t(a)] > distances.skin[std::size_t(b)];
  });
  std::vector<int> out;
  for (const int i : order) {
    if (out.size() == 4 || distances.skin[std::size_t(i)] <= 0) break;
    if (std::all_of(out.begin(), out.end(),
                    [&](int o) { return (posed.row(o) - posed.row(i)).norm() > 0.12; }))
      out.push_back(i);
  }
  return out;
}

std::string millimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.1f}", 1e3 * metres) : "";
}

void add_figures(HtmlPage& page, const Scan& scan, const Registration& found,
                 const RegistrationDistances& distances, double stature) {
  const RegistrationReport& report = found.report;
  const std::vector<std::string> header{"mm", "mean", "median", "95 % below", "largest"};
  const auto row = [](const std::string& name, const DistanceFigures& d) {
    return std::vector<std::string>{name, millimetres(d.mean), millimetres(d.median),
                                    millimetres(d.p95), millimetres(d.max)};
  };
  page.add_heading("How far apart");
  page.add_table(header, std::vector<std::vector<std::string>>{
                             row("scan to body", report.scan_to_body),
                             row("body to scan, where it was seen", report.body_to_scan)});
  page.add_heading("What was assumed and found");
  const std::vector<std::string> none{"", ""};
  page.add_table(
      none,
      std::vector<std::vector<std::string>>{
          {"one unit of the file",
           fmt::format("{:.6g} m{}", found.scale, scan.unit_known ? "" : ", guessed")},
          {"up in the file", axis_word(found.axes.transpose() * Vec3::UnitY())},
          {"front in the file", axis_word(found.axes.transpose() * Vec3::UnitZ())},
          {"stature", fmt::format("{:.1f} cm", 100 * stature)},
          {"mass by volume", fmt::format("{:.1f} kg", found.body.mass)},
          {"skin that the scan does not show", fmt::format("{:.1f} %", 100 * report.unseen)},
          {"doubt of the pose: 0 sure, 1 another is as good", fmt::format("{:.2f}", report.doubt)},
          {"shape: standard deviations a coefficient (people: about 1)",
           fmt::format("{:.2f}", report.shape_distance)},
          {"joints' turns over usual ones (people who stand: up to 0.7)",
           fmt::format("{:.2f}", report.turn_deviation)}});
  page.add_heading("By region");
  const std::vector<std::string> columns{"region", "scan points", "mean, mm",
                                         "median", "95 % below",  "not seen, %"};
  std::vector<std::vector<std::string>> rows;
  for (const RegionDistance& region : distances.regions)
    rows.push_back({region.region, fmt::format("{}", region.points), millimetres(region.mean),
                    millimetres(region.median), millimetres(region.p95),
                    fmt::format("{:.0f}", 100 * region.unseen)});
  page.add_table(columns, rows);
}

}  // namespace

RegistrationDistances registration_distances(const Scan& scan, const Registration& found,
                                             const BodyPackage& package) {
  const std::vector<VertexPart> parts = vertex_parts(package);
  RegistrationDistances out;
  const Eigen::Index step = std::max<Eigen::Index>(1, scan.points.rows() / kMeasured);
  Points some((scan.points.rows() + step - 1) / step, 3);
  for (Eigen::Index i = 0; i < some.rows(); ++i) some.row(i) = scan.points.row(i * step);
  out.points = to_world(some, scan, found);
  out.distance.resize(std::size_t(some.rows()));
  std::vector<int> nearest(out.distance.size());
  const NearestSurface surface({found.posed, package.triangles});
  parallel_for_ranges(out.distance.size(), 256, Threads::all,
                      [&](std::size_t first, std::size_t last) {
                        int hint = -1;
                        for (std::size_t i = first; i < last; ++i) {
                          const SurfacePoint hit =
                              surface.nearest(out.points.row(Eigen::Index(i)).transpose(), hint);
                          hint = hit.triangle;
                          out.distance[i] = hit.distance;
                          nearest[i] = package.triangles(hit.triangle, 0);
                        }
                      });
  const std::size_t n = std::size_t(found.posed.rows());
  out.skin.assign(n, 0);
  std::vector<int> count(n, 0);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    out.skin[std::size_t(nearest[i])] += out.distance[i];
    ++count[std::size_t(nearest[i])];
  }
  // A few points a vertex; those without take the mean of their neighbours'.
  for (int round = 0; round < 3; ++round)
    for (Eigen::Index f = 0; f < package.triangles.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        const std::size_t a = std::size_t(package.triangles(f, k)),
                          b = std::size_t(package.triangles(f, (k + 1) % 3));
        if (count[a] > 0 && count[b] == 0 && found.seen[b])
          out.skin[b] = out.skin[a] / count[a], count[b] = 1;
      }
  for (std::size_t i = 0; i < n; ++i)
    out.skin[i] = count[i] > 0 && found.seen[i] ? out.skin[i] / count[i] : -1;

  std::vector<std::string> names;
  for (const VertexPart& part : parts)
    if (const std::string name = region_name(part);
        std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    RegionDistance region;
    region.region = name;
    std::vector<double> own;
    for (std::size_t i = 0; i < nearest.size(); ++i)
      if (region_name(parts[std::size_t(nearest[i])]) == name) own.push_back(out.distance[i]);
    std::sort(own.begin(), own.end());
    region.points = int(own.size());
    region.mean = std::accumulate(own.begin(), own.end(), 0.0) / double(own.size());
    region.median = sorted_quantile(own, 0.5);
    region.p95 = sorted_quantile(own, 0.95);
    int all = 0, unseen = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (region_name(parts[i]) == name) ++all, unseen += !found.seen[i];
    region.unseen = double(unseen) / std::max(all, 1);
    out.regions.push_back(region);
  }
  return out;
}

std::string axis_word(const Vec3& direction) {
  int axis = 0;
  const double most = direction.cwiseAbs().maxCoeff(&axis);
  if (most < std::cos(20 * kDegree) * direction.norm()) return "leaning";
  return std::string(direction[axis] < 0 ? "-" : "+") + "XYZ"[axis];
}

void report_registration(const Scan& scan, const Registration& found,
                         const RegistrationDistances& distances, double stature, Report& report) {
  const RegistrationReport& figures = found.report;
  for (const std::string& text : scan.notes) report.append_text("register.notes", text);
  for (const std::string& text : figures.doubts) report.append_text("register.doubts", text);
  report.set("register.scan_points", int(scan.points.rows()));
  for (const auto& [name, d] : {std::pair{"scan_to_body", figures.scan_to_body},
                                std::pair{"body_to_scan", figures.body_to_scan}}) {
    const std::string stem = fmt::format("register.{}.", name);
    report.set(stem + "mean", d.mean);
    report.set(stem + "median", d.median);
    report.set(stem + "p95", d.p95);
    report.set(stem + "max", d.max);
  }
  for (const RegionDistance& region : distances.regions) {
    const std::string stem = "register.regions." + region.region + ".";
    report.set(stem + "mean", region.mean);
    report.set(stem + "median", region.median);
    report.set(stem + "p95", region.p95);
    report.set(stem + "unseen", region.unseen);
  }
  report.set("register.unseen", figures.unseen);
  report.set("register.unit_m", found.scale);
  report.set_flag("register.unit_known", scan.unit_known);
  report.set("register.up", axis_word(found.axes.transpose() * Vec3::UnitY()));
  report.set("register.front", axis_word(found.axes.transpose() * Vec3::UnitZ()));
  report.set("register.doubt", figures.doubt);
  report.set("register.shape_distance", figures.shape_distance);
  report.set("register.turn_deviation", figures.turn_deviation);
  std::vector<double> axes, shift(found.shift.data(), found.shift.data() + 3);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) axes.push_back(found.axes(r, c));
  report.set_list("register.world_from_file.axes", axes);
  report.set("register.world_from_file.scale", found.scale);
  report.set_list("register.world_from_file.shift", shift);
  const auto list = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  for (std::size_t j = 0; j < found.pose.joints.size(); ++j) {
    const std::string stem = "register.joints." + found.pose.joints[j] + ".";
    const Vec3 in_file = found.axes.transpose() * (found.pose.posed[j] - found.shift) / found.scale;
    const Eigen::AngleAxisd turn(found.pose.rotations[j]);
    report.set_list(stem + "position", list(in_file));
    report.set_list(stem + "turn_deg", list(kDegreesPerRadian * turn.angle() * Vec3(turn.axis())));
  }
  report.set("body.sex", found.body.sex == Sex::male ? "male" : "female");
  report.set("body.stature", stature);
  report.set("body.mass", found.body.mass);
  report.set("timings_ms.pose", figures.pose_ms);
  report.set("timings_ms.shape", figures.shape_ms);
  report.set("timings_ms.surface", figures.surface_ms);
}

std::string registration_page(const std::string& title, const Scan& scan, const Registration& found,
                              const RegistrationDistances& distances,
                              const RegistrationStages& stages, const BodyPackage& package,
                              double stature) {
  HtmlPage page(title);
  for (const std::string& text : found.report.doubts) page.add_paragraph("Doubtful: " + text);
  const Points world = to_world(scan.points, scan, found);
  const DrawMesh scanned = scan.F.rows() > 0 ? make_draw_mesh({world, scan.F}) : cloud_mesh(world);
  const DrawMesh body = make_draw_mesh({found.posed, package.triangles});
  DrawMesh colored = body;
  for (const double distance : distances.skin)
    colored.colors.push_back(distance < 0 ? Vec3f(0.55f, 0.62f, 0.80f) : distance_color(distance));
  const Vec3 low = found.posed.colwise().minCoeff(), high = found.posed.colwise().maxCoeff();
  RegistrationPhotos photos(low, high);
  const Vec3f scan_color(0.70f, 0.74f, 0.78f), skin_color(0.86f, 0.74f, 0.66f);
  page.add_heading("Scan and body");
  for (const char* view : {"front", "left", "back"})
    page.add_picture(
        encode_png(side_by_side({photos.take(scanned, scan_color, view, "scan"),
                                 photos.take(body, skin_color, view, "body, in its pose"),
                                 photos.take(colored, skin_color, view, "distance")})),
        fmt::format("From the {}: the scan as it was cleaned, the body on it, and how far the scan "
                    "lies from it: grey 0, yellow 8 mm, red 2 cm or more; blue was not seen",
                    view));
  std::vector<Image> strip;
  for (const auto& [name, points] : stages)
    strip.push_back(photos.take(make_draw_mesh({to_world(points, scan, found), package.triangles}),
                                skin_color, "front", name));
  strip.push_back(photos.take(body, skin_color, "front", "registered"));
  page.add_heading("The way there");
  page.add_picture(encode_png(side_by_side(strip)),
                   "The body as each stage began, and as it was left");
  DrawMesh rest = make_draw_mesh({found.body.skin.V, package.triangles});
  page.add_heading("At rest");
  const Vec3 rest_low = found.body.skin.V.colwise().minCoeff(),
             rest_high = found.body.skin.V.colwise().maxCoeff();
  RegistrationPhotos rest_photos(rest_low, rest_high);
  std::vector<Image> views;
  for (const char* view : {"front", "left", "back"})
    views.push_back(rest_photos.take(rest, skin_color, view, view));
  page.add_picture(encode_png(side_by_side(views)), "The same person in the base mesh's rest pose");
  add_figures(page, scan, found, distances, stature);
  const std::vector<int> worst = worst_places(distances, found.posed);
  if (!worst.empty()) page.add_heading("The worst places");
  for (const int i : worst) {
    const Vec3 at = found.posed.row(i), away = body.normals[std::size_t(i)].cast<double>();
    page.add_picture(
        encode_png(side_by_side({photos.close_up(scanned, scan_color, at, away, 0.25),
                                 photos.close_up(colored, skin_color, at, away, 0.25)})),
        fmt::format("{}: {:.1f} mm", region_name(vertex_parts(package)[std::size_t(i)]),
                    1e3 * distances.skin[std::size_t(i)]));
  }
  return page.to_string();
}

}  // namespace ecorche
