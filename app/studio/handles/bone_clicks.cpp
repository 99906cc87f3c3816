#include "app/studio/handles/bone_clicks.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <numbers>

#include "app/edit/document/edit_muscle.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

// Shares of a triangle's corners at a pixel; none outside of it.
std::optional<Vec3> shares_at(const Vec2f& at, const Vec2f& a, const Vec2f& b, const Vec2f& c) {
  Eigen::Matrix2f sides;
  sides << b - a, c - a;
  if (std::abs(sides.determinant()) < 1e-9f) return std::nullopt;
  const Vec2f uv = sides.inverse() * (at - a);
  if (uv.x() < 0 || uv.y() < 0 || uv.sum() > 1) return std::nullopt;
  return Vec3(1 - uv.sum(), uv.x(), uv.y());
}

// A triangle under the pixel, and where in it.
struct Hit {
  const Bone* bone = nullptr;
  Eigen::Index face = 0;
  Vec3 shares = Vec3::Zero();
  float depth = 0;
};

void find_hits(const Bone& bone, const Transform& moved, const ViewProjection& view,
               const Vec2f& pixel, std::optional<Hit>& nearest) {
  std::vector<std::optional<Vec2f>> at;
  std::vector<Vec3f> places;
  for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) {
    places.push_back((moved * Vec3(bone.mesh.V.row(v).transpose())).cast<float>());
    at.push_back(view.pixel(places.back()));
  }
  for (Eigen::Index f = 0; f < bone.mesh.F.rows(); ++f) {
    const auto corner = [&](int k) { return std::size_t(bone.mesh.F(f, k)); };
    if (!at[corner(0)] || !at[corner(1)] || !at[corner(2)]) continue;
    const auto shares = shares_at(pixel, *at[corner(0)], *at[corner(1)], *at[corner(2)]);
    if (!shares) continue;
    float depth = 0;
    for (int k = 0; k < 3; ++k) depth += float((*shares)[k]) * view.depth(places[corner(k)]);
    if (!nearest || depth < nearest->depth) nearest = Hit{&bone, f, *shares, depth};
  }
}

Vec3 place_in(const TriMesh& mesh, const Hit& hit) {
  Vec3 out = Vec3::Zero();
  for (int k = 0; k < 3; ++k) out += hit.shares[k] * mesh.V.row(mesh.F(hit.face, k)).transpose();
  return out;
}

std::string free_name(const Document& document) {
  for (int k = 1;; ++k) {
    std::string name = fmt::format("own_muscle_{}", k);
    if (find_entry(document, name) < 0) return name;
  }
}

}  // namespace

std::optional<BonePlace> bone_under(const Anatomy& shown, std::span<const Vec3> joint_rest,
                                    const PosedAnatomy& posed, const ViewProjection& view,
                                    const Vec2f& pixel, Workshop& workshop) {
  std::optional<Hit> nearest;
  for (const Bone& bone : shown.bones) {
    const std::size_t joint = std::size_t(bone.joint);
    find_hits(bone, posed.X_WJ[joint] * Eigen::Translation3d(-joint_rest[joint]), view, pixel,
              nearest);
  }
  if (!nearest) return std::nullopt;
  const Bone& bone = *nearest->bone;
  const std::optional<TriMesh> source = workshop.source_mesh(bone);
  if (!source) return std::nullopt;
  BonePlace out;
  out.side = bone.side;
  out.joint = bone.joint;
  out.rest = place_in(bone.mesh, *nearest);
  out.place = table_place(place_in(*source, *nearest), bone.side);
  const Vec3 mm = 1e3 * out.place;
  out.text =
      fmt::format("{}@{:.1f},{:.1f},{:.1f}", split_side(bone.name).first, mm.x(), mm.y(), mm.z());
  return out;
}

void paint(const BonePlace& place, BoneClick& click) {
  constexpr double kApart = 3e-3;  // m, between places of an area
  const bool near = std::ranges::any_of(click.painted, [&](const BonePlace& each) {
    return (each.place - place.place).norm() < kApart;
  });
  if (!near) click.painted.push_back(place);
}

std::string line_of_area(const BoneClick& click, const Document& document) {
  std::string places;
  for (const BonePlace& place : click.painted) places += (places.empty() ? "" : ";") + place.text;
  return fmt::format("paint_end {} end={} \"places={}\"", document.picked,
                     click.paints_origin ? "origin" : "insertion", places);
}

std::string line_of_click(const BoneClick& click, const BonePlace& place,
                          const Document& document) {
  if (click.what == BoneClick::For::point)
    return fmt::format("move_point {} strip={} point={} to={}", document.picked, click.strip,
                       click.point, place.text);
  const double length = (place.place - click.origin->place).norm();
  const double belly = 0.7 * length;  // as new_muscle has it
  const double thick = std::min(0.1 * length, 0.03);
  const double millilitres = std::max(1e6 * 0.25 * std::numbers::pi * thick * thick * belly, 0.1);
  return fmt::format("new_muscle {} from={} to={} volume={:.3g}ml", free_name(document),
                     click.origin->text, place.text, millilitres);
}

}  // namespace ecorche
