#include "anatomy/authoring/resample_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/authoring/trace_section.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/edge_paths.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kMostScale = 1.05;  // of all radii

// Fractions of the line's length at which it is cut: closer where the muscle tapers.
std::vector<double> slice_fractions(int count) {
  std::vector<double> out;
  for (int k = 0; k < count; ++k) {
    const double even = (k + 0.5) / count, crowded = 0.5 - 0.5 * std::cos(std::numbers::pi * even);
    out.push_back(0.5 * (even + crowded));
  }
  return out;
}

// The frames along a line turn as little as they can.
std::vector<CutPlane> planes_along(const Bezier& line, const std::vector<double>& parameters) {
  std::vector<CutPlane> out;
  Vec3 u = bezier_tangent(line, parameters.front()).unitOrthogonal();
  for (double t : parameters) {
    const Vec3 normal = bezier_tangent(line, t);
    if (!out.empty()) u = Quat::FromTwoVectors(out.back().normal, normal) * u;
    u = (u - u.dot(normal) * normal).normalized();
    out.push_back({bezier_point(line, t), u, normal.cross(u), normal});
  }
  return out;
}

// The action line: through the middles of surface bands first, then through the middles of its own
// cross-sections.
Bezier action_line(const MeshSections& sections, const TriMesh& mesh, const Vec3& origin,
                   const Vec3& insertion, double gap, const ResampleOptions& options) {
  std::vector<Vec3> middles = middle_line(mesh, origin, insertion, 30);
  Bezier line;
  for (int round = 0; round < 4; ++round) {
    middles.insert(middles.begin(), origin);
    middles.push_back(insertion);
    line = fit_bezier(middles, options.control_points);
    middles.clear();
    if (round == 3) break;
    for (const CutPlane& plane : planes_along(line, bezier_parameters(line, slice_fractions(24)))) {
      const Section section = sections.section(plane.point, plane.normal, gap);
      const SectionOutline outline = outline_of(plane, section, 24);
      if (outline.area > 0 && outline.missed < 12) middles.push_back(plane.at(outline.from));
    }
  }
  return line;
}

// Slices that met nothing take the mean of their neighbours' shapes, weighted by how near they are.
void fill_gaps(std::vector<std::optional<Ellipse>>& found, const std::vector<CutPlane>& planes) {
  const auto known = found;
  const int n = found.size();
  const auto next = [&](int k, int step) {
    while (k >= 0 && k < n && !known[k]) k += step;
    return k;
  };
  for (int k = 0; k < n; ++k) {
    if (found[k]) continue;
    int before = next(k, -1), after = next(k, 1);
    if (before < 0) before = after;
    if (after >= n) after = before;
    const Ellipse &a = *known[before], &b = *known[after];
    const double share = after == before ? 0 : double(k - before) / (after - before);
    Ellipse e = share < 0.5 ? a : b;
    const CutPlane& plane = planes[k];
    const auto aside = [&](const Ellipse& from, int index) {
      return Vec3(from.center - planes[index].point);
    };
    const Vec3 offset = (1 - share) * aside(a, before) + share * aside(b, after);
    e.center = plane.point + offset - offset.dot(plane.normal) * plane.normal;
    e.axes = Quat::FromTwoVectors(e.axes.col(2), plane.normal) * e.axes;
    e.radii = (1 - share) * a.radii + share * b.radii;
    for (std::size_t i = 0; i < e.outline.size(); ++i)
      e.outline[i] = float((1 - share) * double(a.outline[i]) + share * double(b.outline[i]));
    found[k] = e;
  }
}

// Rings of equal eccentric angles: the sections' frames follow one another without a jump.
TriMesh loft(const std::vector<Ellipse>& slices, const Vec3& origin, const Vec3& insertion,
             int ring) {
  const int n = slices.size();
  TriMesh out{Points(n * ring + 2, 3), Triangles(2 * n * ring, 3)};
  // gives the polygon the ellipse's area
  const double whole = std::sqrt(kTurn / (ring * std::sin(kTurn / ring)));
  for (int k = 0; k < n; ++k) {
    const auto& e = slices[k];
    for (int j = 0; j < ring; ++j) {
      const double angle = kTurn * j / ring,
                   factor = whole * outline_factor(e.outline, double(j) * kOutlinePoints / ring);
      const Vec3 arm = std::cos(angle) * e.radii.x() * e.axes.col(0) +
                       std::sin(angle) * e.radii.y() * e.axes.col(1);
      out.V.row(k * ring + j) = (e.center + factor * arm).transpose();
    }
  }
  const int first = n * ring, last = first + 1;
  out.V.row(first) = origin.transpose();
  out.V.row(last) = insertion.transpose();
  Eigen::Index f = 0;
  for (int j = 0; j < ring; ++j) {
    const int next = (j + 1) % ring;
    out.F.row(f++) << first, next, j;
    for (int k = 0; k + 1 < n; ++k) {
      out.F.row(f++) << k * ring + j, k * ring + next, (k + 1) * ring + next;
      out.F.row(f++) << k * ring + j, (k + 1) * ring + next, (k + 1) * ring + j;
    }
    out.F.row(f++) << last, (n - 1) * ring + j, (n - 1) * ring + next;
  }
  return out;
}

// Length of the outlines beside the one that is followed, as far as they lie abreast of this plane:
// not where a muscle that bends back upon itself meets its plane again.
double branches(const Section& section, const std::vector<CutPlane>& planes,
                const CutPlane& plane) {
  double sum = 0;
  for (const auto& [a, b] : section.others) {
    const Vec3 middle = 0.5 * (a + b);
    const auto off = [&](const CutPlane& at) { return (middle - at.point).squaredNorm(); };
    const auto nearest =
        std::min_element(planes.begin(), planes.end(),
                         [&](const CutPlane& p, const CutPlane& q) { return off(p) < off(q); });
    if (std::abs(nearest - planes.begin() - (&plane - planes.data())) <= 2) sum += (b - a).norm();
  }
  return sum;
}

void check_options(const ResampleOptions& o) {
  if (o.control_points < 0 || o.control_points > 12)
    throw std::invalid_argument(
        fmt::format("{} control points: expected 0 .. 12", o.control_points));
  if (o.slices < 3 || o.slices > 200)
    throw std::invalid_argument(fmt::format("{} slices: expected 3 .. 200", o.slices));
  if (o.rays < 8 || o.rays > 1000)
    throw std::invalid_argument(fmt::format("{} rays: expected 8 .. 1000", o.rays));
  if (o.ring < 8 || o.ring > 200)
    throw std::invalid_argument(fmt::format("{} vertices a ring: expected 8 .. 200", o.ring));
}

void check_ends(const MeshSections& sections, double size, const Vec3& origin,
                const Vec3& insertion) {
  if (!((origin - insertion).norm() > 1e-3 * size))
    throw UnfitError("origin and insertion lie in one place; give the muscle's two ends");
  for (const auto& [name, end] : {std::pair("origin", origin), std::pair("insertion", insertion)}) {
    const double away = sections.distance(end);
    if (away > 0.1 * size) {
      throw UnfitError(
          fmt::format("the {} {:g},{:g},{:g} lies {:g} away from a mesh of size {:g}; give it in "
                      "the mesh's own units and axes",
                      name, end.x(), end.y(), end.z(), away, size));
    }
  }
}

// Chords between rings and slices cut off a little everywhere: all radii grow alike until the loft
// holds what the mesh does, within bounds that leave a bad fit visible. Returns the factor.
double keep_volume(double volume, const Vec3& origin, const Vec3& insertion, int ring,
                   Resampled& out) {
  double factor = 1;
  for (int round = 0; round < 2; ++round) {
    const double now = mesh_volume(out.loft);
    if (!(now > 0)) break;
    const double wish = std::clamp(factor * std::sqrt(volume / now), 1 / kMostScale, kMostScale);
    for (Ellipse& slice : out.slices) slice.radii *= wish / factor;
    factor = wish;
    out.loft = loft(out.slices, origin, insertion, ring);
  }
  return factor;
}

}  // namespace

Resampled resample_muscle(const TriMesh& mesh, const Vec3& origin, const Vec3& insertion,
                          const ResampleOptions& options) {
  check_options(options);
  const TriMesh whole = welded(mesh);
  const MeshSections sections(whole);
  const double size = (whole.V.colwise().maxCoeff() - whole.V.colwise().minCoeff()).norm();
  check_ends(sections, size, origin, insertion);
  const double gap = 0.004 * size;

  Resampled out;
  ResampleReport& report = out.report;
  out.line = action_line(sections, whole, origin, insertion, gap, options);
  out.parameters = bezier_parameters(out.line, slice_fractions(options.slices));
  const std::vector<CutPlane> planes = planes_along(out.line, out.parameters);
  std::vector<SectionOutline> outlines;
  double followed = 0, beside = 0;
  for (const CutPlane& plane : planes) {
    const Section section = sections.section(plane.point, plane.normal, gap);
    outlines.push_back(outline_of(plane, section, options.rays));
    for (const auto& [a, b] : section.cuts) followed += (b - a).norm();
    beside += branches(section, planes, plane);
    report.hidden += outlines.back().hidden / options.slices;
    report.rays += options.rays;
    report.missed_rays += outlines.back().missed;
  }
  report.forked = beside / std::max(followed + beside, 1e-300);
  std::vector<std::optional<Ellipse>> found = outlined_sections(planes, outlines);
  for (const auto& slice : found) report.empty_slices += !slice;
  if (2 * report.empty_slices > options.slices) {
    throw UnfitError(fmt::format(
        "{} of {} slices met no surface; origin and insertion may not be the ends of this muscle",
        report.empty_slices, options.slices));
  }
  fill_gaps(found, planes);
  for (const auto& slice : found) out.slices.push_back(*slice);
  out.loft = loft(out.slices, origin, insertion, options.ring);
  report.length = bezier_length(out.line);
  report.mesh_volume = std::abs(mesh_volume(whole));
  report.mesh_closed = is_closed(whole.F);
  if (report.mesh_closed)
    report.scale = keep_volume(report.mesh_volume, origin, insertion, options.ring, out);
  report.loft_volume = mesh_volume(out.loft);
  report.loft_to_mesh = surface_distance(out.loft, sections);
  report.mesh_to_loft = surface_distance(whole, MeshSections(out.loft));
  return out;
}

Strip make_strip(const Resampled& resampled, int origin_joint, int insertion_joint) {
  const int inner = std::max<int>(1, int(resampled.line.controls.size()) - 2);
  std::vector<double> fractions;
  for (int k = 0; k <= inner + 1; ++k) fractions.push_back(double(k) / (inner + 1));
  std::vector<PathPoint> path;
  for (std::size_t k = 0; k < fractions.size(); ++k) {
    const double t = bezier_parameters(resampled.line, {&fractions[k], 1})[0];
    path.push_back(
        {bezier_point(resampled.line, t), {origin_joint, insertion_joint}, 1 - fractions[k]});
  }
  path.front() = {path.front().rest, {origin_joint, -1}, 1};
  path.back() = {path.back().rest, {insertion_joint, -1}, 1};
  std::vector<Station> stations;
  const double whole = line_length(path);
  std::vector<double> s;
  for (double t : resampled.parameters) {
    const Bezier& line = resampled.line;
    Bezier part = line;  // the fraction of the length up to t, by cutting the curve there
    for (std::size_t level = 1; level < part.controls.size(); ++level) {
      for (std::size_t k = part.controls.size() - 1; k >= level; --k)
        part.controls[k] = (1 - t) * part.controls[k - 1] + t * part.controls[k];
    }
    s.push_back(std::clamp(bezier_length(part) / resampled.report.length, 0.0, 1.0));
  }
  const auto points = line_points(path, s);
  for (std::size_t k = 0; k < s.size(); ++k) {
    const Ellipse& e = resampled.slices[k];
    stations.push_back({s[k], e.center - points[k], e.axes.col(0), e.radii});
  }
  Strip strip = make_strip(std::move(path), stations);
  set_slices(strip, resampled.slices);
  strip.rest_length = whole;
  return strip;
}

}  // namespace ecorche::inline v1
