#include "anatomy/muscles/fascia_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <set>
#include <span>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kWidth = 8e-3;  // m, of the weights about what is nearest
constexpr double kReach = 0.03;  // m, what is farther carries nothing
constexpr double kTouch = 1e-3;  // m, added to distances from bones that carry alone
constexpr int kMostTerms = 8;
constexpr int kSmoothRounds = 6;
constexpr double kBeyond = 1.15;          // of a sleeve's radius: bones farther out push nothing
constexpr float kClear = 1.5e-3f;         // m, the most that a point keeps over a bone
constexpr std::size_t kMostReaches = 16;  // that push one sheet
constexpr int kPushRounds = 2;            // out of one bone may be into the other

using Weights = std::map<int, double>;  // of carriers

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

double distance_to(const Ellipse& section, const Vec3& p) {
  const Vec3 local = section.axes.transpose() * (p - section.center);
  const Vec2 flat = local.head<2>();
  const double outside = std::max(0.0, flat.norm() - outline_toward(section, flat).point.norm());
  return std::hypot(outside, local.z());
}

// Sections and bones near a sheet.
struct Nearby {
  std::vector<int> slices, bones;
};
Nearby nearby(const Anatomy& anatomy, std::span<const Ellipse> slices, const FasciaSheet& sheet) {
  Nearby out;
  const Eigen::RowVector3d low = sheet.V.colwise().minCoeff().array() - kReach,
                           high = sheet.V.colwise().maxCoeff().array() + kReach;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const double reach = slices[k].radii.maxCoeff();
    const Eigen::RowVector3d c = slices[k].center.transpose();
    if ((c.array() + reach >= low.array()).all() && (c.array() - reach <= high.array()).all())
      out.slices.push_back(int(k));
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
  std::map<int, double> distances;
  for (const int k : near.slices) {
    if ((slices[k].center - p).norm() > slices[k].radii.maxCoeff() * 2 + kReach) continue;
    const double d = distance_to(slices[k], p);
    if (d < kReach) distances.emplace(k, d);
  }
  for (const int b : near.bones) {
    const double d = distance_to(anatomy.bones[b], p);
    if (d > kReach) continue;
    const int carrier = int(slices.size()) + anatomy.bones[b].joint;
    const auto [at, is_new] = distances.emplace(carrier, d);
    if (!is_new) at->second = std::min(at->second, d);
  }
  double least = kReach;
  for (const auto& [carrier, d] : distances) least = std::min(least, d);
  Weights out;
  for (const auto& [carrier, d] : distances) {
    const double beyond = (d - least) / kWidth;
    out[carrier] = std::exp(-0.5 * beyond * beyond);
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
    out[int(slices.size()) + bone.joint] += sheet.bones.size() > 2 ? near * near * near : near;
  }
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
  if (share < 1) out[joint(sheet.bones.front())] += 1 - share;
  if (share > 0) out[joint(sheet.bones.back())] += share;
  return out;
}

void normalize(Weights& weights) {
  double sum = 0;
  for (const auto& [carrier, w] : weights) sum += w;
  for (auto& [carrier, w] : weights) w /= sum;
}

void smooth(const FasciaSheet& sheet, std::vector<Weights>& weights) {
  for (int round = 0; round < kSmoothRounds; ++round) {
    const std::vector<Weights> before = weights;
    for (int r = 0; r < sheet.rows; ++r)
      for (int c = 0; c < sheet.columns; ++c) {
        Weights& own = weights[std::size_t(r) * sheet.columns + c];
        const auto add = [&](int row, int column) {
          if (row < 0 || column < 0 || row >= sheet.rows || column >= sheet.columns) return;
          for (const auto& [carrier, w] : before[std::size_t(row) * sheet.columns + column])
            own[carrier] += 0.5 * w;
        };
        add(r - 1, c), add(r + 1, c), add(r, c - 1), add(r, c + 1);
        normalize(own);
      }
  }
}

// The largest, which sum to 1.
std::vector<std::pair<int, double>> largest(const Weights& weights) {
  std::vector<std::pair<int, double>> out(weights.begin(), weights.end());
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
      out[i][int(slices.size())] = 1e-9;  // the root, until neighbours give theirs
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
  std::vector<Triangles> faces;
  Eigen::Index face_count = 0;
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
    faces.push_back(grid_triangles(sheet.rows, sheet.columns).array() + begin);
    out.parts.push_back({int(n),
                         begin,
                         out.vertices(),
                         int(face_count),
                         int(face_count + faces.back().rows()),
                         sheet.rows,
                         sheet.columns,
                         is_sleeve(sheet),
                         rises_over_muscles(sheet),
                         {},
                         0});
    face_count += faces.back().rows();
  }
  out.F.resize(face_count, 3);
  for (std::size_t n = 0; n < faces.size(); ++n)
    out.F.middleRows(out.parts[n].face_begin, faces[n].rows()) = faces[n];
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
