#include "morph/fascia/lay_sleeve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "anatomy/geometry/join_meshes.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSleeveCell = 5e-3;  // m, between points
constexpr int kFewestAround = 14, kMostAround = 40, kFewestAlong = 5, kMostAlong = 18;
constexpr double kSleeveUnderSkin = 1.0e-3;  // m that a sleeve keeps from the skin
constexpr double kUnderMuscle = 0.3e-3;      // m that it keeps from what lies over it
constexpr double kSleeveTuck = 0.5e-3;       // m that its ends lie in the bones
constexpr double kClear = 0.1e-3;            // m off a bone's surface, for rays that start there
constexpr double kLeast = 0.5e-3;            // m over bones, even where muscle lies on them
constexpr int kSleeveSweeps = 200;
constexpr double kSleeveRelaxation = 1.5;
constexpr int kSmoothRounds = 2;  // of a disc's rim
constexpr double kRim = 1.25;     // of the median radius, the most of a disc's rim: no pedicles

struct Sleeve {
  int rows = 0, columns = 0;
  std::vector<Vec3> middle;       // of each row
  std::vector<Vec3> toward;       // unit, from a row's middle outwards
  std::vector<double> reach;      // m, where rays begin
  std::vector<double> radius;     // m, the answer
  std::vector<double> low, high;  // m, its bounds
  std::vector<char> free;         // no bone is below
  std::size_t at(int r, int c) const {
    return std::size_t(r) * columns + std::size_t((c + columns) % columns);
  }
  Vec3 point(std::size_t i) const { return middle[i / columns] + radius[i] * toward[i]; }
};

// A ring's point at an angle, by a closed spline of Catmull and Rom through its control points.
Vec3 on_ring(std::span<const Vec3> ring, double t) {
  const int n = int(ring.size()), i = int(std::floor(t));
  const double u = t - i, u2 = u * u, u3 = u2 * u;
  const auto at = [&](int k) { return ring[std::size_t((k + n) % n)]; };
  return 0.5 * (2 * at(i) + (at(i + 1) - at(i - 1)) * u +
                (2 * at(i - 1) - 5 * at(i) + 4 * at(i + 1) - at(i + 2)) * u2 +
                (3 * at(i) - at(i - 1) - 3 * at(i + 1) + at(i + 2)) * u3);
}

Sleeve sleeve_of(const FasciaPlan& plan) {
  std::vector<std::vector<Vec3>> rings(std::size_t(plan.rows));
  for (std::size_t i = 0; i < plan.points.size(); ++i)
    rings[i / std::size_t(plan.columns)].push_back(plan.points[i].rest);
  double around = 0, along = 0;
  for (int c = 0; c < plan.columns; ++c) {
    around += (rings[0][std::size_t(c)] - rings[0][std::size_t((c + 1) % plan.columns)]).norm();
    for (int r = 0; r + 1 < plan.rows; ++r)
      along += (rings[std::size_t(r)][std::size_t(c)] - rings[std::size_t(r + 1)][std::size_t(c)])
                   .norm() /
               plan.columns;
  }
  Sleeve out;
  out.columns = std::clamp(int(around / kSleeveCell), kFewestAround, kMostAround);
  out.rows = std::clamp(int(along / kSleeveCell) + 1, kFewestAlong, kMostAlong);
  for (int r = 0; r < out.rows; ++r) {
    const double t = double(r) * (plan.rows - 1) / (out.rows - 1);
    const int below = std::min(int(t), plan.rows - 2);
    const std::size_t begin = out.toward.size();
    Vec3 middle = Vec3::Zero();
    for (int c = 0; c < out.columns; ++c) {
      const double place = double(c) * plan.columns / out.columns;
      const Vec3 a = on_ring(rings[std::size_t(below)], place),
                 b = on_ring(rings[std::size_t(below) + 1], place);
      out.toward.push_back(a + (t - below) * (b - a));
      middle += out.toward.back() / out.columns;
    }
    out.middle.push_back(middle);
    for (std::size_t i = begin; i < out.toward.size(); ++i) {
      out.toward[i] -= middle;
      out.reach.push_back(out.toward[i].norm());
      out.toward[i] /= std::max(out.reach.back(), 1e-9);
    }
  }
  const std::size_t points = out.toward.size();
  out.radius.assign(points, 0);
  out.low.assign(points, 0);
  out.high.assign(points, 0);
  out.free.assign(points, 0);
  return out;
}

SkinRays rays_of(const Anatomy& anatomy, std::span<const std::string> names) {
  std::vector<const TriMesh*> meshes;
  for (const std::string& name : names)
    meshes.push_back(&anatomy.bones[std::size_t(find_bone(anatomy, name))].mesh);
  return SkinRays(join_meshes(meshes), RayBuild::quick);
}

// How far out the outermost bone is within a row's reach; negative: none.
double outermost(const SkinRays& bones, const Vec3& middle, const Vec3& toward, double reach) {
  const RayHit hit = bones.first_hit(middle + reach * toward, -toward, reach);
  return hit.triangle < 0 ? -1 : reach - hit.distance;
}

// Where a ray from the inside of a bone first leaves it; negative: nowhere.
double way_out(const SkinRays& bones, const Vec3& middle, const Vec3& toward, double reach) {
  double from = 0;
  for (int tries = 0; tries < 4; ++tries) {
    const RayHit hit = bones.first_hit(middle, toward, reach, from);
    if (hit.triangle < 0) return -1;
    if (hit.facing > 0) return hit.distance;
    from = hit.distance + kClear;
  }
  return -1;
}

// As far as muscle and other bone leave room above a radius.
double room(const SkinRays& tissue, const Vec3& middle, const Vec3& toward, double from,
            double reach) {
  const RayHit over = tissue.first_hit(middle, toward, reach, from + kClear);
  if (over.triangle < 0) return reach;
  // leaving something at first: a muscle that reaches into the bone
  return over.facing < 0 ? over.distance - kUnderMuscle : from;
}

double under_skin(const SkinRays& skin, const Vec3& middle, const Vec3& toward, double reach) {
  const RayHit out = skin.first_hit(middle, toward, 2 * reach);
  return out.triangle >= 0 && out.facing > 0 ? out.distance - kSleeveUnderSkin : reach;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto half = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

// Where no ray has met a bone the ends of a sleeve take the mean of what is beside it.
void fill_ring(Sleeve& sleeve, int row) {
  std::vector<double> met;
  for (int c = 0; c < sleeve.columns; ++c)
    if (!sleeve.free[sleeve.at(row, c)]) met.push_back(sleeve.radius[sleeve.at(row, c)]);
  const double usual = met.empty() ? 0.5 * sleeve.reach[sleeve.at(row, 0)] : median(met);
  for (int c = 0; c < sleeve.columns; ++c) {
    const std::size_t i = sleeve.at(row, c);
    if (!sleeve.free[i]) continue;
    int before = c, after = c;
    while (before > c - sleeve.columns && sleeve.free[sleeve.at(row, before + sleeve.columns)])
      --before;
    while (after < c + sleeve.columns && sleeve.free[sleeve.at(row, after)]) ++after;
    if (met.empty()) {
      sleeve.radius[i] = usual;
      continue;
    }
    const double t = double(c - before) / (after - before);
    sleeve.radius[i] = (1 - t) * sleeve.radius[sleeve.at(row, before + sleeve.columns)] +
                       t * sleeve.radius[sleeve.at(row, after)];
  }
}

void stretch_capsule(const FasciaPlan& plan, const Anatomy& anatomy, const SkinRays& tissue,
                     const SkinRays& skin, Sleeve& sleeve) {
  const std::span<const std::string> names = plan.bones;
  const SkinRays all = rays_of(anatomy, names),
                 near = rays_of(anatomy, names.first(std::size_t(plan.near))),
                 far = rays_of(anatomy, names.subspan(std::size_t(plan.near)));
  std::vector<double> met;
  const int last = sleeve.rows - 1;
  for (std::size_t i = 0; i < sleeve.toward.size(); ++i) {
    const int row = int(i) / sleeve.columns;
    const SkinRays& bones = row == 0 ? near : row == last ? far : all;
    sleeve.low[i] = outermost(bones, sleeve.middle[row], sleeve.toward[i], sleeve.reach[i]);
    sleeve.free[i] = sleeve.low[i] < 0;
    if (!sleeve.free[i]) met.push_back(sleeve.low[i]);
  }
  const double usual = median(met);
  for (std::size_t i = 0; i < sleeve.toward.size(); ++i) {
    const int row = int(i) / sleeve.columns;
    const double bone = sleeve.free[i] ? 0.5 * usual : sleeve.low[i];
    const Vec3 &middle = sleeve.middle[row], &toward = sleeve.toward[i];
    const double under = under_skin(skin, middle, toward, sleeve.reach[i]),
                 over = room(tissue, middle, toward, bone, sleeve.reach[i]);
    const bool end = row == 0 || row == last;
    const double share = std::min(1.0, std::min(row, last - row) / 2.0);
    const double raised = std::max(bone + kLeast, std::min(bone + share * plan.thickness, over));
    sleeve.low[i] = sleeve.free[i] ? 0 : std::min(end ? bone - kSleeveTuck : raised, under);
    sleeve.high[i] = std::max(std::min(over, under), sleeve.low[i]);
    sleeve.radius[i] = sleeve.free[i] ? std::min(usual, sleeve.high[i]) : sleeve.low[i];
  }
  for (const int row : {0, last}) fill_ring(sleeve, row);
  for (int sweep = 0; sweep < kSleeveSweeps; ++sweep)
    for (int r = 1; r < last; ++r)
      for (int c = 0; c < sleeve.columns; ++c) {
        const std::size_t i = sleeve.at(r, c);
        const Vec3 mean = (sleeve.point(sleeve.at(r - 1, c)) + sleeve.point(sleeve.at(r + 1, c)) +
                           sleeve.point(sleeve.at(r, c - 1)) + sleeve.point(sleeve.at(r, c + 1))) /
                          4;
        const double wanted = sleeve.toward[i].dot(mean - sleeve.middle[std::size_t(r)]);
        sleeve.radius[i] =
            std::clamp(sleeve.radius[i] + kSleeveRelaxation * (wanted - sleeve.radius[i]),
                       sleeve.low[i], sleeve.high[i]);
      }
}

void smooth_ring(Sleeve& sleeve, int row) {
  std::vector<double> before(std::size_t(sleeve.columns));
  for (int round = 0; round < kSmoothRounds; ++round) {
    for (int c = 0; c < sleeve.columns; ++c)
      before[std::size_t(c)] = sleeve.radius[sleeve.at(row, c)];
    const auto old = [&](int c) {
      return before[std::size_t((c + sleeve.columns) % sleeve.columns)];
    };
    for (int c = 0; c < sleeve.columns; ++c)
      sleeve.radius[sleeve.at(row, c)] = (old(c - 1) + 2 * old(c) + old(c + 1)) / 4;
  }
}

void stretch_disc(const FasciaPlan& plan, const Anatomy& anatomy, Sleeve& sleeve) {
  const std::span<const std::string> names = plan.bones;
  const int last = sleeve.rows - 1;
  for (const int row : {0, last}) {
    const SkinRays bones = rays_of(anatomy, row == 0 ? names.first(std::size_t(plan.near))
                                                     : names.subspan(std::size_t(plan.near)));
    std::vector<double> met;
    for (int c = 0; c < sleeve.columns; ++c) {
      const std::size_t i = sleeve.at(row, c);
      const double out = way_out(bones, sleeve.middle[row], sleeve.toward[i], sleeve.reach[i]);
      sleeve.free[i] = out < 0;
      sleeve.radius[i] = out - kSleeveTuck;
      if (out > 0) met.push_back(out);
    }
    const double most = kRim * median(met);
    for (int c = 0; c < sleeve.columns; ++c) {
      double& radius = sleeve.radius[sleeve.at(row, c)];
      radius = std::min(radius, most);
    }
    fill_ring(sleeve, row);
    smooth_ring(sleeve, row);
  }
  for (int r = 1; r < last; ++r) {
    const double t = double(r) / last;
    for (int c = 0; c < sleeve.columns; ++c)
      sleeve.radius[sleeve.at(r, c)] =
          (1 - t) * sleeve.radius[sleeve.at(0, c)] + t * sleeve.radius[sleeve.at(last, c)] +
          (plan.thickness + kSleeveTuck) * std::sqrt(std::sin(std::numbers::pi * t));
  }
}

}  // namespace

FasciaSheet lay_sleeve(const FasciaPlan& plan, const Anatomy& anatomy, const SkinRays& tissue,
                       const SkinRays& skin) {
  Sleeve sleeve = sleeve_of(plan);
  if (plan.form == FasciaPlan::Form::disc)
    stretch_disc(plan, anatomy, sleeve);
  else
    stretch_capsule(plan, anatomy, tissue, skin, sleeve);
  FasciaSheet out = empty_sheet(plan);
  out.rows = sleeve.rows;
  out.columns = sleeve.columns + 1;  // the last lies on the first
  out.V.resize(Eigen::Index(out.rows) * out.columns, 3);
  for (int r = 0; r < out.rows; ++r)
    for (int c = 0; c < out.columns; ++c)
      out.V.row(Eigen::Index(r) * out.columns + c) = sleeve.point(sleeve.at(r, c));
  out.belly.assign(std::size_t(out.V.rows()), 0);
  return out;
}

}  // namespace ecorche::inline v1
