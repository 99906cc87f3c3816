// The content of a PosingTable: an anatomy in flat arrays, in the order in which a frame reads
// them. Private to posing and to stages that change posed slices.
//
// Double4 constants are stored row by row: a row is one slice of each of the four strips of a batch
// (strip_lanes.h).
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

#include "anatomy/muscles/slice_outline.h"
#include "anatomy/muscles/tendon_compliance.h"
#include "anatomy/posing/strip_lanes.h"
#include "anatomy/posing/wrap_note.h"
#include "anatomy/posing/wrapping.h"

namespace ecorche::inline v1 {

constexpr int kProfileBins = 20;

// Carried by one joint (second = -1) or a blend of two.
struct PosingPoint {
  int first = 0, second = -1;
  double share = 1;
  Vec3 in_first = Vec3::Zero(), in_second = Vec3::Zero();  // in the joints' frames
};

// Two successive path points of which a closing joint may carry one past the other. They are kept
// in their order, at least `keep` apart along the line's direction there.
struct PosingLink {
  int point = 0;                               // the first of the two, within the strip
  double part_first = 0.5, part_second = 0.5;  // of the way back that each takes
  Vec3 direction = Vec3::UnitX();              // from the first to the second at rest, unit
  double keep = 0;                             // m
  // length of line that the moved points have before a point of another bone, or the end, m
  double room = 0;
};

struct PosingStrip {
  int strip = 0;  // index among all strips
  int muscle = 0;
  int slice = 0;              // first flat slice
  int point = 0, points = 0;  // path points, at least four (padded)
  int link = 0, links = 0;
  int wrap = 0, wraps = 0;
  // unit, perpendicular to the tangent; carried by the first path point
  Vec3 reference = Vec3::UnitX();
  Vec3 begin_tangent = Vec3::UnitY();
  // where the rest frame has arrived; carried by the last path point
  Vec3 end_reference = Vec3::UnitX();
  Vec3 end_tangent = Vec3::UnitY();
  TendonCompliance compliance;  // by the length of its smooth line
};

// Constants of the four strips of a batch that do not depend on the row.
struct PosingLanes {
  Double4 rest_chords;               // sum of the rest distances of slice points, m
  Double4 length_factor;             // rest length of the smooth line over rest_chords
  Double4 tendon_begin, tendon_end;  // chord positions where the belly begins and ends, m
  Double4 stretch_length;            // belly length + tendon length * kTendonStretchRatio, m
  Double4 bins;                      // profile bins a metre
  Double4 volume;                    // rest volume * 3 / pi, m^3
  Double4 width_swells;              // 1 tube, 0 sheet
  Double4 scale_min, scale_max;      // limits of the belly's scale
};

struct PosingRow {
  Double4 cos_roll, sin_roll, offset_x, offset_y;
  Double4 width, thickness;  // rest radii less the profile's value at the slice's own place
  Eigen::Array4f twist;      // share of the insertion's turn
  Eigen::Array4f free_width, free_thickness, free_offset;  // what fold_factor lets pass
};

// Of a row's sections at full effort (tense_thickening.h).
struct PosingThickening {
  Eigen::Array4f share, along_width, along_thickness;  // the last two: its direction
};

// Of a row's outlines and those of the next row.
using PosingAreas = AreasOf<Double4>;
inline void set_lane(PosingAreas& areas, int lane, const PieceAreas& of) {
  areas.own[lane] = of.own;
  areas.ab[lane] = of.ab, areas.ba[lane] = of.ba, areas.aa[lane] = of.aa, areas.bb[lane] = of.bb;
  areas.more_a1[lane] = of.more_a1, areas.more_b1[lane] = of.more_b1,
  areas.more_a0[lane] = of.more_a0, areas.more_b0[lane] = of.more_b0;
}

struct PosingBatch {
  int rows = 0;                     // slices of each strip
  int strips = 0;                   // 1 .. kLanes; the rest repeat the last
  int row = 0;                      // first PosingRow
  int node = 0;                     // first weight; lane by lane, rows each
  int profile = 0;                  // first of kLanes profiles
  std::array<int, kLanes> strip{};  // index into strip data
  PosingLanes lanes;
};

// Half width, half thickness and belly share along the rest line at kProfileBins + 1 even places
// (and once more the last), linear between. Single precision: only differences to the value at the
// slice's own place matter.
struct PosingProfile {
  std::array<Eigen::Array4f, kProfileBins + 2> at;

  Eigen::Array4f operator()(double bin) const {
    const int i = bin;
    return at[i] + float(bin - i) * (at[i + 1] - at[i]);
  }
};

struct PosingData {
  int slices = 0, strips = 0, joints = 0, muscles = 0;
  std::vector<PosingPoint> points;
  std::vector<Double4> weights;      // of four successive path points, a node each
  std::vector<std::uint8_t> firsts;  // path point within the strip that the first weight is for
  std::vector<PosingLink> links;
  std::vector<PosingWrap> wraps;
  std::vector<WrapSlice> wrap_slices;  // object units
  std::vector<PosingStrip> strip;
  std::vector<PosingBatch> batches;
  std::vector<PosingRow> rows;
  std::vector<PosingAreas> areas;  // #rows
  // #rows; apart, since most frames do not read it
  std::vector<PosingThickening> thickening;
  std::vector<SliceOutline> outlines;  // #slices
  std::vector<PosingProfile> profiles;
  std::vector<WrapNote> notes;
};

// Limits of a belly's swelling (radii over those of the rest pose; sheets: the root of the
// thickness), far beyond those of fibres.
constexpr double kLeastSwelling = 1.0 / 3, kMostSwelling = 3;

// Factor of a radius that keeps neighbouring slices from crossing in a bend. q: curvature times
// radius towards the bend's centre; free: its limit (0.45, or its value at rest if that is larger).
// 1 up to the limit; beyond it the product saturates.
struct FoldFactor {
  Double4 over, under;  // their quotient
};
inline FoldFactor fold_factor(const Double4& q, const Double4& free) {
  const Double4 size = q.abs() + 1e-12, excess = (size - free).max(0.0);
  const Double4 room = (0.9 - free).max(0.15);
  const Double4 under = (room + excess) * size;
  return {under - excess * excess, under};
}

}  // namespace ecorche::inline v1
