#include "app/edit/attachment_actions.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include "anatomy/authoring/muscle_ends.h"
#include "anatomy/authoring/muscle_text.h"
#include "anatomy/authoring/resample_mesh.h"
#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/document/own_mesh.h"
#include "app/edit/muscle_actions.h"

namespace ecorche {
namespace {

constexpr std::size_t kMostPlaces = 400;
constexpr double kThinnest = 2e-3;      // m, of an end
constexpr double kFemaleOfMale = 0.62;  // as new_muscle has it

// Where a hand has painted, in the source frame.
struct PaintedArea {
  std::string bone;  // that most of it lies on
  Vec3 middle = Vec3::Zero();
  Vec3 along = Vec3::UnitX(), across = Vec3::UnitY();  // unit, ways in which it reaches farthest
  std::vector<Vec3> places;
};

PaintedArea painted_area(Workshop& workshop, const Document& document, const std::string& text) {
  PaintedArea out;
  std::map<std::string, int> bones;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ';');) {
    const TablePoint point = read_place(workshop, document, word);
    out.places.push_back(position(*document.frame, point));
    ++bones[document.frame->landmarks[std::size_t(point.landmark)].carrier];
  }
  if (out.places.empty() || out.places.size() > kMostPlaces)
    throw InputError(fmt::format("argument 'places': {} places; expected 1 .. {}, with ; between",
                                 out.places.size(), kMostPlaces));
  out.bone =
      std::ranges::max_element(bones, {}, [](const auto& each) { return each.second; })->first;
  for (const Vec3& place : out.places) out.middle += place / double(out.places.size());
  Mat3 spread = 1e-12 * Mat3::Identity();
  for (const Vec3& place : out.places)
    spread += (place - out.middle) * (place - out.middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
  out.along = axes.eigenvectors().col(2);
  out.across = axes.eigenvectors().col(1);
  return out;
}

double extent(const std::vector<Vec3>& places, const Vec3& way) {
  double low = 0, high = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double at = places[k].dot(way);
    low = k == 0 ? at : std::min(low, at);
    high = k == 0 ? at : std::max(high, at);
  }
  return high - low;
}

// Means of as many equal shares of the area along its length, onto the bone.
std::vector<TablePoint> spread_over(Workshop& workshop, const Document& document,
                                    const PaintedArea& area, std::size_t count) {
  std::vector<Vec3> sorted = area.places;
  std::ranges::sort(sorted, {}, [&](const Vec3& place) { return place.dot(area.along); });
  std::vector<TablePoint> out;
  for (std::size_t k = 0; k < count; ++k) {
    // at least one place each, also where there are fewer places than strips
    const std::size_t last = sorted.size() - 1, begin = k * sorted.size() / count,
                      end = std::clamp((k + 1) * sorted.size() / count, begin + 1, last + 1);
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = begin; i < end; ++i) mean += sorted[i] / double(end - begin);
    out.push_back(place_on_bone(workshop, document, area.bone, mean));
  }
  return out;
}

// Strips in the order in which their ends lie along the area.
std::vector<std::size_t> order_along(const MuscleTable& frame, const TableMuscle& muscle,
                                     bool origin, const Vec3& along) {
  std::vector<std::size_t> out(muscle.strips.size());
  std::iota(out.begin(), out.end(), 0);
  std::ranges::stable_sort(out, {}, [&](std::size_t k) {
    const std::vector<TablePoint>& path = muscle.strips[k].path;
    return position(frame, origin ? path.front() : path.back()).dot(along);
  });
  return out;
}

TablePoint near_place(const MuscleTable& frame, const std::string& bone, const Vec3& place) {
  int best = -1;
  for (int i = 0; i < int(frame.landmarks.size()); ++i)
    if (frame.landmarks[std::size_t(i)].carrier == bone &&
        (best < 0 || (frame.landmarks[std::size_t(i)].position - place).norm() <
                         (frame.landmarks[std::size_t(best)].position - place).norm()))
      best = i;
  return {best, place - frame.landmarks[std::size_t(best)].position};
}

// An end on the nearest of the bones that places can be said on.
TablePoint on_nearest_bone(Workshop& workshop, const Document& document, const Vec3& place) {
  std::optional<TablePoint> best;
  double least = 0;
  for (const std::string& bone : workshop.bone_names()) {
    const auto known = std::ranges::find(document.frame->landmarks, bone, &SourceLandmark::carrier);
    if (known == document.frame->landmarks.end()) continue;
    const double distance = (workshop.on_bone(bone, place) - place).norm();
    if (best && distance >= least) continue;
    least = distance;
    best = place_on_bone(workshop, document, bone, place);
  }
  if (!best) throw InputError("there is no bone that a muscle could end on");
  return *best;
}

Resampled resampled(const TriMesh& mesh, const std::optional<std::pair<Vec3, Vec3>>& ends,
                    const ResampleOptions& options) {
  return ends ? resample_muscle(mesh, ends->first, ends->second, options)
              : resample_muscle(mesh, options);
}

// The strip of a resampled mesh: points of its line by the bones of its ends, sections as found.
TableStrip strip_of_mesh(Workshop& workshop, const Document& document, const Resampled& found,
                         int points) {
  const MuscleTable& frame = *document.frame;
  TableStrip strip;
  const Vec3 begin = found.line.controls.front(), end = found.line.controls.back();
  strip.path.push_back(on_nearest_bone(workshop, document, begin));
  const TablePoint last = on_nearest_bone(workshop, document, end);
  std::vector<double> shares;
  for (int k = 1; k <= points; ++k) shares.push_back(double(k) / double(points + 1));
  const std::vector<double> at = bezier_parameters(found.line, shares);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const TablePoint& holds = shares[k] < 0.5 ? strip.path.front() : last;
    strip.path.push_back(near_place(frame, frame.landmarks[std::size_t(holds.landmark)].carrier,
                                    bezier_point(found.line, at[k])));
  }
  strip.path.push_back(last);
  strip.belly_begin = 0;
  strip.belly_end = 1;
  for (std::size_t k = 0; k < found.slices.size(); ++k) {
    const Ellipse& slice = found.slices[k];
    const double s = double(k) / double(found.slices.size() - 1);
    strip.sections.push_back(
        {s, slice.radii.cwiseMax(0.5 * kThinnest), slice.axes.col(0).normalized()});
  }
  return strip;
}

}  // namespace

void arguments(Arguments& a, PaintEnd& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "whose end is painted; else the picked one");
  a.choice("end", x.end, {"origin", "insertion"}, Need::required, "that is meant");
  a.text("places", "places", x.places, Need::required,
         "of the area, with ; between: BONE@L,U,F;BONE@L,U,F; ...");
}

Document apply(Workshop& workshop, const Document& document, const PaintEnd& x) {
  const MeantMuscle meant = meant_muscle(document, x.muscle);
  const PaintedArea area = painted_area(workshop, document, x.places);
  const bool origin = x.end == "origin";
  return with_change(document, meant, [&](TableMuscle& muscle) {
    const std::vector<TablePoint> ends =
        spread_over(workshop, document, area, muscle.strips.size());
    const std::vector<std::size_t> order = order_along(*document.frame, muscle, origin, area.along);
    for (std::size_t k = 0; k < order.size(); ++k) {
      std::vector<TablePoint>& path = muscle.strips[order[k]].path;
      (origin ? path.front() : path.back()) = ends[k];
    }
    if (muscle.strips.size() != 1 || area.places.size() < 3) return;
    TableStrip& strip = muscle.strips.front();
    TableSection& section = origin ? strip.sections.front() : strip.sections.back();
    section.radii = 0.5 * Vec2(std::max(extent(area.places, area.along), kThinnest),
                               std::max(extent(area.places, area.across), kThinnest));
    section.width = area.along;
  });
}

void arguments(Arguments& a, ResampleMesh& x) {
  a.text("name", "name", x.name, Need::required, "small letters, digits and _; without side");
  a.text("file", "file", x.file, Need::required,
         "closed mesh of the left one: left, up and front as places have it");
  a.text("from", "place", x.from, Need::optional, "origin; found by the mesh where left out");
  a.text("to", "place", x.to, Need::optional, "insertion, likewise");
  unit_and_up(a, x.unit, x.up);
  a.whole("points", x.points, 0, 12, Need::optional, "of the action line between its ends");
  a.whole("slices", x.slices, 4, 40, Need::optional, "sections along it");
  a.text("group", "name", x.group, Need::optional, "region, as arm or thigh");
}

Document apply(Workshop& workshop, const Document& document, const ResampleMesh& x) {
  if (x.from.empty() != x.to.empty())
    throw InputError("arguments 'from' and 'to': give both, or neither");
  TriMesh mesh = read_own_mesh(x.file, x.unit, x.up);
  mesh.V.col(0).array() += kSourceMidPlane;
  std::optional<std::pair<Vec3, Vec3>> ends;
  if (!x.from.empty())
    ends = {position(*document.frame, read_place(workshop, document, x.from)),
            position(*document.frame, read_place(workshop, document, x.to))};
  ResampleOptions options;
  options.control_points = x.points;
  options.slices = x.slices;
  const Resampled found = resampled(mesh, ends, options);
  const double volume =
      found.report.mesh_closed ? found.report.mesh_volume : found.report.loft_volume;
  // as new_muscle makes one, with the mesh's line and sections
  NewMuscle plain;
  plain.name = x.name;
  plain.from =
      place_text(*document.frame, on_nearest_bone(workshop, document, found.line.controls.front()));
  plain.to =
      place_text(*document.frame, on_nearest_bone(workshop, document, found.line.controls.back()));
  plain.volume = 1e6 * volume;
  plain.female = kFemaleOfMale * plain.volume;
  if (!x.group.empty()) plain.group = x.group;
  const Document made = apply(workshop, document, plain);
  return with_change(made, meant_muscle(made, x.name), [&](TableMuscle& muscle) {
    muscle.strips = {strip_of_mesh(workshop, made, found, x.points)};
  });
}

}  // namespace ecorche
