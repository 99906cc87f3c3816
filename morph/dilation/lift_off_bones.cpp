#include "morph/dilation/lift_off_bones.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "anatomy/muscles/slice_outline.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

// Of a section's smaller half axis, and its limits, m: how far centres stay from bone. Larger:
// strips bend away from bones that they lie on; smaller: what is left of a section is thin.
constexpr double kClearance = 0.5, kLeastClearance = 0.3e-3, kMostClearance = 3e-3;
// m, that a centre is moved at most. Larger: strips turn aside and back; smaller: more of them is
// cut away.
constexpr double kMostLift = 0.012;
constexpr double kDeepest = 0.02;  // m: centres further in bone are not moved
// More: what neighbours drew back into bone comes out again; nothing moves any more after some.
constexpr int kLiftRounds = 6;
constexpr int kBetween = 4;          // places that are looked at from one section to the next
constexpr double kBelowSkin = 2e-3;  // m, that a centre is moved to at most
// Least cosine between a move and the thickness of a sheet: sideways are its other strips.
constexpr double kAcrossSheet = 0.7;
constexpr double kBeside = 0.02;       // m: bones so near tell on which side of them a sheet lies
constexpr double kFarSkin = 0.1;       // m: skin beyond counts as so far
constexpr double kCarried = 0.025;     // m over a lifted muscle, up to which others go with it
constexpr double kLeastMove = 0.2e-3;  // m, that carries others

// Least cosine between a move and the way that suits the rest of the strip.
constexpr double kAlongWay = 0.5;
// What a metre costs, a metre of a move being 1: from where a section was carried, and between what
// two neighbours have gone from there. Larger: sections of one strip leave a bone on one side, on
// the one that they came from, farther off.
constexpr double kFromCarried = 2, kApart = 4;
constexpr double kWrongSide = 0.03;  // m of a move, that it costs a sheet to go to its other side

// Sides of a section's plane: towards +y, -y, or any.
using Facing = int;

// What rays in a section's plane meet of bones, in kOutlinePoints directions.
struct PlaneLook {
  std::array<RayHit, kOutlinePoints> hits;
  bool inside = false;
};

PlaneLook look_round(const Ellipse& slice, const BoneRays& bones) {
  constexpr std::size_t kQuarter = kOutlinePoints / 4;
  PlaneLook out;
  int leaving = 0, entering = 0;
  for (std::size_t i = 0; i < std::size_t(kOutlinePoints); ++i) {
    if (i == 4 && leaving == 0) return out;  // four directions say enough
    const std::size_t direction = i % 4 * kQuarter + i / 4;
    const RayHit hit = bones.rays.first_hit(
        slice.center, slice.axes.leftCols<2>() * outline_directions()[direction], kDeepest);
    out.hits[direction] = hit;
    if (hit.triangle >= 0) ++(hit.facing > 0 ? leaving : entering);
  }
  out.inside = leaving > entering && leaving > int(kQuarter);
  return out;
}

double clearance_of(const Ellipse& slice) {
  return std::clamp(kClearance * slice.radii.minCoeff(), kLeastClearance, kMostClearance);
}

// Where a section's centre has to go so that it lies out of bone; none where it does already.
// `allowed`: whether it may go in a direction, to the surface of a bone.
template <class Allowed>
std::optional<Vec2> way_out(const Ellipse& slice, const BoneRays& bones, const Allowed& allowed) {
  const PlaneLook look = look_round(slice, bones);
  if (!look.inside) return std::nullopt;
  std::optional<Vec2> out;
  double least = 1e300;
  for (std::size_t i = 0; i < std::size_t(kOutlinePoints); ++i) {
    const RayHit& hit = look.hits[i];
    const Vec2& d = outline_directions()[i];
    if (hit.triangle < 0 || hit.facing <= 0 || hit.distance >= least) continue;
    if (!allowed(d, bones.bone[std::size_t(hit.triangle)])) continue;
    least = hit.distance;
    out = (double(hit.distance) + clearance_of(slice)) * d;
  }
  return out;
}

// The ways on which the sections of a strip leave bone so that all of them together are short and
// neighbours stay beside each other (dynamic programming over the directions of each); nought for
// those that lie out of bone. `more(k, direction, bone)`: what a way costs besides, m; none where
// section k may not go.
template <class More>
std::vector<Vec3> ways_of_strip(std::span<const Ellipse> slices, std::span<const Ellipse> carried,
                                const BoneRays& bones, const More& more) {
  struct Way {
    Vec3 move = Vec3::Zero(), from_carried = Vec3::Zero();
    double cost = 0;         // of all moves up to here
    std::size_t before = 0;  // of the ways of the section before
  };
  std::vector<std::vector<Way>> ways(slices.size());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const PlaneLook look = look_round(slices[k], bones);
    for (std::size_t i = 0; i < std::size_t(kOutlinePoints) && look.inside; ++i) {
      const RayHit& hit = look.hits[i];
      if (hit.triangle < 0 || hit.facing <= 0) continue;
      const Vec2& d = outline_directions()[i];
      const std::optional<double> besides = more(k, d, bones.bone[std::size_t(hit.triangle)]);
      if (!besides) continue;
      Way& way = ways[k].emplace_back();
      way.move =
          (double(hit.distance) + clearance_of(slices[k])) * (slices[k].axes.leftCols<2>() * d);
      way.cost = *besides;
    }
    if (ways[k].empty()) ways[k].push_back({});
    for (Way& way : ways[k]) {
      way.from_carried = slices[k].center + way.move - carried[k].center;
      double least = 1e300;
      for (std::size_t b = 0; k > 0 && b < ways[k - 1].size(); ++b) {
        const Way& before = ways[k - 1][b];
        const double cost = before.cost + kApart * (way.from_carried - before.from_carried).norm();
        if (cost < least) least = cost, way.before = b;
      }
      way.cost += way.move.norm() + kFromCarried * way.from_carried.norm() + (k > 0 ? least : 0);
    }
  }
  std::vector<Vec3> out(slices.size(), Vec3::Zero());
  std::size_t at = 0;
  for (std::size_t k = slices.size(); k-- > 0;) {
    if (k + 1 == slices.size())
      at = std::size_t(std::ranges::min_element(ways[k], {}, &Way::cost) - ways[k].begin());
    out[k] = ways[k][at].move.stableNormalized();
    at = ways[k][at].before;
  }
  return out;
}

// Two sections that a muscle goes on between: of a strip, or of a sheet's strips side by side.
struct Neighbours {
  std::size_t one = 0, next = 0;
};

// Pairs along the strips first, strip by strip.
std::vector<Neighbours> neighbours_of(const Muscle& muscle) {
  std::vector<Neighbours> out;
  std::size_t at = 0;
  for (const Strip& strip : muscle.strips) {
    for (std::size_t k = 1; k < strip.slices.size(); ++k) out.push_back({at + k - 1, at + k});
    at += strip.slices.size();
  }
  at = 0;
  for (std::size_t s = 1; s < muscle.strips.size() && muscle.sheet; ++s) {
    const std::size_t here = muscle.strips[s - 1].slices.size(),
                      beside = muscle.strips[s].slices.size();
    for (std::size_t k = 0; k < here && here > 1 && beside > 0; ++k)
      out.push_back({at + k, at + here + k * (beside - 1) / (here - 1)});
    at += here;
  }
  return out;
}

// The section at a share t of the way from one to the next, with the frame of the nearer one.
Ellipse between(const Ellipse& one, const Ellipse& next, double t) {
  Ellipse out = t < 0.5 ? one : next;
  out.center = (1 - t) * one.center + t * next.center;
  out.radii = (1 - t) * one.radii + t * next.radii;
  return out;
}

// A centre moved as far as the skin lets it.
Vec3 moved_below_skin(const Vec3& from, const Vec3& way, const SkinRays& skin) {
  const double length = way.norm();
  if (length <= 0) return from;
  const RayHit hit = skin.first_hit(from, way / length, length + kBelowSkin);
  const double share =
      hit.triangle < 0 ? 1 : std::max(0.0, double(hit.distance) - kBelowSkin) / length;
  return from + share * way;
}

// A muscle whose sections are on their way out of bone.
class LiftedMuscle {
 public:
  LiftedMuscle(const Muscle& muscle, std::span<const Ellipse> slices,
               std::span<const Ellipse> carried, const BoneRays& bones, const SkinRays& skin)
      : slices_(rounded_sections(slices)),
        start_(slices_),
        sheet_(muscle.sheet),
        bones_(bones),
        skin_(skin),
        neighbours_(neighbours_of(muscle)),
        moves_(slices.size(), Vec3::Zero()) {
    for (const Strip& strip : muscle.strips)
      ends_.push_back((ends_.empty() ? 0 : ends_.back()) + strip.slices.size());
    if (sheet_) find_sides();
    find_ways(carried);
  }

  // How far each section goes, m.
  const std::vector<Vec3>& lift() {
    for (int round = 0; round < kLiftRounds && ask(); ++round) {
      std::vector<Vec3> next = moves_;
      for (std::size_t k = 0; k < slices_.size(); ++k) next[k] += asked_[k];
      if (round + 1 < kLiftRounds) follow(next);
      for (std::size_t k = 0; k < slices_.size(); ++k) {
        slices_[k].center = moved_below_skin(slices_[k].center,
                                             start_[k].center + next[k] - slices_[k].center, skin_);
        moves_[k] = slices_[k].center - start_[k].center;
        const double length = moves_[k].norm();
        if (length > kMostLift) {
          moves_[k] *= kMostLift / length;
          slices_[k].center = start_[k].center + moves_[k];
        }
      }
    }
    return moves_;
  }

 private:
  // Which of a section's thin sides looks towards the skin, strip by strip; and on which side of
  // each bone most of the sheet lies, by what is near it and out of bone.
  void find_sides() {
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      double more = 0;
      for (std::size_t k = begin; k < end; ++k) more += skin_depth(k, -1) - skin_depth(k, 1);
      outer_.insert(outer_.end(), end - begin, more >= 0 ? 1 : -1);
      begin = end;
    }
    for (std::size_t k = 0; k < slices_.size(); ++k)
      for (const Facing side : {1, -1}) {
        const RayHit hit =
            bones_.rays.first_hit(slices_[k].center, side * slices_[k].axes.col(1), kBeside);
        if (hit.triangle < 0 || hit.facing > 0) continue;
        // Bone on the inner side: the sheet lies on the outer one.
        over_[bones_.bone[std::size_t(hit.triangle)]] -= side * outer_[k];
      }
  }

  void find_ways(std::span<const Ellipse> carried) {
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      const auto more = [&](std::size_t k, const Vec2& direction,
                            int bone) -> std::optional<double> {
        if (!sheet_) return 0;
        if (!across_sheet(direction)) return std::nullopt;
        return side_of(begin + k, bone) * direction.y() < 0 ? kWrongSide : 0;
      };
      const std::vector<Vec3> some =
          ways_of_strip(std::span(slices_).subspan(begin, end - begin),
                        carried.subspan(begin, end - begin), bones_, more);
      ways_.insert(ways_.end(), some.begin(), some.end());
      begin = end;
    }
  }

  static bool across_sheet(const Vec2& direction) {
    return std::abs(direction.y()) >= kAcrossSheet;
  }

  // Whether what is nearer to one section than to another may go in a direction, to the surface of
  // a bone.
  bool allowed(std::size_t nearer, std::size_t other, const Vec2& direction, const Vec3& in_space,
               int bone) const {
    if (sheet_ && !across_sheet(direction)) return false;
    const Vec3& way = ways_[nearer] != Vec3::Zero() ? ways_[nearer] : ways_[other];
    if (way != Vec3::Zero()) return in_space.dot(way) >= kAlongWay;
    return !sheet_ || side_of(nearer, bone) * direction.y() > 0;
  }

  double skin_depth(std::size_t k, Facing side) const {
    const RayHit hit = skin_.first_hit(slices_[k].center, side * slices_[k].axes.col(1), kFarSkin);
    return hit.triangle < 0 ? kFarSkin : double(hit.distance);
  }

  Facing side_of(std::size_t k, int bone) const {
    const auto found = over_.find(bone);
    return found == over_.end() || found->second >= 0 ? outer_[k] : -outer_[k];
  }

  // Where sections have to go so that they and what is between them lie out of bone; false where
  // all does.
  bool ask() {
    asked_.assign(slices_.size(), Vec3::Zero());
    bool any = false;
    for (const auto& [one, next] : neighbours_)
      for (int i = next == one + 1 ? 0 : 1; i <= kBetween; ++i) {
        const double t = double(i) / kBetween;
        const Ellipse here = between(slices_[one], slices_[next], t);
        const auto move = way_out(here, bones_, [&](const Vec2& direction, int bone) {
          return allowed(t < 0.5 ? one : next, t < 0.5 ? next : one, direction,
                         here.axes.leftCols<2>() * direction, bone);
        });
        if (!move) continue;
        any = true;
        const Vec3 way = here.axes.leftCols<2>() * *move;
        if (t <= 0.5) take_longer(one, way);
        if (t >= 0.5) take_longer(next, way);
      }
    return any;
  }

  void take_longer(std::size_t k, const Vec3& way) {
    const Vec3 own = in_plane(k, way);
    if (own.squaredNorm() > asked_[k].squaredNorm()) asked_[k] = own;
  }

  Vec3 in_plane(std::size_t k, const Vec3& way) const {
    const auto plane = start_[k].axes.leftCols<2>();
    return plane * (plane.transpose() * way);
  }

  // Each section follows its neighbours along the strip by half of what they went further.
  void follow(std::vector<Vec3>& moves) const {
    const std::vector<Vec3> before = moves;
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      for (std::size_t k = begin; k < end; ++k) {
        const Vec3 beside = in_plane(
            k, 0.5 * (before[std::max(k, begin + 1) - 1] + before[std::min(k + 1, end - 1)]));
        const double length = beside.norm();
        if (length <= 0) continue;
        const Vec3 direction = beside / length;
        moves[k] += 0.5 * std::max(0.0, length - before[k].dot(direction)) * direction;
      }
      begin = end;
    }
  }

  std::vector<Ellipse> slices_, start_;  // to the micrometre
  bool sheet_;
  const BoneRays& bones_;
  const SkinRays& skin_;
  std::vector<Neighbours> neighbours_;
  std::vector<std::size_t> ends_;    // #strips, of their slices
  std::vector<Vec3> moves_, asked_;  // #slices, in their planes, m
  std::vector<Facing> outer_;        // #slices of a sheet
  std::vector<Vec3> ways_;           // #slices, unit or nought
  std::map<int, int> over_;          // by bone: sections outside it less those inside
};

// A section that was lifted, before it was.
struct LiftedSection {
  std::size_t muscle = 0;
  Vec3 center, direction;
  double length = 0, width = 0;  // m
};

// How far a section has to go with what was lifted below it, beyond its own move; m.
Vec3 carried_move(std::size_t muscle, const Ellipse& slice, const Vec3& own,
                  std::span<const LiftedSection> lifted) {
  double most = 0;
  Vec3 out = Vec3::Zero();
  for (const LiftedSection& below : lifted) {
    if (below.muscle == muscle) continue;
    const Vec3 from = slice.center - below.center;
    const double above = from.dot(below.direction);
    if (above <= 0 || above >= kCarried) continue;
    const double reach = below.width + slice.radii.maxCoeff();
    const double aside = (from.squaredNorm() - above * above) / (reach * reach);
    if (aside >= 1) continue;
    const double more =
        below.length * (1 - aside) * (1 - above / kCarried) - own.dot(below.direction);
    if (more <= most) continue;
    most = more;
    out = more * below.direction;
  }
  const auto plane = slice.axes.leftCols<2>();
  return plane * (plane.transpose() * out);
}

}  // namespace

void lift_off_bones(std::span<const Muscle> muscles, std::span<Ellipse> slices,
                    std::span<const Ellipse> carried, std::span<const int> partners,
                    const BoneRays& bones, const SkinRays& skin) {
  const std::vector<std::size_t> begin = slice_begins(muscles);
  const auto for_own = [&](const auto& f) {
    tbb::parallel_for(std::size_t{0}, muscles.size(), [&](std::size_t m) {
      if (partners[m] < 0) f(m, slices.subspan(begin[m], begin[m + 1] - begin[m]));
    });
  };
  std::vector<std::vector<Vec3>> moves(muscles.size());
  for_own([&](std::size_t m, std::span<Ellipse> own) {
    moves[m] =
        LiftedMuscle(muscles[m], own, carried.subspan(begin[m], own.size()), bones, skin).lift();
  });
  std::vector<LiftedSection> lifted;
  for (std::size_t m = 0; m < muscles.size(); ++m)
    for (std::size_t k = 0; k < moves[m].size(); ++k) {
      const double length = moves[m][k].norm();
      const Ellipse& slice = slices[begin[m] + k];
      if (length > kLeastMove)
        lifted.push_back({m, slice.center, moves[m][k] / length, length, slice.radii.maxCoeff()});
    }
  for_own([&](std::size_t m, std::span<Ellipse> own) {
    for (std::size_t k = 0; k < own.size(); ++k) {
      const Vec3 whole = moves[m][k] + carried_move(m, own[k], moves[m][k], lifted);
      own[k].center = moved_below_skin(own[k].center, whole, skin);
    }
  });
}

}  // namespace ecorche::inline v1
