// The flat form of an anatomy that pose_anatomy reads. Private to make_posing_table and
// pose_anatomy.
//
// Strips of equal slice count are posed four at a time, one a lane: the frames along a strip depend
// on one another, so the arithmetic runs in parallel across strips. Lane constants are stored row
// by row in the order in which a frame reads them.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

#include "anatomy/contact/muscle_contact.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/muscles/tendon_compliance.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche {

constexpr int kLanes = 4;
using Lane = Eigen::Array<double, kLanes,
                          1>;  // the same quantity of four strips; or x, y, z, 1 of one point

constexpr int kProfileBins = 20;

// Carried by one joint (second = -1) or a blend of two.
struct PosingPoint {
  int first = 0, second = -1;
  double share = 1;
  Vec3 in_first = Vec3::Zero(), in_second = Vec3::Zero();  // in the joints' frames
};

// Two successive path points of which one may be carried past the other when a joint closes. They
// are kept in their order, `keep` apart along the direction that the line has there.
struct PosingLink {
  int point = 0;                               // the first of the two, within the strip
  double give_first = 0.5, give_second = 0.5;  // how they share the way back
  Vec3 direction = Vec3::UnitX();              // from the first to the second at rest, unit
  double keep = 0;                             // m
  // length of line that the moved points have before the next carrier or the end, m
  double room = 0;
};

// All lengths in units of the object: it is the unit ball, or the unit cylinder about z.
struct PosingWrap {
  int joint = 0;
  bool cylinder = false;
  int begin = 0, end = 0;         // slices that hold still at either side; those between are pushed
  Vec3 center = Vec3::Zero();     // in the joint's frame
  std::array<Lane, 3> to_unit{};  // columns, joint directions -> object units, and zeros
  Mat3 from_unit = Mat3::Identity();
  Vec3 side = Vec3::UnitX();  // where the line passes at rest, unit
  Vec3 begin_at = Vec3::UnitX(),
       end_at = Vec3::UnitX();  // unit directions of the still slices at rest
  double soft = 0.1;            // margin over which the push sets in
  int slice = 0;                // first of end - begin + 1 WrapSlice
};

struct WrapSlice {
  float depth = 0;  // below the wedge that is allowed, because the rest line lies there
  float room = 0;   // push that is steep enough, seen from the still slices
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
  TendonGive give;  // by the length of its smooth line
};

// Constants of the four strips of a batch that do not depend on the row.
struct PosingLanes {
  Lane rest_chords;               // sum of the rest distances of slice points, m
  Lane length_factor;             // rest length of the smooth line over rest_chords
  Lane tendon_begin, tendon_end;  // chord positions where the belly begins and ends, m
  Lane give;                      // belly length + tendon length * compliance ratio, m
  Lane bins;                      // profile bins a metre
  Lane volume;                    // rest volume * 3 / pi, m^3
  Lane width_swells;              // 1 tube, 0 sheet
  Lane grow_min, grow_max;        // limits of the growth factor
};

struct PosingRow {
  Lane cos_roll, sin_roll, offset_x, offset_y;
  Lane width, thickness;  // rest radii less the profile's value at the slice's own place
  Eigen::Array4f twist;   // share of the insertion's turn
  Eigen::Array4f free_width, free_thickness, free_offset;  // what fold_factor lets pass
};

// Of a row's outlines and those of the next row.
using PosingAreas = AreasOf<Lane>;
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

struct PosingTable::Data {
  int slices = 0, strips = 0, joints = 0, muscles = 0;
  std::vector<PosingPoint> points;
  std::vector<Lane> weights;         // of four successive path points, a node each
  std::vector<std::uint8_t> firsts;  // path point within the strip that the first weight is for
  std::vector<PosingLink> links;
  std::vector<PosingWrap> wraps;
  std::vector<WrapSlice> wrap_slices;  // object units
  std::vector<PosingStrip> strip;
  std::vector<PosingBatch> batches;
  std::vector<PosingRow> rows;
  std::vector<PosingAreas> areas;      // #rows
  std::vector<SliceOutline> outlines;  // #slices
  std::vector<PosingProfile> profiles;
  std::vector<WrapNote> notes;
  ContactTables contact;  // empty: muscles do not touch
};

// Limits of a belly's swelling (radii over those of the rest pose; sheets: the root of the
// thickness): far beyond what fibres do.
constexpr double kLeastSwelling = 1.0 / 3, kMostSwelling = 2.5;

// How much of a radius survives a fold: q is curvature times radius toward the bend's centre, free
// what it may be (0.45, or more if it is more at rest). Beyond that the product saturates, so that
// neighbouring slices do not cross; 1 up to it.
struct FoldFactor {
  Lane over, under;  // their quotient
};
inline FoldFactor fold_factor(const Lane& q, const Lane& free) {
  const Lane size = q.abs() + 1e-12, excess = (size - free).max(0.0);
  const Lane room = (0.9 - free).max(0.15);
  const Lane under = (room + excess) * size;
  return {under - excess * excess, under};
}

// Height of the rounded wedge that stands for a wrap: over the unit ball's cap up to kWedgeSine
// from the side axis, then straight down. Points lower than it, seen from the side the line passes
// on, are inside or behind the object.
constexpr double kWedgeSine = 0.7660444431189780;   // sin 50 deg
constexpr double kWedgeSlope = 1.1917535925942100;  // tan 50 deg
constexpr double kWedgeTop = 1.5557238268604120;    // 1 / cos 50 deg
inline double wedge_height(double across_squared) {
  if (across_squared < kWedgeSine * kWedgeSine) return std::sqrt(1 - across_squared);
  return kWedgeTop - kWedgeSlope * std::sqrt(across_squared);
}
inline Lane wedge_height(const Lane& across_squared) {
  const Lane cap = (1 - across_squared).max(0.0).sqrt(),
             sides = kWedgeTop - kWedgeSlope * across_squared.sqrt();
  return (across_squared < kWedgeSine * kWedgeSine).select(cap, sides);
}

}  // namespace ecorche
