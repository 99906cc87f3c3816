#include "anatomy/authoring/muscle_placement.h"

// Muscles of both sides from the table, on the source skeleton.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/authoring/path_carriers.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/transform_muscles.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kProbe = 240;            // samples of a strip when its slices are spread
constexpr double kLeastStep = 2.5e-3;  // m from slice to slice: more of them show no more
constexpr int kFewestSlices = 6;
// share of the line over which scaling of the belly fades into the tendon
constexpr double kTendonFade = 0.03;

Vec3 mirror_direction(const Vec3& v) { return Vec3(-v.x(), v.y(), v.z()); }

// Monotone cubic interpolation (Fritsch and Carlson 1980, 10.1137/0717021) of section radii:
// bellies without corners that never swell beyond their sections.
class RadiusCurve {
 public:
  RadiusCurve(std::span<const Station> stations, int component) {
    for (const Station& station : stations) {
      s_.push_back(station.s);
      r_.push_back(station.radii[component]);
    }
    const int n = s_.size();
    std::vector<double> slope;
    for (int i = 0; i + 1 < n; ++i) slope.push_back((r_[i + 1] - r_[i]) / (s_[i + 1] - s_[i]));
    d_.assign(n, 0);
    d_.front() = slope.front();
    d_.back() = slope.back();
    for (int i = 1; i + 1 < n; ++i) {
      if (slope[i - 1] * slope[i] <= 0) continue;
      const double h0 = s_[i] - s_[i - 1], h1 = s_[i + 1] - s_[i];
      d_[i] = 3 * (h0 + h1) / ((2 * h1 + h0) / slope[i - 1] + (h1 + 2 * h0) / slope[i]);
    }
  }

  double operator()(double s) const {
    const auto it = std::upper_bound(s_.begin() + 1, s_.end() - 1, s);
    const int i = int(it - s_.begin()) - 1;
    const double h = s_[i + 1] - s_[i], u = std::clamp((s - s_[i]) / h, 0.0, 1.0);
    const double u2 = u * u, u3 = u2 * u;
    return (2 * u3 - 3 * u2 + 1) * r_[i] + (u3 - 2 * u2 + u) * h * d_[i] +
           (3 * u2 - 2 * u3) * r_[i + 1] + (u3 - u2) * h * d_[i + 1];
  }

 private:
  std::vector<double> s_, r_, d_;
};

// Where slices go: equal shares of length, of turning and of change in width, so that few slices
// show the shape. `parts`: fleshy ones, between intersections.
std::vector<double> spread_slices(std::span<const PathPoint> path,
                                  std::span<const Station> stations, int parts,
                                  const PlaceOptions& options) {
  std::vector<double> probe(kProbe + 1);
  for (int i = 0; i <= kProbe; ++i) probe[i] = double(i) / kProbe;
  const std::vector<Vec3> tangents = line_tangents(line_points(path, probe));
  const RadiusCurve width(stations, 0), thickness(stations, 1);
  double widest = 0;
  for (const Station& station : stations) widest = std::max(widest, station.radii.x());
  std::vector<double> weight{0};
  double turning = 0;
  for (int i = 1; i <= kProbe; ++i) {
    const double turn = std::acos(std::clamp(tangents[i].dot(tangents[i - 1]), -1.0, 1.0));
    const double swell = std::abs(width(probe[i]) - width(probe[i - 1])) / widest +
                         std::abs(std::log(thickness(probe[i]) / thickness(probe[i - 1])));
    turning += turn;
    weight.push_back(weight.back() + 1.0 / kProbe + 0.25 * turn + 0.12 * swell);
  }
  const int wish =
      options.min_slices * parts + int(1.5 * turning) + std::max(0, (int(path.size()) - 8) / 2);
  const int enough = std::max(kFewestSlices, int(line_length(path) / kLeastStep));
  const int count = std::min(enough, std::clamp(wish, options.min_slices,
                                                std::max(options.min_slices, options.max_slices)));
  std::vector<double> s{0};
  for (int k = 1, i = 1; k + 1 < count; ++k) {
    const double target = weight.back() * k / (count - 1);
    while (weight[i] < target) ++i;
    s.push_back(probe[i - 1] + (target - weight[i - 1]) / (weight[i] - weight[i - 1]) / kProbe);
  }
  s.push_back(1);
  return s;
}

// Three slices for each intersection, in place of those that lie there: its middle and where it has
// faded. Closer ones lean when the wall bends.
void add_slices(std::span<const double> intersections, std::vector<double>& s) {
  for (const double place : intersections) {
    std::erase_if(s, [&](double at) {
      return at > 0 && at < 1 && std::abs(at - place) < 1.6 * kIntersection;
    });
    for (int k = -1; k <= 1; ++k)
      if (const double at = place + k * kIntersection; at > 0 && at < 1) s.push_back(at);
  }
  std::sort(s.begin(), s.end());
  s.erase(std::unique(s.begin(), s.end()), s.end());
}

std::vector<PathPoint> place_path(const TableStrip& strip, const PathCarriers& carriers) {
  std::vector<PathPoint> path;
  for (const TablePoint& point : strip.path) path.push_back(carriers.carry(point));
  return path;
}

// A strip of the left side, without wraps and not yet of the right volume.
Strip place_strip(const TableStrip& from, const PathCarriers& carriers,
                  const PlaceOptions& options) {
  const std::vector<PathPoint> path = place_path(from, carriers);
  std::vector<Station> sections;
  for (const TableSection& section : from.sections) {
    Station station;
    station.s = line_parameter(path, section.s);
    station.width = section.width;
    station.radii = section.radii;
    sections.push_back(station);
  }
  std::vector<double> intersections;
  for (const double place : from.intersections)
    intersections.push_back(line_parameter(path, place));
  std::vector<double> places =
      spread_slices(path, sections, 1 + int(intersections.size()), options);
  add_slices(intersections, places);
  std::vector<Station> stations = resample_stations(path, sections, places);
  const RadiusCurve width(sections, 0), thickness(sections, 1);
  for (Station& station : stations) station.radii = Vec2(width(station.s), thickness(station.s));
  Strip strip = make_strip(path, stations);
  strip.belly_begin = line_parameter(path, from.belly_begin);
  strip.belly_end = line_parameter(path, from.belly_end);
  strip.intersections = std::move(intersections);
  strip.raphe = from.raphe;
  return strip;
}

// The other side of a strip: mirrored places, carriers of the other side, and rolls that turn the
// other way.
Strip mirrored(const Strip& left, std::vector<PathPoint> path) {
  Strip strip = left;
  strip.path = std::move(path);
  strip.reference = mirror_direction(left.reference);
  for (Slice& slice : strip.slices) {
    slice.roll = -slice.roll;
    slice.offset.y() = -slice.offset.y();
  }
  return strip;
}

// 1 on the belly, 0 on the tendons.
double belly_share(const Strip& strip, double s) {
  const double into = strip.belly_begin > 0 ? (s - strip.belly_begin) / kTendonFade + 1 : 1;
  const double left = strip.belly_end < 1 ? (strip.belly_end - s) / kTendonFade + 1 : 1;
  return std::clamp(std::min(into, left), 0.0, 1.0);
}

Strip scaled_belly(Strip strip, double factor, bool sheet) {
  for (Slice& slice : strip.slices) {
    const double f = 1 + (factor - 1) * belly_share(strip, slice.s);
    slice.radii.y() *= f;
    if (!sheet) slice.radii.x() *= f;
  }
  return strip;
}

double volume_of(const std::vector<Strip>& strips) {
  double sum = 0;
  for (const Strip& strip : strips) sum += tube_volume(rest_slices(strip));
  return sum;
}

// Bellies of all strips scaled by one factor so that the tubes hold `volume`. By bisection: the
// volume rises with the factor. Where tendons alone hold more, everything is scaled.
void set_volume(std::vector<Strip>& strips, double volume, bool sheet) {
  const auto scaled = [&](double factor) {
    std::vector<Strip> out;
    for (const Strip& strip : strips) out.push_back(scaled_belly(strip, factor, sheet));
    return out;
  };
  double low = 0.25, high = 4;
  if (volume_of(scaled(low)) < volume && volume_of(scaled(high)) > volume) {
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (volume_of(scaled(middle)) < volume ? low : high) = middle;
    }
    strips = scaled((low + high) / 2);
  }
  const double rest = std::sqrt(volume / volume_of(strips));
  for (Strip& strip : strips)
    for (Slice& slice : strip.slices) slice.radii *= rest;
}

Wrap place_wrap(const MuscleTable& table, const TableStrip::WrapUse& use,
                const PathCarriers& carriers, Side side) {
  const TableWrap& from = table.wraps[use.wrap];
  const SourceLandmark& landmark = table.landmarks[from.landmark];
  const PathPoint center =
      carriers.carry(landmark.carrier, landmark.position + from.offset, from.where);
  Wrap wrap;
  wrap.kind = from.kind;
  wrap.joint = center.joints[0];
  wrap.radii = from.radii;
  if (use.radius > 0) {
    wrap.radii.x() = wrap.radii.y() = use.radius;
    if (wrap.kind == Wrap::Kind::sphere) wrap.radii.z() = use.radius;
  }
  wrap.X_WO.translation() = center.rest;
  if (wrap.kind == Wrap::Kind::cylinder) {
    const Vec3 axis = side == Side::right ? mirror_direction(from.axis) : from.axis;
    wrap.X_WO.linear() = Quat::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
  }
  return wrap;
}

// Name, words and architecture of one side; no strips.
Muscle describe(const TableMuscle& from, Side side, Sex sex) {
  Muscle muscle;
  muscle.name = from.name + side_suffix(side);
  muscle.side = side;
  muscle.label = from.label;
  muscle.group = from.group;
  muscle.layer = from.layer;
  muscle.origin = from.origin;
  muscle.insertion = from.insertion;
  muscle.volume = sex == Sex::male ? from.volume_male : from.volume_female;
  muscle.fibre_length = from.fibre_length;
  muscle.pennation = from.pennation;
  muscle.tense_thickness = from.tense_thickness;
  muscle.max_force = from.max_force;
  muscle.sheet = from.sheet;
  return muscle;
}

Muscle place_muscle(const MuscleTable& table, const TableMuscle& from, std::vector<Strip> strips,
                    const PathCarriers& carriers, Side side, Sex sex) {
  Muscle muscle = describe(from, side, sex);
  muscle.strips = std::move(strips);
  for (std::size_t i = 0; i < from.strips.size(); ++i)
    for (const TableStrip::WrapUse& use : from.strips[i].wraps)
      muscle.strips[i].wraps.push_back(place_wrap(table, use, carriers, side));
  // The first strip's bone; none where any strip ends on fascia.
  const auto end_bone = [&](bool origin) {
    std::string first;
    for (const TableStrip& strip : from.strips) {
      const TablePoint& point = origin ? strip.path.front() : strip.path.back();
      const std::string name = carriers.bone_name(table.landmarks[point.landmark].carrier);
      if (name.empty()) return name;
      if (first.empty()) first = name;
    }
    return first;
  };
  muscle.origin_bone = end_bone(true);
  muscle.insertion_bone = end_bone(false);
  return muscle;
}

}  // namespace

std::vector<Muscle> place_muscles(const MuscleTable& table, const Anatomy& source,
                                  const PlaceOptions& options) {
  const PathCarriers on_left(table, source, Side::left), on_right(table, source, Side::right);
  std::vector<Muscle> muscles;
  for (const TableMuscle& from : table.muscles) {
    std::vector<Strip> left, right;
    for (const TableStrip& strip : from.strips)
      left.push_back(place_strip(strip, on_left, options));
    set_volume(left, options.sex == Sex::male ? from.volume_male : from.volume_female, from.sheet);
    for (std::size_t i = 0; i < left.size(); ++i)
      right.push_back(mirrored(left[i], place_path(from.strips[i], on_right)));
    muscles.push_back(place_muscle(table, from, std::move(left), on_left, Side::left, options.sex));
    muscles.push_back(
        place_muscle(table, from, std::move(right), on_right, Side::right, options.sex));
  }
  return muscles;
}

}  // namespace ecorche::inline v1
