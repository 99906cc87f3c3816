#include "anatomy/posing/pose_anatomy.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/belly_length.h"
#include "anatomy/posing/activation_bulge.h"
#include "anatomy/posing/posed_line.h"
#include "anatomy/posing/posing_batch.h"
#include "anatomy/posing/posing_data.h"
#include "anatomy/posing/restore_volume.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTwistLimit = 100 * std::numbers::pi / 180;
// below this a second thread's wake-up costs more than it saves
constexpr int kSlicesForThreads = 3000;

inline Vec3x4 across(const Double4& p0, const Double4& p1, const Double4& p2, const Double4& p3) {
  Eigen::Matrix4d m;
  m.col(0) = p0.matrix();
  m.col(1) = p1.matrix();
  m.col(2) = p2.matrix();
  m.col(3) = p3.matrix();
  m.transposeInPlace();
  return {m.col(0).array(), m.col(1).array(), m.col(2).array()};
}

// `direction`, fixed to a bone where the line has the tangent `from`, rotated by the least rotation
// that brings `from` to the line's tangent `to`.
inline Vec3x4 follow(const Vec3x4& from, const Vec3x4& to, const Vec3x4& direction) {
  const Vec3x4 axis = cross(from, to), once = cross(axis, direction);
  const Vec3x4 d = direction + once + (1 / (1 + dot(from, to) + 1e-9)) * cross(axis, once);
  return unit(d - dot(d, to) * to);
}

// Slice points of the line: spline, then wraps; and across the lanes.
void lay_line(const PosingData& data, const PosingBatch& batch, const std::vector<Transform>& X_WJ,
              BatchWorkspace& t) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (lane >= batch.strips) {
      std::copy_n(t.points[batch.strips - 1], batch.rows, t.points[lane]);
      continue;
    }
    lay_strip(data, data.strip[batch.strip[lane]], batch.node + lane * batch.rows, batch.rows, X_WJ,
              t.points[lane]);
  }
  for (int k = 0; k < batch.rows; ++k) {
    t.line[k] = across(t.points[0][k], t.points[1][k], t.points[2][k], t.points[3][k]);
  }
}

// Chords and unit tangents (the parabola through three neighbours, as in line_tangents).
void find_tangents(int rows, BatchWorkspace& t) {
  t.chord[0].setZero();
  Vec3x4 before = t.line[1] - t.line[0];
  Double4 h0 = dot(before, before).max(1e-18);
  t.chord[1] = h0.sqrt();
  if (rows == 2) {
    t.tangent[0] = t.tangent[1] = unit(before);
    return;
  }
  for (int k = 1; k + 1 < rows; ++k) {
    const Vec3x4 after = t.line[k + 1] - t.line[k];
    const Double4 h1 = dot(after, after).max(1e-18);
    t.tangent[k] = unit(h1 * before + h0 * after);
    t.chord[k + 1] = t.chord[k] + h1.sqrt();
    if (k == 1) {
      const Double4 l0 = h0.sqrt(), l1 = h1.sqrt();
      t.tangent[0] = unit(((2 * l0 + l1) * l1) * before - h0 * after);
    }
    if (k + 2 == rows) {
      const Double4 l0 = h0.sqrt(), l1 = h1.sqrt();
      t.tangent[rows - 1] = unit(((2 * l1 + l0) * l0) * after - h1 * before);
    }
    before = after;
    h0 = h1;
  }
}

// Rotation-minimising frames by double reflection from the reference that the first path point
// carries.
void carry_frames(const PosingData& data, const PosingBatch& batch,
                  const std::vector<Transform>& X_WJ, BatchWorkspace& t) {
  Double4 reference[kLanes], tangent[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const PosingStrip& strip = data.strip[batch.strip[lane]];
    const PosingPoint& origin = data.points[strip.point];
    reference[lane] = turned(origin, X_WJ, strip.reference);
    tangent[lane] = turned(origin, X_WJ, strip.begin_tangent);
  }
  t.r[0] = follow(unit(across(tangent[0], tangent[1], tangent[2], tangent[3])), t.tangent[0],
                  across(reference[0], reference[1], reference[2], reference[3]));
  for (int k = 0; k + 1 < batch.rows; ++k) {
    const Vec3x4 v1 = t.line[k + 1] - t.line[k];
    const Double4 c1 = 2 / dot(v1, v1).max(1e-300);
    const Vec3x4 r = t.r[k] - (c1 * dot(v1, t.r[k])) * v1;
    const Vec3x4 v2 = t.tangent[k + 1] - (t.tangent[k] - (c1 * dot(v1, t.tangent[k])) * v1);
    t.r[k + 1] = r - (2 * dot(v2, r) / dot(v2, v2).max(1e-300)) * v2;
  }
}

// Angle of the vector (x, y), to 2e-8 (Abramowitz and Stegun 4.4.49), exact near 0.
Double4 angle_of(const Double4& y, const Double4& x) {
  const Double4 ay = y.abs(), ax = x.abs();
  const Double4 z = ay.min(ax) / ay.max(ax).max(1e-300), q = z * z;
  const Double4 a =
      z *
      (1 +
       q * (-0.3333314528 +
            q * (0.1999355085 +
                 q * (-0.1420889944 +
                      q * (0.1065626393 +
                           q * (-0.0752896400 +
                                q * (0.0429096138 + q * (-0.0161657367 + q * 0.0028662257))))))));
  const Double4 first = (ay > ax).select(0.5 * std::numbers::pi - a, a);
  const Double4 half = (x < 0).select(std::numbers::pi - first, first);
  return (y < 0).select(-half, half);
}

// Beyond the limit the twist is taken back along a cubic, to zero at 180 deg, so that the pose in
// which the branch changes is passed without a jump.
Double4 limited_twist(const Double4& angle) {
  const Double4 size = angle.abs();
  constexpr double span = std::numbers::pi - kTwistLimit;
  const Double4 u = ((size - kTwistLimit) / span).max(0.0).min(1.0), v = 1 - u;
  const Double4 back = v * v * ((1 + 2 * u) * kTwistLimit + u * span) + 2 * span * u * u * v;
  const Double4 folded = (angle < 0).select(-back, back);
  return (size <= kTwistLimit).select(angle, folded);
}

// Turn of the insertion's reference against the transported frame.
Double4 find_twist(const PosingData& data, const PosingBatch& batch,
                   const std::vector<Transform>& X_WJ, const BatchWorkspace& t, PosedAnatomy& out) {
  Double4 reference[kLanes], tangent[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const PosingStrip& strip = data.strip[batch.strip[lane]];
    const PosingPoint& insertion = data.points[strip.point + strip.points - 1];
    reference[lane] = turned(insertion, X_WJ, strip.end_reference);
    tangent[lane] = turned(insertion, X_WJ, strip.end_tangent);
  }
  const Vec3x4 &to = t.tangent[batch.rows - 1], &r = t.r[batch.rows - 1];
  const Vec3x4 wanted = follow(unit(across(tangent[0], tangent[1], tangent[2], tangent[3])), to,
                               across(reference[0], reference[1], reference[2], reference[3]));
  const Double4 angle = angle_of(dot(wanted, cross(to, r)), dot(wanted, r));
  for (int lane = 0; lane < batch.strips; ++lane)
    out.twists[data.strip[batch.strip[lane]].strip] = angle[lane];
  return limited_twist(angle);
}

// cos and sin of |x| <= 2.2 to 1e-11, by series at half the angle.
inline void cos_sin(const Double4& x, Double4& c, Double4& s) {
  const Double4 h = 0.5 * x, q = h * h;
  const Double4 sh =
      h * (1 + q * (-1.0 / 6 +
                    q * (1.0 / 120 +
                         q * (-1.0 / 5040 + q * (1.0 / 362880 + q * (-1.0 / 39916800 +
                                                                     q * (1 / 6227020800.0)))))));
  const Double4 ch =
      1 +
      q * (-0.5 + q * (1.0 / 24 +
                       q * (-1.0 / 720 + q * (1.0 / 40320 + q * (-1.0 / 3628800 +
                                                                 q * (1.0 / 479001600 -
                                                                      q * (1 / 87178291200.0)))))));
  c = 1 - 2 * sh * sh;
  s = 2 * sh * ch;
}

inline Double4 gather_profile(const PosingData& data, const PosingBatch& batch, const Double4& bins,
                              Double4& a, Double4& b) {
  Eigen::Matrix4f m;
  for (int lane = 0; lane < kLanes; ++lane)
    m.col(lane) = data.profiles[batch.profile + lane](bins[lane]).matrix();
  m.transposeInPlace();
  a = m.col(0).cast<double>().array();
  b = m.col(1).cast<double>().array();
  return m.col(2).cast<double>().array();
}

// Axes, radii and centres of every slice, before swelling.
void lay_slices(const PosingData& data, const PosingBatch& batch, const Double4& twist,
                const BatchActivation& activation, BatchWorkspace& t) {
  const PosingLanes& c = batch.lanes;
  // Strain of the belly; tendons take kTendonStretchRatio of it.
  const Double4 whole = t.chord[batch.rows - 1];
  const Double4 stretch = ((whole - c.rest_chords) / c.stretch_length).max(-0.9);
  Double4 belly = 1 + stretch, tendon = 1 + kTendonStretchRatio * stretch;
  if (activation.any) stretch_tendon(data, batch, activation, whole, belly, tendon);
  const Double4 belly_begin = c.tendon_begin * tendon;
  const Double4 belly_length = (c.tendon_end - c.tendon_begin) * belly;
  const Double4 per_belly = belly.inverse(), per_tendon = tendon.inverse();
  const Double4 zero = Double4::Zero();
  for (int k = 0; k < batch.rows; ++k) {
    const PosingRow& row = data.rows[batch.row + k];
    Double4 cos_twist, sin_twist;
    const Double4 share = row.twist.cast<double>();
    cos_sin(twist * share, cos_twist, sin_twist);
    const Double4 cs = row.cos_roll * cos_twist - row.sin_roll * sin_twist;
    const Double4 sn = row.sin_roll * cos_twist + row.cos_roll * sin_twist;
    const Vec3x4 side = cross(t.tangent[k], t.r[k]);
    const Vec3x4 wide = cs * t.r[k] + sn * side, thick = cs * side - sn * t.r[k];
    t.width[k] = wide;
    t.thickness[k] = thick;
    const int before = std::max(k - 1, 0), after = std::min(k + 1, batch.rows - 1);
    const Vec3x4 bend =
        (1 / (t.chord[after] - t.chord[before]).max(1e-9)) * (t.tangent[after] - t.tangent[before]);
    // Sections off the line come no nearer to the bend's centre than folds allow, so that their
    // middles keep their order.
    const FoldFactor fo =
        fold_factor((dot(bend, wide) * row.offset_x + dot(bend, thick) * row.offset_y).max(zero),
                    row.free_offset.cast<double>());
    // Place along the rest line of the substance that lies here now.
    const Double4 at = t.chord[k];
    const Double4 past = (at - belly_begin).max(zero);
    const Double4 rest_at = at.min(belly_begin) * per_tendon + past.min(belly_length) * per_belly +
                            (past - belly_length).max(zero) * per_tendon;
    const Double4 bins = (rest_at.max(zero) * c.bins).min(double(kProfileBins));
    Double4 a, b;
    t.belly[k] = gather_profile(data, batch, bins, a, b);
    a = (a + row.width).max(zero);
    b = (b + row.thickness).max(zero);
    if (activation.any) {
      const Double4 place =
          (2 * rest_at - c.tendon_begin - c.tendon_end) / (c.tendon_end - c.tendon_begin);
      stretch_axes(bulge(activation.root * t.belly[k], c.width_swells, place,
                         data.thickening[batch.row + k]),
                   t.width[k], t.thickness[k], a, b);
    }

    const Double4 free_width = row.free_width.cast<double>(),
                  free_thickness = row.free_thickness.cast<double>();
    const FoldFactor fa = fold_factor(dot(bend, t.width[k]) * a, free_width);
    const FoldFactor fb = fold_factor(dot(bend, t.thickness[k]) * b, free_thickness);
    const Double4 folds = fa.under * fb.under,
                  per_all = 1 / (folds * fo.under);  // one division for all three
    const Double4 off = fo.over * folds * per_all, per_folds = fo.under * per_all;
    t.a[k] = a * (fa.over * fb.under * per_folds);
    t.b[k] = b * (fb.over * fa.under * per_folds);
    t.center[k] = t.line[k] + (off * row.offset_x) * wide + (off * row.offset_y) * thick;
  }
}

// Four lanes of four quantities to four places.
inline void scatter(const Double4& a, const Double4& b, const Double4& c, const Double4& d,
                    const std::array<double*, kLanes>& to) {
  Eigen::Matrix4d m;
  m.col(0) = a.matrix();
  m.col(1) = b.matrix();
  m.col(2) = c.matrix();
  m.col(3) = d.matrix();
  m.transposeInPlace();
  for (int lane = 0; lane < kLanes; ++lane) Eigen::Vector4d::Map(to[lane]) = m.col(lane);
}

// An Ellipse is stored as it lies in memory: center, width, thickness, tangent, radii, outline.
static_assert(sizeof(Ellipse) == 14 * sizeof(double) + sizeof(SliceOutline));

void store(const PosingData& data, const PosingBatch& batch, const Double4& scale,
           const BatchWorkspace& t, PosedAnatomy& out) {
  std::array<int, kLanes> first;
  for (int lane = 0; lane < kLanes; ++lane) first[lane] = data.strip[batch.strip[lane]].slice;
  for (int k = 0; k < batch.rows; ++k) {
    const Double4 g = 1 + t.belly[k] * (scale - 1);
    const Double4 a = t.a[k] * (1 + batch.lanes.width_swells * (g - 1)), b = t.b[k] * g;
    std::array<double*, kLanes> center, width, thickness;
    for (int lane = 0; lane < kLanes; ++lane) {  // idle lanes write their strip's values once more
      const int slice = first[lane] + k;
      Ellipse& e = out.slices[slice];
      center[lane] = e.center.data();
      width[lane] = e.axes.data() + 1;
      thickness[lane] = e.axes.data() + 5;
      e.radii = Vec2(a[lane], b[lane]);
      e.outline = data.outlines[slice];
      out.belly[slice] = float(t.belly[k][lane]);
    }
    scatter(t.center[k].x, t.center[k].y, t.center[k].z, t.width[k].x, center);
    scatter(t.width[k].y, t.width[k].z, t.thickness[k].x, t.thickness[k].y, width);
    scatter(t.thickness[k].z, t.tangent[k].x, t.tangent[k].y, t.tangent[k].z, thickness);
  }
  const Double4 lengths = t.chord[batch.rows - 1] * batch.lanes.length_factor;
  for (int lane = 0; lane < batch.strips; ++lane) {
    const int strip = data.strip[batch.strip[lane]].strip;
    out.lengths[strip] = lengths[lane];
    out.swelling[strip] = batch.lanes.width_swells[lane] > 0 ? scale[lane] : std::sqrt(scale[lane]);
  }
}

// What store() fills next is fetched before it is needed: the slices of a body are larger than the
// nearer memories. Always inline: as a function by itself it has no effect that the compiler knows
// of, and is left out.
[[gnu::always_inline]] inline void fetch_slices(const PosingData& data, const PosingBatch& batch,
                                                const PosedAnatomy& out) {
  constexpr std::size_t kLine = 64;
  for (int lane = 0; lane < batch.strips; ++lane) {
    const std::size_t first = data.strip[batch.strip[lane]].slice, count = batch.rows;
    const char* to = reinterpret_cast<const char*>(&out.slices[first]);
    const char* from = reinterpret_cast<const char*>(&data.outlines[first]);
    for (std::size_t at = 0; at < count * sizeof(Ellipse); at += kLine)
      __builtin_prefetch(to + at, 1);
    for (std::size_t at = 0; at < count * sizeof(SliceOutline); at += kLine)
      __builtin_prefetch(from + at);
  }
}

void pose_batch(const PosingData& data, const PosingBatch& batch,
                std::span<const double> activation, PosedAnatomy& out) {
  BatchWorkspace t;
  lay_line(data, batch, out.X_WJ, t);
  find_tangents(batch.rows, t);
  carry_frames(data, batch, out.X_WJ, t);
  fetch_slices(data, batch, out);
  const Double4 twist = find_twist(data, batch, out.X_WJ, t, out);
  lay_slices(data, batch, twist, batch_activation(data, batch, activation), t);
  const VolumeScale found = find_volume_scale(batch, &data.areas[batch.row], t,
                                              batch.lanes.scale_min, batch.lanes.scale_max);
  store(data, batch, found.scale, t, out);
  restore_missed_volumes(data, batch, found, out);
}

}  // namespace

void pose_anatomy(const PosingTable& table, const Skeleton& skeleton, const Pose& pose,
                  PosedAnatomy& out, int threads, std::span<const double> activation) {
  if (!table.data) throw std::invalid_argument("pose_anatomy: empty table");
  const PosingData& data = *table.data;
  if (int(skeleton.joints.size()) != data.joints)
    throw std::invalid_argument("pose_anatomy: " + std::to_string(skeleton.joints.size()) +
                                " joints, the table has " + std::to_string(data.joints));
  if (!activation.empty() && int(activation.size()) != data.muscles)
    throw std::invalid_argument("pose_anatomy: " + std::to_string(activation.size()) +
                                " activations, the table has " + std::to_string(data.muscles) +
                                " muscles");
  forward_kinematics(skeleton, pose, out.X_WJ);
  out.slices.resize(data.slices);
  out.belly.resize(data.slices);
  out.lengths.resize(data.strips);
  out.swelling.resize(data.strips);
  out.twists.resize(data.strips);
  const int batches = data.batches.size();
  if (threads > 1 && data.slices >= kSlicesForThreads) {
    const int grain = (batches + 2 * threads - 1) / (2 * threads);
    tbb::parallel_for(
        tbb::blocked_range<int>(0, batches, grain),
        [&](const tbb::blocked_range<int>& some) {
          for (int i = some.begin(); i < some.end(); ++i)
            pose_batch(data, data.batches[i], activation, out);
        },
        tbb::simple_partitioner());
  } else {
    for (const PosingBatch& batch : data.batches) pose_batch(data, batch, activation, out);
  }
  out.clamped = clamped_strips(out);
  out.overtwisted = 0;
  for (int i = 0; i < data.strips; ++i) out.overtwisted += std::abs(out.twists[i]) > kTwistLimit;
}

double strip_volume(const PosedAnatomy& posed, const SliceRange& range) {
  return tube_volume(std::span(posed.slices).subspan(range.begin, range.end - range.begin));
}

double muscle_volume(const PosedAnatomy& posed, std::span<const SliceRange> ranges, int muscle) {
  double volume = 0;
  for (const SliceRange& range : ranges)
    if (range.muscle == muscle) volume += strip_volume(posed, range);
  return volume;
}

}  // namespace ecorche::inline v1
