#include "skinning/interior/bone_beds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/join_meshes.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSpacing = 3e-3;  // m, of the grid
constexpr double kLean = 0.5;      // of the way out to where sheets face
constexpr double kFlat = 0.6;      // of its thickness to its width
constexpr double kBorder = 40e-3;  // m, of the grid beyond the bone
constexpr double kSlope = 2;       // of heights beyond the bone's outline
constexpr float kNoBone = -std::numeric_limits<float>::infinity();
constexpr double kClear = 4e-3;  // m, between sheet and bone
// m below the bone's outer side, from which on less rises and nothing
constexpr double kDeep = 40e-3, kDeepest = 70e-3;
constexpr float kMostLift = 60e-3f;  // m
constexpr double kBeside = 1.3;      // of half widths, between the lines of strips side by side
constexpr int kRounds = 24, kSmoothRounds = 1;
constexpr float kSpread = 0.96f;  // of the neighbours' mean

// Square to a flat bone's plane. None: it is not flat, as a rib cage.
std::optional<Vec3> normal_of(const TriMesh& bone) {
  const Vec3 middle = bone.V.colwise().mean();
  const Points from_middle = bone.V.rowwise() - middle.transpose();
  const SymmetricEigen<3> spread = symmetric_eigen<3>(from_middle.transpose() * from_middle);
  if (spread.values[0] > kFlat * kFlat * spread.values[1]) return {};
  return spread.vectors.col(0);
}

// Lets the heights fall beyond the bone's outline, so that what comes over it rises step by step.
void slope_off(BoneBed& bed) {
  const float straight = float(kSlope * kSpacing), aslant = std::numbers::sqrt2_v<float> * straight;
  const auto raise_by = [&](int r, int c, int from_r, int from_c, float fall) {
    if (from_r < 0 || from_r >= bed.rows || from_c < 0 || from_c >= bed.columns) return;
    float& here = bed.heights[std::size_t(r * bed.columns + c)];
    here = std::max(here, bed.heights[std::size_t(from_r * bed.columns + from_c)] - fall);
  };
  for (const int way : {1, -1})
    for (int i = 0; i < bed.rows; ++i)
      for (int j = 0; j < bed.columns; ++j) {
        const int r = way > 0 ? i : bed.rows - 1 - i, c = way > 0 ? j : bed.columns - 1 - j;
        raise_by(r, c, r, c - way, straight);
        raise_by(r, c, r - way, c, straight);
        raise_by(r, c, r - way, c - 1, aslant);
        raise_by(r, c, r - way, c + 1, aslant);
      }
}

// Which way a bed's heights are counted: out of the bone's plane on the side of the points that
// glide, leaning towards the way that the gliding sections face.
Vec3 way_out(const TriMesh& bone, const Vec3& normal, std::span<const Vec3> gliding,
             std::span<const Vec3> facing) {
  double side = 0;
  for (const Vec3& point : gliding) {
    Eigen::Index nearest = 0;
    (bone.V.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    side += (point - Vec3(bone.V.row(nearest))).dot(normal);
  }
  const Vec3 out = side < 0 ? Vec3(-normal) : normal;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& way : facing) mean += way.dot(out) < 0 ? Vec3(-way) : way;
  return (out + kLean * mean.stableNormalized()).normalized();
}

// `gliding`: points that glide on the bone. `facing`: across their sheet, either way. Without
// heights where there is no such bone or it is not flat.
BoneBed make_bed(const Anatomy& anatomy, int joint, std::span<const Vec3> gliding,
                 std::span<const Vec3> facing) {
  std::vector<const TriMesh*> parts;
  for (const Bone& bone : anatomy.bones)
    if (bone.joint == joint) parts.push_back(&bone.mesh);
  BoneBed out;
  out.joint = joint;
  if (parts.empty()) return out;
  const TriMesh bone = join_meshes(parts);
  const std::optional<Vec3> normal = normal_of(bone);
  if (!normal) return out;
  const Vec3 origin = rest_positions(anatomy.skeleton)[std::size_t(joint)];
  out.axes = Quat::FromTwoVectors(Vec3::UnitZ(), way_out(bone, *normal, gliding, facing))
                 .toRotationMatrix();
  const Points flat = (bone.V.rowwise() - origin.transpose()) * out.axes;
  out.corner = flat.colwise().minCoeff().transpose().array() - kBorder;
  const Vec3 size = flat.colwise().maxCoeff().transpose() - out.corner;
  out.columns = int((size.x() + kBorder) / kSpacing) + 1;
  out.rows = int((size.y() + kBorder) / kSpacing) + 1;
  out.heights.assign(std::size_t(out.columns * out.rows), kNoBone);
  for (Eigen::Index f = 0; f < bone.F.rows(); ++f) {
    std::array<Vec3, 3> at;
    for (int k = 0; k < 3; ++k)
      at[std::size_t(k)] = flat.row(bone.F(f, k)).transpose() - out.corner;
    const double longest =
        std::max({(at[1] - at[0]).norm(), (at[2] - at[1]).norm(), (at[0] - at[2]).norm()});
    const int steps = int(2 * longest / kSpacing) + 1;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const Vec3 point = at[0] + (at[1] - at[0]) * i / steps + (at[2] - at[0]) * j / steps;
        float& height = out.heights[std::size_t(int(point.y() / kSpacing) * out.columns +
                                                int(point.x() / kSpacing))];
        height = std::max(height, float(point.z()));
      }
  }
  slope_off(out);
  return out;
}

// The height at a point of the plane, from its four cells; kNoBone outside.
float height_at(const BoneBed& bed, double x, double y) {
  const double u = x / kSpacing - 0.5, v = y / kSpacing - 0.5;
  const int c = int(std::floor(u)), r = int(std::floor(v));
  if (c < 0 || r < 0 || c + 1 >= bed.columns || r + 1 >= bed.rows) return kNoBone;
  const float s = float(u - c), t = float(v - r);
  const float* low = &bed.heights[std::size_t(r * bed.columns + c)];
  const float* high = low + bed.columns;
  return (1 - t) * ((1 - s) * low[0] + s * low[1]) + t * ((1 - s) * high[0] + s * high[1]);
}

// How far a section must rise until its inner side lies over the bone.
float wanted_by(const BoneBed& bed, const Transform& X_WJ, const Ellipse& section) {
  const Mat3 R = X_WJ.linear() * bed.axes;
  const Vec3 center = R.transpose() * (section.center - X_WJ.translation()) - bed.corner,
             width = R.transpose() * section.axes.col(0) * section.radii.x(),
             thick = R.transpose() * section.axes.col(1) * section.radii.y();
  constexpr std::size_t kQuarter = kOutlinePoints / 4;
  const Vec3 inner = thick.z() > 0 ? Vec3(-thick * double(section.outline[3 * kQuarter]))
                                   : Vec3(thick * double(section.outline[kQuarter]));
  float most = 0;
  for (const double across : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
    const double reach = double(section.outline[across < 0 ? 2 * kQuarter : 0]);
    const Vec3 point = center + across * reach * width + std::sqrt(1 - across * across) * inner;
    const double wanted = double(height_at(bed, point.x(), point.y())) + kClear - point.z();
    if (wanted > 0)
      most = std::max(most, float(wanted * (1 - smooth_step(kDeep, kDeepest, wanted))));
  }
  return std::min(most, kMostLift);
}

// Lifts at least as wanted, elsewhere the mean of those before, after and beside. Ends stay.
void spread_along(std::span<const int> begins, std::span<const float> wanted,
                  std::span<float> lifts) {
  const int strips = int(begins.size()) - 1;
  std::ranges::copy(wanted, lifts.begin());
  const auto beside = [&](int strip, double share) {
    const int begin = begins[std::size_t(strip)], last = begins[std::size_t(strip) + 1] - 1;
    const double at = begin + share * (last - begin);
    const int k = std::min(int(at), last - 1);
    const float t = float(at - k);
    return (1 - t) * lifts[std::size_t(k)] + t * lifts[std::size_t(k) + 1];
  };
  for (int round = 0; round < kRounds + kSmoothRounds; ++round)
    for (int s = 0; s < strips; ++s) {
      const int begin = begins[std::size_t(s)], end = begins[std::size_t(s) + 1];
      lifts[std::size_t(begin)] = lifts[std::size_t(end) - 1] = 0;
      for (int k = begin + 1; k + 1 < end; ++k) {
        const double share = double(k - begin) / (end - 1 - begin);
        float& here = lifts[std::size_t(k)];
        const float mean = 0.25f * (lifts[std::size_t(k) - 1] + lifts[std::size_t(k) + 1] +
                                    (s > 0 ? beside(s - 1, share) : here) +
                                    (s + 1 < strips ? beside(s + 1, share) : here));
        here = round < kRounds ? std::max(wanted[std::size_t(k)], kSpread * mean)
                               : std::max(0.95f * wanted[std::size_t(k)], 0.5f * (here + mean));
      }
    }
}

// Raises a strip's sections, which turn as their line does.
void raise(std::span<const float> lifts, const Vec3& out, std::span<Ellipse> strip) {
  const auto line = [&](std::size_t k) -> Vec3 {
    return strip[std::min(k + 1, strip.size() - 1)].center - strip[k > 0 ? k - 1 : 0].center;
  };
  std::array<Vec3, kMaxStripSlices> before;
  for (std::size_t k = 0; k < strip.size(); ++k) before[k] = line(k);
  for (std::size_t k = 0; k < strip.size(); ++k) strip[k].center += double(lifts[k]) * out;
  for (std::size_t k = 1; k + 1 < strip.size(); ++k) {
    const Vec3 after = line(k);
    if (before[k].norm() < 1e-9 || after.norm() < 1e-9) continue;
    strip[k].axes = Quat::FromTwoVectors(before[k], after).toRotationMatrix() * strip[k].axes;
  }
}

// Whether two strips run side by side.
bool adjoin(const SliceRange& a, const SliceRange& b, std::span<const Ellipse> slices) {
  constexpr int kPlaces = 8;
  double apart = 0, reach = 0;
  for (int i = 1; i < kPlaces; ++i) {
    const auto at = [&](const SliceRange& strip) -> const Ellipse& {
      return slices[std::size_t(strip.begin + (strip.end - 1 - strip.begin) * i / kPlaces)];
    };
    apart += (at(a).center - at(b).center).norm();
    reach += at(a).radii.x() + at(b).radii.x();
  }
  return apart < kBeside * reach;
}

std::vector<SliceRange> strips_of(std::span<const SliceRange> strips, int muscle) {
  std::vector<SliceRange> out;
  for (const SliceRange& strip : strips)
    if (strip.muscle == muscle) out.push_back(strip);
  return out;
}

// A muscle's `own` strips, before and after them those of the sheets whose first or last strip runs
// beside its last or first one: parts of one sheet are muscles of their own.
std::vector<SliceRange> with_sheets_beside(const Anatomy& anatomy,
                                           std::span<const SliceRange> strips,
                                           std::span<const Ellipse> slices,
                                           const std::vector<SliceRange>& own) {
  const Muscle& muscle = anatomy.muscles[std::size_t(own.front().muscle)];
  std::vector<SliceRange> out = own;
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    const Muscle& other = anatomy.muscles[m];
    if (&other == &muscle || !other.sheet || other.layer != muscle.layer) continue;
    const std::vector<SliceRange> its = strips_of(strips, int(m));
    if (its.empty()) continue;
    if (adjoin(own.back(), its.front(), slices))
      out.insert(out.end(), its.begin(), its.end());
    else if (adjoin(its.back(), own.front(), slices))
      out.insert(out.begin(), its.begin(), its.end());
  }
  return out;
}

bool ends_on(const Strip& strip, int joint) {
  return strip.path.front().joints[0] == joint || strip.path.back().joints[0] == joint;
}

BeddedSheet make_sheet(const Anatomy& anatomy, std::span<const Ellipse> slices, const BoneBed& bed,
                       const Transform& X_WJ, std::vector<SliceRange> strips) {
  BeddedSheet out;
  for (const SliceRange& strip : strips) {
    const bool follows = !ends_on(
        anatomy.muscles[std::size_t(strip.muscle)].strips[std::size_t(strip.strip)], bed.joint);
    for (int k = strip.begin; k < strip.end; ++k) {
      float most = follows ? std::numeric_limits<float>::infinity() : 0;
      for (int i = std::max(k - 1, strip.begin); i < std::min(k + 2, strip.end); ++i)
        most = std::max(most, wanted_by(bed, X_WJ, slices[std::size_t(i)]));
      out.rest.push_back(most);
    }
    out.begins.push_back(int(out.rest.size()));
  }
  out.strips = std::move(strips);
  return out;
}

}  // namespace

BoneBeds make_bone_beds(const Anatomy& anatomy, std::span<const Ellipse> slices) {
  BoneBeds out;
  std::vector<Transform> X_WJ;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), X_WJ);
  const std::vector<SliceRange> strips = slice_ranges(anatomy);
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    std::map<int, std::vector<Vec3>> gliding;  // points, by the joint whose bones they glide on
    for (const Strip& strip : anatomy.muscles[m].strips)
      for (const PathPoint& point : strip.path)
        if (point.placing_joint >= 0) gliding[point.placing_joint].push_back(point.rest);
    if (gliding.empty()) continue;
    const std::vector<SliceRange> own = strips_of(strips, int(m));
    for (const auto& [joint, points] : gliding) {
      auto bed = std::ranges::find(out.beds, joint, &BoneBed::joint);
      if (bed == out.beds.end()) {
        std::vector<Vec3> facing;
        for (const SliceRange& strip : own)
          for (int k = strip.begin; k < strip.end; ++k)
            facing.push_back(slices[std::size_t(k)].axes.col(1));
        bed = out.beds.insert(bed, make_bed(anatomy, joint, points, facing));
      }
      if (bed->heights.empty()) continue;
      out.sheets.push_back(make_sheet(anatomy, slices, *bed, X_WJ[std::size_t(joint)],
                                      with_sheets_beside(anatomy, strips, slices, own)));
      out.sheets.back().bed = int(bed - out.beds.begin());
    }
  }
  return out;
}

void lift_over_bones(const BoneBeds& beds, std::span<const Transform> X_WJ,
                     std::span<Ellipse> slices, BoneBedWorkspace& workspace) {
  for (const BeddedSheet& sheet : beds.sheets) {
    const BoneBed& bed = beds.beds[std::size_t(sheet.bed)];
    const Transform& X_WB = X_WJ[std::size_t(bed.joint)];
    workspace.wanted.assign(sheet.rest.size(), 0);
    bool any = false;
    std::size_t i = 0;
    for (const SliceRange& strip : sheet.strips)
      for (int k = strip.begin; k < strip.end; ++k, ++i) {
        float& wanted = workspace.wanted[i];
        if (std::isfinite(sheet.rest[i]))
          wanted = std::max(0.0f, wanted_by(bed, X_WB, slices[std::size_t(k)]) - sheet.rest[i]);
        any = any || wanted > 0;
      }
    if (!any) continue;
    workspace.lifts.resize(sheet.rest.size());
    spread_along(sheet.begins, workspace.wanted, workspace.lifts);
    const Vec3 out = X_WB.linear() * bed.axes.col(2);
    for (std::size_t s = 0; s < sheet.strips.size(); ++s) {
      const SliceRange& strip = sheet.strips[s];
      const std::size_t sections = std::size_t(strip.end - strip.begin);
      raise(std::span(workspace.lifts).subspan(std::size_t(sheet.begins[s]), sections), out,
            slices.subspan(std::size_t(strip.begin), sections));
    }
  }
}

}  // namespace ecorche::inline v1
