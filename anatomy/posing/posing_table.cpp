#include "anatomy/posing/posing_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/belly_length.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/posing_data.h"
#include "anatomy/posing/rest_strip.h"
#include "anatomy/posing/tense_thickening.h"
#include "anatomy/posing/wrapping.h"

namespace ecorche::inline v1 {
namespace {

// Twist of tendon over twist of belly, per metre of line. Less: bellies twist more; more: tendons.
constexpr double kTendonTwist = 3;
// Fraction of their rest distance at which path points of two bones are kept apart.
constexpr double kKeptGap = 0.3;
// Length of a path's first or last piece up to which its point of another bone may be passed, m.
constexpr double kShortEnd = 0.04;
// Curvature times a section's distance from the line, on the inner side of a bend, up to which the
// offset is not reduced.
constexpr double kFreeOffset = 0.3;
PosingPoint posing_point(const PathPoint& p, const std::vector<Vec3>& joints) {
  PosingPoint point;
  point.first = p.joints[0];
  point.in_first = p.rest - joints[p.joints[0]];
  if (p.joints[1] >= 0 && p.share < 1) {
    point.second = p.joints[1];
    point.share = p.share;
    point.in_second = p.rest - joints[p.joints[1]];
  }
  return point;
}

// Adds links where the line passes from one bone to the next, and on either side, for points that
// are pushed on.
void add_links(std::span<const PathPoint> path, std::vector<PosingLink>& links) {
  const int n = path.size();
  const auto crosses = [&](int i) {
    return path[i].joints != path[i + 1].joints || path[i].share != path[i + 1].share;
  };
  const auto room = [&](int i, int step) {
    double sum = 0;
    for (int k = i; k + step >= 0 && k + step < n && !crosses(std::min(k, k + step)); k += step)
      sum += (path[k + step].rest - path[k].rest).norm();
    return sum;
  };
  const auto add = [&](int i, double first, double second) {
    const Vec3 step = path[i + 1].rest - path[i].rest;
    const double size = step.norm();
    if (!(size > 1e-6)) return;
    if (i == 0) second = first + second, first = 0;
    if (i + 2 == n) first = first + second, second = 0;
    const double free = std::min(first > 0 ? room(i, -1) : 1e3, second > 0 ? room(i + 1, 1) : 1e3);
    if (n > 2)
      links.push_back({i, first, second, step / size, kKeptGap * size, std::max(free, size)});
  };
  for (int i = 0; i + 1 < n; ++i) {
    if (!crosses(i)) continue;
    const bool end =
        i == 0 ||
        i + 2 == n;  // then the via point alone is moved, and only a short piece may be passed
    if (end && (path[i + 1].rest - path[i].rest).norm() > kShortEnd) continue;
    add(i, 0.5, 0.5);
    if (end) continue;
    for (int back = i - 1; back > 0 && !crosses(back); --back) add(back, 1, 0);
    for (int on = i + 1; on + 2 < n && !crosses(on); ++on) add(on, 0, 1);
  }
}

PosingProfile profile(const Strip& strip, const RestStrip& rest) {
  PosingProfile table;
  const double whole = rest.chord.back();
  for (int i = 0; i <= kProfileBins; ++i) {
    const double at = whole * i / kProfileBins;
    size_t k = 1;
    while (k + 1 < rest.chord.size() && rest.chord[k] < at) ++k;
    const double gap = rest.chord[k] - rest.chord[k - 1];
    const double share = gap > 0 ? std::clamp((at - rest.chord[k - 1]) / gap, 0.0, 1.0) : 0;
    const Slice &p = strip.slices[k - 1], &q = strip.slices[k];
    const Vec2 radii = p.radii + share * (q.radii - p.radii);
    table.at[i] << float(radii.x()), float(radii.y()),
        float(belly_weight(strip, p.s + share * (q.s - p.s))), 0.0f;
  }
  table.at[kProfileBins + 1] = table.at[kProfileBins];
  return table;
}

void add_lane(PosingData& data, PosingBatch& batch, int lane, const Muscle& muscle,
              const Strip& strip, const RestStrip& rest) {
  const int n = batch.rows;
  PosingLanes& lanes = batch.lanes;
  const double whole = rest.chord.back(), line = line_length(strip.path);
  lanes.rest_chords[lane] = whole;
  lanes.length_factor[lane] = line / whole;
  const double begin = std::clamp(strip.belly_begin, 0.0, 1.0) * whole,
               end = std::clamp(strip.belly_end, 0.0, 1.0) * whole;
  const bool has_belly = end > begin + 1e-6;
  lanes.tendon_begin[lane] = has_belly ? begin : 0;
  lanes.tendon_end[lane] = has_belly ? end : whole;
  const double belly = lanes.tendon_end[lane] - lanes.tendon_begin[lane];
  lanes.stretch_length[lane] = belly + kTendonStretchRatio * (whole - belly);
  lanes.bins[lane] = kProfileBins / whole;
  lanes.volume[lane] = tube_volume(rest.slices) * 3 / std::numbers::pi;
  const bool sheet = muscle.sheet;
  lanes.width_swells[lane] = sheet ? 0 : 1;
  lanes.scale_min[lane] = sheet ? kLeastSwelling * kLeastSwelling : kLeastSwelling;
  lanes.scale_max[lane] = sheet ? kMostSwelling * kMostSwelling : kMostSwelling;

  PosingProfile& table = data.profiles[batch.profile + lane] = profile(strip, rest);
  double turn = 0;
  std::vector<double> turns{0};
  for (int k = 1; k < n; ++k) {
    const double middle = 0.5 * (strip.slices[k - 1].s + strip.slices[k].s);
    const bool tendon = middle < strip.belly_begin || middle > strip.belly_end;
    turns.push_back(turn += (tendon ? kTendonTwist : 1) * (rest.chord[k] - rest.chord[k - 1]));
  }
  const std::vector<Vec2> thin_directions = thickening_directions(muscle, rest.slices);
  for (int k = 0; k < n; ++k) {
    PosingRow& row = data.rows[batch.row + k];
    const Slice& slice = strip.slices[k];
    row.cos_roll[lane] = std::cos(slice.roll);
    row.sin_roll[lane] = std::sin(slice.roll);
    row.offset_x[lane] = slice.offset.x();
    row.offset_y[lane] = slice.offset.y();
    const Eigen::Array4f own =
        table(std::min<double>(rest.chord[k] * lanes.bins[lane], kProfileBins));
    row.width[lane] = slice.radii.x() - double(own[0]);
    row.thickness[lane] = slice.radii.y() - double(own[1]);
    row.twist[lane] = float(turns[k] / turn);
    const int before = std::max(k - 1, 0), after = std::min(k + 1, n - 1);
    const Vec3 bend =
        (rest.tangents[after] - rest.tangents[before]) / (rest.chord[after] - rest.chord[before]);
    const Mat3& axes = rest.slices[k].axes;
    // Rounded up, so that the rest pose is free to the last bit.
    const auto free = [&](int axis) {
      return float(
          std::max(0.45, 1.000001 * std::abs(bend.dot(axes.col(axis)) * slice.radii[axis]) + 1e-9));
    };
    row.free_width[lane] = free(0);
    row.free_thickness[lane] = free(1);
    const double inward = bend.dot(rest.slices[k].axes.leftCols<2>() * slice.offset);
    row.free_offset[lane] = float(std::max(kFreeOffset, 1.000001 * inward + 1e-9));
    const double place = (2 * rest.chord[k] - lanes.tendon_begin[lane] - lanes.tendon_end[lane]) /
                         (lanes.tendon_end[lane] - lanes.tendon_begin[lane]);
    PosingThickening& thickening = data.thickening[batch.row + k];
    thickening.share[lane] =
        float(tense_thickening(muscle, rest.slices[k], thin_directions[k], place));
    thickening.along_width[lane] = float(thin_directions[k].x());
    thickening.along_thickness[lane] = float(thin_directions[k].y());
    set_lane(data.areas[batch.row + k], lane,
             piece_areas(slice.outline, strip.slices[std::min(k + 1, n - 1)].outline));
  }
}

// A strip's own data: points, nodes (of its lane), wraps, end frames.
void add_strip(PosingData& data, const Muscle& muscle, const Strip& strip, const RestStrip& rest,
               const std::vector<Vec3>& joints, const SliceRange& range, int index) {
  PosingStrip out;
  out.strip = index;
  out.muscle = range.muscle;
  out.slice = range.begin;
  out.point = data.points.size();
  for (const PathPoint& p : strip.path) data.points.push_back(posing_point(p, joints));
  out.link = data.links.size();
  add_links(strip.path, data.links);
  out.links = int(data.links.size()) - out.link;
  while (int(data.points.size()) - out.point < 4) data.points.push_back(data.points.back());
  out.points = int(data.points.size()) - out.point;
  out.wrap = data.wraps.size();
  for (size_t w = 0; w < strip.wraps.size(); ++w) {
    PosingWrap wrap;
    WrapNote note{range.muscle, range.strip, int(w), true, 0};
    note.used = fit_wrap(strip.wraps[w], rest, joints[strip.wraps[w].joint], wrap, data.wrap_slices,
                         note.depth);
    if (note.used) data.wraps.push_back(wrap);
    if (!note.used || note.depth > 0) data.notes.push_back(note);
  }
  out.wraps = int(data.wraps.size()) - out.wrap;
  const auto unrolled = [&](int k) -> Vec3 {
    const Mat3& axes = rest.slices[k].axes;
    return std::cos(strip.slices[k].roll) * axes.col(0) -
           std::sin(strip.slices[k].roll) * axes.col(1);
  };
  out.reference = unrolled(0);
  out.begin_tangent = rest.tangents.front();
  out.end_reference = unrolled(int(rest.slices.size()) - 1);
  out.end_tangent = rest.tangents.back();
  out.compliance =
      TendonCompliance({muscle.fibre_length, muscle.pennation, line_length(strip.path)});
  data.strip.push_back(out);
}

void check(const Anatomy& anatomy) {
  validate(anatomy);
  for (const Muscle& muscle : anatomy.muscles)
    for (size_t i = 0; i < muscle.strips.size(); ++i) {
      const Strip& strip = muscle.strips[i];
      const std::string where =
          "make_posing_table: muscle '" + muscle.name + "': strip " + std::to_string(i + 1) + ": ";
      if (strip.slices.size() < 2 || strip.slices.size() > kMaxStripSlices)
        throw std::invalid_argument(where + std::to_string(strip.slices.size()) +
                                    " slices, need 2 .. " + std::to_string(kMaxStripSlices));
      if (strip.path.size() > kMaxPathPoints)
        throw std::invalid_argument(where + std::to_string(strip.path.size()) +
                                    " path points, at most " + std::to_string(kMaxPathPoints));
      if (!(line_length(strip.path) > 1e-6))
        throw std::invalid_argument(where + "the line has no length");
    }
}

}  // namespace

int PosingTable::strips() const { return data ? data->strips : 0; }
int PosingTable::slices() const { return data ? data->slices : 0; }

PosingTable make_posing_table(const Anatomy& anatomy) {
  check(anatomy);
  const auto data = std::make_shared<PosingData>();
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  const std::vector<Vec3> joints = rest_positions(anatomy.skeleton);
  data->joints = joints.size();
  data->strips = ranges.size();
  data->slices = slice_count(anatomy);
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips)
      for (const Slice& slice : strip.slices) data->outlines.push_back(slice.outline);
  data->muscles = anatomy.muscles.size();

  std::vector<int> order(ranges.size());
  std::iota(order.begin(), order.end(), 0);
  const auto rows = [&](int i) { return ranges[i].end - ranges[i].begin; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return rows(a) < rows(b); });
  for (size_t at = 0; at < order.size();) {
    PosingBatch batch;
    batch.rows = rows(order[at]);
    while (batch.strips < kLanes && at + batch.strips < order.size() &&
           rows(order[at + batch.strips]) == batch.rows)
      ++batch.strips;
    batch.row = data->rows.size();
    batch.node = data->weights.size();
    batch.profile = data->profiles.size();
    data->rows.resize(data->rows.size() + batch.rows);
    data->areas.resize(data->rows.size());
    data->thickening.resize(data->rows.size());
    data->profiles.resize(data->profiles.size() + kLanes);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = order[at + std::min(lane, batch.strips - 1)];
      const Muscle& muscle = anatomy.muscles[ranges[i].muscle];
      const Strip& strip = muscle.strips[ranges[i].strip];
      const RestStrip rest = rest_strip(strip);
      batch.strip[lane] = data->strip.size();
      if (lane < batch.strips)
        add_strip(*data, muscle, strip, rest, joints, ranges[i], i);
      else
        batch.strip[lane] = batch.strip[batch.strips - 1];
      std::vector<double> s;
      for (const Slice& slice : strip.slices) s.push_back(slice.s);
      for (const LineNode& node : line_nodes(strip.path, s)) {
        data->weights.push_back(
            Double4(node.weight[0], node.weight[1], node.weight[2], node.weight[3]));
        data->firsts.push_back(std::uint8_t(node.first));
      }
      add_lane(*data, batch, lane, muscle, strip, rest);
    }
    data->batches.push_back(batch);
    at += batch.strips;
  }
  return PosingTable{data};
}

std::vector<WrapNote> wrap_notes(const PosingTable& table) {
  return table.data ? table.data->notes : std::vector<WrapNote>{};
}

}  // namespace ecorche::inline v1
