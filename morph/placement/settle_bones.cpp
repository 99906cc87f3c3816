#include "morph/placement/settle_bones.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTrigger = 0.05e-3,
                 kMargin = 0.4e-3;  // m below the skin: moved if above, to where
// Radius over move. Smaller: bones get dents; 2.6 and less lets them fold.
constexpr double kSteepest = 3;
// Radius over the part's largest extent, and its limits, m: dents of the size of the bone's own
// features.
constexpr double kOfExtent = 0.18, kNarrowest = 3e-3, kWidest = 35e-3;
constexpr double kLongestMove = 12e-3;  // m: palpable points that are further off are left alone
constexpr double kWithin = 0.3e-3;      // m: how far inside their brackets they are brought
constexpr int kRounds = 4;              // of palpable points and containment in turn
constexpr int kPushes = 120;            // of one part in a round, at most

constexpr double kReach = 3;  // radii beyond which a push moves nothing

Vec3 mirrored(const Vec3& x, double plane) { return {2 * plane - x.x(), x.y(), x.z()}; }

double fade(const LocalPush& push, const Vec3& centre, const Vec3& x) {
  const double d2 = (x - centre).squaredNorm() / (push.radius * push.radius);
  if (d2 > kReach * kReach) return 0;
  // to zero at the reach
  const double end = 1 - d2 / (kReach * kReach);
  return std::exp(-d2) * end * end;
}

Vec3 pushed_once(const LocalPush& push, double plane, const Vec3& x) {
  Vec3 out = x + fade(push, push.centre, x) * push.move;
  if (push.twin)
    out += fade(push, mirrored(push.centre, plane), x) *
           Vec3(-push.move.x(), push.move.y(), push.move.z());
  return out;
}

// A part with what is known of its vertices' distances.
struct Work {
  SettledPart& part;
  double plane;
  double extent;
  std::vector<Eigen::VectorXd> most;  // upper bounds of the signed distances
  std::vector<Vec3> points;           // palpable ones

  Work(SettledPart& of, double at) : part(of), plane(at) {
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (const Points& V : part.bones) {
      most.emplace_back(Eigen::VectorXd::Constant(V.rows(), 1e300));
      low = low.cwiseMin(V.colwise().minCoeff().transpose());
      high = high.cwiseMax(V.colwise().maxCoeff().transpose());
    }
    extent = (high - low).maxCoeff();
  }

  void push(const Vec3& centre, const Vec3& move) {
    LocalPush push{centre, move, 0, false};
    push.radius =
        std::max(kSteepest * move.norm(), std::clamp(kOfExtent * extent, kNarrowest, kWidest));
    if (part.even) {
      push.twin = std::abs(centre.x() - plane) > 0.5 * push.radius;
      if (!push.twin) push.centre.x() = plane, push.move.x() = 0;
    }
    for (std::size_t b = 0; b < part.bones.size(); ++b)
      for (Eigen::Index i = 0; i < part.bones[b].rows(); ++i) {
        const Vec3 x = part.bones[b].row(i), y = pushed_once(push, plane, x);
        most[b][i] += (y - x).norm();
        part.bones[b].row(i) = y;
      }
    for (Vec3& x : points) x = pushed_once(push, plane, x);
    part.pushes.push_back(push);
  }
};

void push_inside(const SkinField& skin, Work& work) {
  for (int k = 0; k < kPushes; ++k) {
    SkinPoint worst;
    Vec3 from = Vec3::Zero();
    worst.distance = -kTrigger;
    for (std::size_t b = 0; b < work.part.bones.size(); ++b) {
      SkinPoint at;
      Vec3 asked = Vec3::Constant(1e300);
      for (Eigen::Index i = 0; i < work.part.bones[b].rows(); ++i) {
        const Vec3 x = work.part.bones[b].row(i);
        double& most = work.most[b][i];
        most = std::min(most, at.distance + (x - asked).norm());  // distances change no faster
        if (most <= worst.distance) continue;
        at = skin.nearest_judged(x, at.triangle);
        asked = x;
        most = at.distance;
        if (at.distance > worst.distance) worst = at, from = x;
      }
    }
    if (worst.distance <= -kTrigger) return;
    work.push(from, -(worst.distance + kMargin) * worst.gradient);
  }
}

void bring_to_depth(const SkinField& skin, const std::vector<PalpablePoint>& asked, Work& work) {
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const SkinPoint at = skin.nearest_judged(work.points[k]);
    const double depth = -at.distance;
    double deeper = 0;
    if (depth < asked[k].low) deeper = asked[k].low + kWithin - depth;
    if (depth > asked[k].high) deeper = asked[k].high - kWithin - depth;
    if (deeper == 0 || std::abs(deeper) > kLongestMove) continue;
    work.push(work.points[k], -deeper * at.gradient);
  }
}

}  // namespace

void keep_below(const TriMesh& above, double plane, double clearance, SettledPart& below) {
  constexpr double kThrough = 0.02;  // m: bones farther than this through others are not looked for
  const SkinRays rays(above);
  const Points& over = above.V;
  const Eigen::RowVector3d reach = Eigen::RowVector3d::Constant(kThrough + clearance),
                           low = over.colwise().minCoeff() - reach,
                           high = over.colwise().maxCoeff() + reach;
  Work work(below, plane);
  double front = -1e300, back = 1e300;
  for (const Points& bone : below.bones)
    front = std::max(front, bone.col(2).maxCoeff()), back = std::min(back, bone.col(2).minCoeff());
  const double middle = 0.5 * (front + back);
  // m, by which a point has to go inwards; the way out
  const auto wanted = [&](const Vec3& x) -> std::pair<double, Vec3> {
    if ((x.transpose().array() < low.array()).any() || (x.transpose().array() > high.array()).any())
      return {0, Vec3::Zero()};
    const Vec3 out = Vec3(x.x() - plane, 0, x.z() - middle).normalized();
    double by = 0;
    const RayHit over_it = rays.first_hit(x, out, clearance);
    if (over_it.triangle >= 0) by = clearance - over_it.distance;
    // the innermost face that it has come through
    const RayHit through = rays.first_hit(x - kThrough * out, out, kThrough);
    if (through.triangle >= 0) by = kThrough - through.distance + clearance;
    return {by, out};
  };
  for (int k = 0; k < kPushes; ++k) {
    constexpr double kLeast = 0.1e-3;  // m
    double most = kLeast;
    Vec3 from = Vec3::Zero(), out = Vec3::Zero();
    for (const Points& bone : below.bones)
      for (Eigen::Index i = 0; i < bone.rows(); ++i)
        if (const auto [by, way] = wanted(bone.row(i)); by > most)
          most = by, from = bone.row(i), out = way;
    if (most <= kLeast) return;
    work.push(from, -most * out);
  }
}

Vec3 pushed(const std::vector<LocalPush>& pushes, double plane, const Vec3& x) {
  Vec3 out = x;
  for (const LocalPush& push : pushes) out = pushed_once(push, plane, out);
  return out;
}

void settle_bones(const SkinField& skin, double plane, const std::vector<PalpablePoint>& points,
                  std::vector<SettledPart>& parts) {
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    Work work(parts[p], plane);
    std::vector<PalpablePoint> own;
    for (const PalpablePoint& point : points) {
      if (point.part != int(p)) continue;
      own.push_back(point);
      work.points.push_back(point.x);
    }
    for (int round = 0; round < kRounds; ++round) {
      const std::size_t before = work.part.pushes.size();
      bring_to_depth(skin, own, work);
      push_inside(skin, work);
      if (work.part.pushes.size() == before) break;
    }
    for (std::size_t b = 0; b < work.part.bones.size(); ++b) {
      SkinPoint at;
      for (Eigen::Index i = 0; i < work.part.bones[b].rows(); ++i) {
        double& distance = work.most[b][i];
        if (distance > 0) {
          at = skin.nearest_judged(work.part.bones[b].row(i), at.triangle);
          distance = at.distance;
        }
        work.part.outside += distance > 0;
        work.part.furthest = std::max(work.part.furthest, distance);
      }
    }
  });
}

}  // namespace ecorche::inline v1
