#include "anatomy/muscles/fascia_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kWidth = 8e-3;     // m, of the weights about what is nearest
constexpr double kRounding = 1e-9;  // m
constexpr double kTouch = 1e-3;     // m, added to distances from bones that carry alone
constexpr int kMostTerms = 8;
constexpr int kSmoothRounds = 6;
constexpr double kBeyond = 1.15;          // of a sleeve's radius: bones farther out push nothing
constexpr float kClear = 1.5e-3f;         // m, the most that a point keeps over a bone
constexpr std::size_t kMostReaches = 16;  // that push one sheet
constexpr int kPushRounds = 2;            // out of one bone may be into the other

// Of carriers, which rise.
using Weights = std::vector<std::pair<int, double>>;

// Of each carrier once: what `join` makes of its values, in their order.
template <class Join>
void sort_and_join(Weights& weights, const Join& join) {
  std::ranges::stable_sort(weights, {}, &Weights::value_type::first);
  std::size_t kept = 0;
  for (const auto& [carrier, value] : weights) {
    if (kept > 0 && weights[kept - 1].first == carrier)
      weights[kept - 1].second = join(weights[kept - 1].second, value);
    else
      weights[kept++] = {carrier, value};
  }
  weights.resize(kept);
}

// The outline of a section in the direction of a point of its plane.
struct OutlinePlace {
  double place = 0;
  Vec2 toward = Vec2::UnitX(), point = Vec2::Zero();  // the latter in the section's plane, m
};
OutlinePlace outline_toward(const Ellipse& section, const Vec2& at) {
  OutlinePlace out;
  const Vec2 radii = section.radii.cwiseMax(1e-6), scaled = at.cwiseQuotient(radii);
  if (scaled.norm() > 1e-12) out.toward = scaled.normalized();
  double turn = std::atan2(out.toward.y(), out.toward.x()) / (2 * std::numbers::pi);
  turn -= std::floor(turn);
  out.place = std::min(turn * kOutlinePoints, kOutlinePoints - 1e-6);
  out.point = outline_factor(section.outline, out.place) * out.toward.cwiseProduct(section.radii);
  return out;
}

// m; kFasciaReach or more where that is plain without its outline in the point's direction.
// `widest`: as far as that goes anywhere.
double distance_to(const Ellipse& section, double widest, const Vec3& p) {
  const Vec3 local = section.axes.transpose() * (p - section.center);
  const Vec2 flat = local.head<2>();
  const double least = std::max(std::abs(local.z()), flat.norm() - widest);
  if (least >= kFasciaReach) return least;
  const double outside = std::max(0.0, flat.norm() - outline_toward(section, flat).point.norm());
  return std::hypot(outside, local.z());
}

// Sections and bones near a sheet.
struct Nearby {
  std::vector<int> slices, bones;
  std::vector<double> widest;  // #slices, m, from their centres
};
Nearby nearby(const Anatomy& anatomy, std::span<const Ellipse> slices, const FasciaSheet& sheet) {
  Nearby out;
  const Eigen::RowVector3d low = sheet.V.colwise().minCoeff().array() - kFasciaReach,
                           high = sheet.V.colwise().maxCoeff().array() + kFasciaReach;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const double reach = slices[k].radii.maxCoeff();
    const Eigen::RowVector3d c = slices[k].center.transpose();
    if ((c.array() + reach >= low.array()).all() && (c.array() - reach <= high.array()).all()) {
      out.slices.push_back(int(k));
      out.widest.push_back(reach * double(*std::ranges::max_element(slices[k].outline)) +
                           kRounding);
    }
  }
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    const Points& V = anatomy.bones[b].mesh.V;
    if (V.rows() > 0 && (V.colwise().maxCoeff().array() >= low.array()).all() &&
        (V.colwise().minCoeff().array() <= high.array()).all())
      out.bones.push_back(int(b));
  }
  return out;
}

double distance_to(const Bone& bone, const Vec3& p) {
  return std::sqrt((bone.mesh.V.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff());
}

Weights by_nearness(const Anatomy& anatomy, std::span<const Ellipse> slices, const Nearby& near,
                    const Vec3& p) {
  Weights out;
  for (std::size_t i = 0; i < near.slices.size(); ++i) {
    const int k = near.slices[i];
    if ((slices[k].center - p).norm() > slices[k].radii.maxCoeff() * 2 + kFasciaReach) continue;
    const double d = distance_to(slices[k], near.widest[i], p);
    if (d < kFasciaReach) out.emplace_back(k, d);
  }
  for (const int b : near.bones) {
    const double d = distance_to(anatomy.bones[b], p);
    if (d <= kFasciaReach) out.emplace_back(int(slices.size()) + anatomy.bones[b].joint, d);
  }
  sort_and_join(out, [](double a, double b) { return std::min(a, b); });
  double least = kFasciaReach;
  for (const auto& [carrier, d] : out) least = std::min(least, d);
  for (auto& [carrier, w] : out) {
    const double beyond = (w - least) / kWidth;
    w = std::exp(-0.5 * beyond * beyond);
  }
  return out;
}

// In inverse proportion to the distance: between two bones a straight line stays one. Of more, the
// nearest carries nearly all: the farther ones of a finger turn away from it.
Weights by_bones(const Anatomy& anatomy, std::span<const Ellipse> slices, const FasciaSheet& sheet,
                 const Vec3& p) {
  Weights out;
  for (const std::string& name : sheet.bones) {
    const Bone& bone = anatomy.bones[find_bone(anatomy, name)];
    const double near = 1 / (distance_to(bone, p) + kTouch);
    out.emplace_back(int(slices.size()) + bone.joint,
                     sheet.bones.size() > 2 ? near * near * near : near);
  }
  sort_and_join(out, std::plus<>());
  return out;
}

// Of a sleeve: rows in proportion, the outermost by one bone alone.
Weights by_row(const Anatomy& anatomy, std::span<const Ellipse> slices, const FasciaSheet& sheet,
               int row) {
  const double share =
      sheet.rows > 2 ? std::clamp((row - 0.5) / (sheet.rows - 2), 0.0, 1.0) : double(row);
  const auto joint = [&](const std::string& name) {
    return int(slices.size()) + anatomy.bones[std::size_t(find_bone(anatomy, name))].joint;
  };
  Weights out;
  if (share < 1) out.emplace_back(joint(sheet.bones.front()), 1 - share);
  if (share > 0) out.emplace_back(joint(sheet.bones.back()), share);
  sort_and_join(out, std::plus<>());
  return out;
}

void normalize(Weights& weights) {
  double sum = 0;
  for (const auto& [carrier, w] : weights) sum += w;
  for (auto& [carrier, w] : weights) w /= sum;
}

// Evens weights along a sheet: of all its carriers at every point, since most get to most of it.
void smooth(const FasciaSheet& sheet, std::vector<Weights>& weights) {
  std::vector<int> carriers;
  for (const Weights& own : weights)
    for (const auto& [carrier, w] : own) carriers.push_back(carrier);
  std::ranges::sort(carriers);
  carriers.erase(std::unique(carriers.begin(), carriers.end()), carriers.end());
  Eigen::MatrixXd now =
      Eigen::MatrixXd::Zero(Eigen::Index(carriers.size()), Eigen::Index(weights.size()));
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (const auto& [carrier, w] : weights[i])
      now(std::ranges::lower_bound(carriers, carrier) - carriers.begin(), Eigen::Index(i)) = w;
  for (int round = 0; round < kSmoothRounds; ++round) {
    const Eigen::MatrixXd before = now;
    for (int r = 0; r < sheet.rows; ++r)
      for (int c = 0; c < sheet.columns; ++c) {
        auto own = now.col(Eigen::Index(r) * sheet.columns + c);
        const auto add = [&](int row, int column) {
          if (row < 0 || column < 0 || row >= sheet.rows || column >= sheet.columns) return;
          own += 0.5 * before.col(Eigen::Index(row) * sheet.columns + column);
        };
        add(r - 1, c), add(r + 1, c), add(r, c - 1), add(r, c + 1);
        own /= std::accumulate(own.begin(), own.end(), 0.0);
      }
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i].clear();
    for (std::size_t k = 0; k < carriers.size(); ++k)
      if (const double w = now(Eigen::Index(k), Eigen::Index(i)); w > 0)
        weights[i].emplace_back(carriers[k], w);
  }
}

// The largest, which sum to 1.
Weights largest(Weights out) {
  std::ranges::stable_sort(out, [](const auto& l, const auto& r) { return l.second > r.second; });
  if (out.size() > kMostTerms) out.resize(kMostTerms);
  double sum = 0;
  for (const auto& [carrier, w] : out) sum += w;
  for (auto& [carrier, w] : out) w /= sum;
  return out;
}

FasciaSurface::Term term_of(std::span<const Ellipse> slices, std::span<const Vec3> joints,
                            int carrier, double weight, const Vec3& p) {
  FasciaSurface::Term term;
  term.carrier = carrier;
  term.weight = float(weight);
  if (carrier >= int(slices.size())) {
    term.at = (p - joints[std::size_t(carrier) - slices.size()]).cast<float>();
    return term;
  }
  const Ellipse& section = slices[carrier];
  const Vec3 local = section.axes.transpose() * (p - section.center);
  const OutlinePlace outline = outline_toward(section, local.head<2>());
  term.at = local.cast<float>();
  term.place = float(outline.place);
  term.toward = outline.toward.cast<float>();
  term.outline = outline.point.cast<float>();
  const double reach = outline.point.norm();
  term.share = reach > 1e-9 ? float(std::min(1.0, local.head<2>().norm() / reach)) : 0;
  return term;
}

std::vector<Weights> weights_of(const Anatomy& anatomy, std::span<const Ellipse> slices,
                                const FasciaSheet& sheet) {
  std::vector<Weights> out(std::size_t(sheet.V.rows()));
  const Nearby near = nearby(anatomy, slices, sheet);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 p = sheet.V.row(Eigen::Index(i));
    out[i] = is_sleeve(sheet)      ? by_row(anatomy, slices, sheet, int(i) / sheet.columns)
             : sheet.bones.empty() ? by_nearness(anatomy, slices, near, p)
                                   : by_bones(anatomy, slices, sheet, p);
    if (out[i].empty())
      // the root, until neighbours give theirs
      out[i].emplace_back(int(slices.size()), 1e-9);
    normalize(out[i]);
  }
  if (sheet.bones.empty()) smooth(sheet, out);
  return out;
}

void add_places(const FasciaSheet& sheet, FasciaSurface& out) {
  const auto at = [&](int r, int c) { return sheet.V.row(Eigen::Index(r) * sheet.columns + c); };
  double across = 0, along = 0;
  for (int r = 0; r < sheet.rows; ++r)
    for (int c = 0; c < sheet.columns; ++c) {
      if (c + 1 < sheet.columns) across += (at(r, c + 1) - at(r, c)).norm() / sheet.rows;
      if (r + 1 < sheet.rows) along += (at(r + 1, c) - at(r, c)).norm() / sheet.columns;
    }
  for (int r = 0; r < sheet.rows; ++r)
    for (int c = 0; c < sheet.columns; ++c) {
      out.across.push_back(float(across * c / (sheet.columns - 1)));
      out.along.push_back(float(along * r / (sheet.rows - 1)));
    }
}

// Of the ends of bones in a capsule, from its middle.
std::vector<BoneReach> reaches_in(const Anatomy& anatomy, std::span<const Vec3> joints,
                                  const FasciaSheet& sheet) {
  const Vec3 middle = sheet.V.colwise().mean(),
             first = sheet.V.topRows(sheet.columns).colwise().mean(),
             last = sheet.V.bottomRows(sheet.columns).colwise().mean();
  const double radius = (sheet.V.rowwise() - middle.transpose()).rowwise().norm().maxCoeff();
  std::vector<BoneReach> out;
  if (radius < 1e-4 || (last - first).norm() < 1e-6) return out;
  std::set<int> carriers;
  for (const std::string& name : sheet.bones)
    carriers.insert(anatomy.bones[std::size_t(find_bone(anatomy, name))].joint);
  if (carriers.size() < 2) return out;  // nothing moves in it
  for (const std::string& name : sheet.bones) {
    if (out.size() == kMostReaches) break;
    const Bone& bone = anatomy.bones[std::size_t(find_bone(anatomy, name))];
    out.push_back(bone_reach(bone.mesh, bone.joint, joints[std::size_t(bone.joint)], middle,
                             (last - first).normalized(), kBeyond * radius));
  }
  return out;
}

// A band along more than two bones passes over a joint where it names both that the capsule ends
// on.
bool passes_over(const FasciaSheet& band, const FasciaSheet& capsule) {
  const auto has = [&](const std::string& bone) {
    return std::ranges::find(band.bones, bone) != band.bones.end();
  };
  return !is_sleeve(band) && band.bones.size() > 2 && is_sleeve(capsule) &&
         has(capsule.bones.front()) && has(capsule.bones.back());
}

// From the middle of the joint that a bone's reach is seen from, at rest.
Eigen::Vector3f from_middle(const BoneReach& reach, std::span<const Vec3> joints, const Vec3& p) {
  return (p - joints[std::size_t(reach.joint)]).cast<float>() - reach.centre;
}

void add_reaches(const Anatomy& anatomy, std::span<const Vec3> joints, FasciaSurface& out) {
  std::vector<std::vector<BoneReach>> found(out.parts.size());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t n) {
    const FasciaSheet& sheet = anatomy.fascia[n];
    if (is_sleeve(sheet)) found[n] = reaches_in(anatomy, joints, sheet);
  });
  for (std::size_t n = 0; n < found.size(); ++n)
    for (BoneReach& reach : found[n]) {
      out.parts[n].reaches.push_back(int(out.reaches.size()));
      out.reaches.push_back(std::move(reach));
    }
  for (FasciaSurface::Part& part : out.parts)
    for (const FasciaSurface::Part& capsule : out.parts)
      if (passes_over(anatomy.fascia[part.sheet], anatomy.fascia[capsule.sheet]))
        for (const int reach : capsule.reaches)
          if (part.reaches.size() < kMostReaches) part.reaches.push_back(reach);
  for (FasciaSurface::Part& part : out.parts) {
    part.push_begin = int(out.clearances.size());
    const FasciaSheet& sheet = anatomy.fascia[part.sheet];
    for (int i = 0; i < part.vertex_end - part.vertex_begin; ++i)
      for (const int k : part.reaches) {
        const bool edge = cells_from_edge(sheet.rows, sheet.columns, i, is_sleeve(sheet)) == 0;
        const Eigen::Vector3f at = from_middle(out.reaches[k], joints, sheet.V.row(i));
        const float over = at.norm() - reach_toward(out.reaches[k], at);
        out.clearances.push_back(edge ? -1 : std::min(kClear, over));
      }
  }
}

// Bands along more than two bones, as over knuckles, are pushed out of these instead.
bool rises_over_muscles(const FasciaSheet& sheet) {
  return !is_sleeve(sheet) && sheet.bones.size() <= 2;
}

// Directions of the terms' points outwards, and what may come over them.
void add_lift(const Anatomy& anatomy, std::span<const Ellipse> slices, FasciaSurface& out) {
  PointsF at(out.vertices(), 3), normals;
  for (const FasciaSurface::Part& part : out.parts)
    at.middleRows(part.vertex_begin, part.vertex_end - part.vertex_begin) =
        anatomy.fascia[std::size_t(part.sheet)].V.cast<float>();
  find_normals(out.F, at, normals);
  for (int i = 0; i < out.vertices(); ++i)
    for (int t = out.term_begin[i]; t < out.term_begin[i + 1]; ++t) {
      FasciaSurface::Term& term = out.terms[t];
      const Eigen::Vector3f outwards = normals.row(i);
      term.out =
          term.carrier < out.slices
              ? Eigen::Vector3f(slices[term.carrier].axes.transpose().cast<float>() * outwards)
              : outwards;
    }
  const std::vector<SliceRange> strips = slice_ranges(anatomy);
  for (const FasciaSurface::Part& part : out.parts)
    add_covers(strips, slices, at, normals, part.vertex_begin, part.vertex_end, part.rises,
               out.lift);
}

}  // namespace

bool is_sleeve(const FasciaSheet& sheet) {
  if (sheet.bones.size() < 2 || sheet.columns < 4) return false;
  for (int r = 0; r < sheet.rows; ++r) {
    const Eigen::Index first = Eigen::Index(r) * sheet.columns;
    if (sheet.V.row(first) != sheet.V.row(first + sheet.columns - 1)) return false;
  }
  return true;
}

int cells_from_edge(int rows, int columns, int point, bool sleeve) {
  const int row = point / columns, column = point % columns,
            from_ends = std::min(row, rows - 1 - row);
  return sleeve ? from_ends : std::min(from_ends, std::min(column, columns - 1 - column));
}

void append_point(const FasciaSurface& from, int point, FasciaSurface& to) {
  const std::size_t i = std::size_t(point);
  to.terms.insert(to.terms.end(), from.terms.begin() + from.term_begin[i],
                  from.terms.begin() + from.term_begin[i + 1]);
  to.term_begin.push_back(int(to.terms.size()));
  to.belly.push_back(from.belly[i]);
  to.across.push_back(from.across[i]);
  to.along.push_back(from.along[i]);
  to.lift.covers.insert(to.lift.covers.end(), from.lift.covers.begin() + from.lift.begin[i],
                        from.lift.covers.begin() + from.lift.begin[i + 1]);
  to.lift.begin.push_back(int(to.lift.covers.size()));
}

void triangulate(FasciaSurface& surface) {
  std::vector<Triangles> faces;
  int count = 0;
  for (FasciaSurface::Part& part : surface.parts) {
    faces.push_back(grid_triangles(part.rows, part.columns).array() + part.vertex_begin);
    part.face_begin = count;
    part.face_end = count += int(faces.back().rows());
  }
  surface.F.resize(count, 3);
  for (std::size_t n = 0; n < faces.size(); ++n)
    surface.F.middleRows(surface.parts[n].face_begin, faces[n].rows()) = faces[n];
}

FasciaSurface make_fascia_surface(const Anatomy& anatomy) {
  FasciaSurface out;
  const std::vector<Ellipse> slices = rest_slices(anatomy);
  const std::vector<Vec3> joints = rest_positions(anatomy.skeleton);
  out.slices = int(slices.size());
  std::vector<std::vector<Weights>> weights(anatomy.fascia.size());
  tbb::parallel_for(std::size_t{0}, weights.size(), [&](std::size_t n) {
    weights[n] = weights_of(anatomy, slices, anatomy.fascia[n]);
  });
  out.term_begin.push_back(0);
  for (std::size_t n = 0; n < weights.size(); ++n) {
    const FasciaSheet& sheet = anatomy.fascia[n];
    const int begin = out.vertices();
    for (std::size_t i = 0; i < weights[n].size(); ++i) {
      for (const auto& [carrier, weight] : largest(weights[n][i]))
        out.terms.push_back(term_of(slices, joints, carrier, weight, sheet.V.row(Eigen::Index(i))));
      out.term_begin.push_back(int(out.terms.size()));
    }
    out.belly.insert(out.belly.end(), sheet.belly.begin(), sheet.belly.end());
    add_places(sheet, out);
    out.parts.push_back({.sheet = int(n),
                         .vertex_begin = begin,
                         .vertex_end = out.vertices(),
                         .rows = sheet.rows,
                         .columns = sheet.columns,
                         .sleeve = is_sleeve(sheet),
                         .rises = rises_over_muscles(sheet)});
  }
  triangulate(out);
  add_reaches(anatomy, joints, out);
  add_lift(anatomy, slices, out);
  return out;
}

namespace {

// Where the sections and joints that carry a point bring it.
Eigen::Vector3f carried(const FasciaSurface& surface, const PosedAnatomy& posed, int i) {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
  for (int t = surface.term_begin[i]; t < surface.term_begin[i + 1]; ++t) {
    const FasciaSurface::Term& term = surface.terms[t];
    if (term.carrier >= surface.slices) {
      const Transform& joint = posed.X_WJ[std::size_t(term.carrier - surface.slices)];
      p += term.weight * (joint * term.at.cast<double>()).cast<float>();
      continue;
    }
    const Ellipse& section = posed.slices[term.carrier];
    const float factor = float(outline_factor(section.outline, term.place));
    const Eigen::Vector2f moved =
        factor * term.toward.cwiseProduct(section.radii.cast<float>()) - term.outline;
    Eigen::Vector3f local = term.at;
    local.head<2>() += term.share * moved;
    p += term.weight * (section.center.cast<float>() + section.axes.cast<float>() * local);
  }
  return p;
}

// Outwards at a point, as the sections and joints turn it.
Vec3 outwards(const FasciaSurface& surface, const PosedAnatomy& posed, int i) {
  Vec3 out = Vec3::Zero();
  for (int t = surface.term_begin[i]; t < surface.term_begin[i + 1]; ++t) {
    const FasciaSurface::Term& term = surface.terms[t];
    const Vec3 own = double(term.weight) * term.out.cast<double>();
    if (term.carrier < surface.slices)
      out += posed.slices[term.carrier].axes * own;
    else
      out += posed.X_WJ[std::size_t(term.carrier - surface.slices)].linear() * own;
  }
  return out.stableNormalized();
}

// A sheet over the muscles that have come out through it.
void lift_sheet(const FasciaSurface& surface, const PosedAnatomy& posed,
                const FasciaSurface::Part& part, PointsF& positions) {
  const std::size_t count = std::size_t(part.vertex_end - part.vertex_begin);
  std::vector<Vec3> out(count);
  std::vector<float> heights(count), wanted(count);
  for (std::size_t k = 0; k < count; ++k) {
    const int i = part.vertex_begin + int(k);
    out[k] = outwards(surface, posed, i);
    heights[k] =
        wanted_lift(surface.lift, posed, i, positions.row(i).transpose().cast<double>(), out[k]);
  }
  if (std::ranges::all_of(heights, [](float height) { return height <= 0; })) return;
  spread_lift(part.rows, part.columns, heights, wanted);
  for (std::size_t k = 0; k < count; ++k)
    positions.row(part.vertex_begin + int(k)) += heights[k] * out[k].cast<float>().transpose();
}

// Where the bones that push a sheet are in a pose.
struct PosedReach {
  Eigen::Vector3f middle;
  Eigen::Matrix3f to_rest;  // directions
};
using PosedReaches = std::array<PosedReach, kMostReaches>;
void pose_reaches(const FasciaSurface& surface, const PosedAnatomy& posed,
                  const FasciaSurface::Part& part, PosedReaches& out) {
  for (std::size_t k = 0; k < part.reaches.size(); ++k) {
    const BoneReach& reach = surface.reaches[part.reaches[k]];
    const Transform& X_WJ = posed.X_WJ[std::size_t(reach.joint)];
    out[k].middle = (X_WJ * reach.centre.cast<double>()).cast<float>();
    out[k].to_rest = X_WJ.linear().cast<float>().transpose();
  }
}

// Away from the middle of the joint, as far as the bone reaches in that direction.
void push_out(const FasciaSurface& surface, const PosedReaches& reaches,
              const FasciaSurface::Part& part, int i, Eigen::Vector3f& p) {
  const std::size_t count = part.reaches.size();
  const float* clearance =
      &surface
           .clearances[std::size_t(part.push_begin) + std::size_t(i - part.vertex_begin) * count];
  bool pushed = true;
  for (int round = 0; round < kPushRounds && pushed; ++round) {
    pushed = false;
    for (std::size_t k = 0; k < count; ++k) {
      if (clearance[k] < 0) continue;
      const BoneReach& reach = surface.reaches[part.reaches[k]];
      const Eigen::Vector3f offset = p - reaches[k].middle;
      const float length = offset.norm();
      if (length > reach.most + kClear || length < 1e-6f) continue;
      const float wanted = reach_toward(reach, reaches[k].to_rest * offset) + clearance[k];
      if (length >= wanted) continue;
      p = reaches[k].middle + wanted / length * offset;
      pushed = true;
    }
  }
}

// Of a sleeve over a joint that moves: about the middle of the joint, turned as far between its two
// ends as a row's share says, so that what is stretched over a bent joint spreads evenly over it.
Eigen::Vector3f carried_about(const FasciaSurface& surface, const PosedAnatomy& posed,
                              const FasciaSurface::Part& part, const PosedReaches& reaches, int i) {
  const BoneReach& first = surface.reaches[part.reaches.front()];
  const auto to_world = [](const PosedReach& reach) {
    return Eigen::Quaternionf(Eigen::Matrix3f(reach.to_rest.transpose()));
  };
  const int begin = surface.term_begin[i];
  if (surface.term_begin[i + 1] - begin != 2) return carried(surface, posed, i);
  const FasciaSurface::Term* own = &surface.terms[begin];
  if (own->carrier != surface.slices + first.joint) ++own;
  const float share = 1 - own->weight;
  const PosedReach &from = reaches[0], &to = reaches[part.reaches.size() - 1];
  const Eigen::Quaternionf turn = to_world(from).slerp(share, to_world(to));
  return (1 - share) * from.middle + share * to.middle + turn * (own->at - first.centre);
}

}  // namespace

void update_fascia_surface(const FasciaSurface& surface, const PosedAnatomy& posed,
                           PointsF& positions, PointsF* normals) {
  positions.resize(surface.vertices(), 3);
  tbb::parallel_for(std::size_t{0}, surface.parts.size(), [&](std::size_t n) {
    const FasciaSurface::Part& part = surface.parts[n];
    PosedReaches reaches;
    pose_reaches(surface, posed, part, reaches);
    for (int i = part.vertex_begin; i < part.vertex_end; ++i) {
      Eigen::Vector3f p = part.sleeve && !part.reaches.empty()
                              ? carried_about(surface, posed, part, reaches, i)
                              : carried(surface, posed, i);
      if (!part.reaches.empty()) push_out(surface, reaches, part, i, p);
      positions.row(i) = p;
    }
    if (part.rises) lift_sheet(surface, posed, part, positions);
  });
  if (!normals) return;
  find_normals(surface.F, positions, *normals);
  for (const FasciaSurface::Part& part : surface.parts) {
    if (!part.sleeve) continue;
    for (int i = part.vertex_begin; i < part.vertex_end; i += part.columns) {
      const int last = i + part.columns - 1;
      normals->row(i) = (normals->row(i) + normals->row(last)).normalized();
      normals->row(last) = normals->row(i);
    }
  }
}

}  // namespace ecorche::inline v1
