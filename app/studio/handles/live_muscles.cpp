#include "app/studio/handles/live_muscles.h"

#include <algorithm>

#include "anatomy/muscles/action_line.h"
#include "app/edit/document/edited_skeleton.h"
#include "app/edit/refit.h"

namespace ecorche {
namespace {

constexpr Eigen::Index kSamples = 400;  // vertices of a bone that its map is fitted to

// The affine map between two lists of points that leaves least over; held near to a shift where the
// points do not span all directions.
Eigen::Affine3d best_map(const std::vector<std::pair<Vec3, Vec3>>& pairs) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  if (pairs.empty()) return out;
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  for (const auto& [from, to] : pairs) a += from, b += to;
  a /= double(pairs.size());
  b /= double(pairs.size());
  Mat3 across = Mat3::Zero(), within = Mat3::Zero();
  for (const auto& [from, to] : pairs) {
    across += (to - b) * (from - a).transpose();
    within += (from - a) * (from - a).transpose();
  }
  const Mat3 hold = (1e-4 * within.trace() + 1e-12) * Mat3::Identity();
  out.linear() = (across + hold) * (within + hold).inverse();
  out.translation() = b - out.linear() * a;
  return out;
}

// A slice of a strip at a parameter between its slices.
Slice slice_at(const Strip& strip, double s) {
  const auto after = std::ranges::lower_bound(strip.slices, s, {}, &Slice::s);
  if (after == strip.slices.begin()) return strip.slices.front();
  if (after == strip.slices.end()) return strip.slices.back();
  const Slice &a = *(after - 1), &b = *after;
  const double u = (s - a.s) / std::max(b.s - a.s, 1e-12);
  Slice out = a;
  out.s = s;
  out.roll = (1 - u) * a.roll + u * b.roll;
  out.offset = (1 - u) * a.offset + u * b.offset;
  out.radii = (1 - u) * a.radii + u * b.radii;
  for (std::size_t i = 0; i < out.outline.size(); ++i)
    out.outline[i] = float((1 - u) * a.outline[i] + u * b.outline[i]);
  return out;
}

void grow_strip(const Strip& before, const Strip& fitted, Strip& strip) {
  if (strip.path.size() == before.path.size() && strip.path.size() == fitted.path.size())
    for (std::size_t i = 0; i < strip.path.size(); ++i)
      strip.path[i].rest += fitted.path[i].rest - before.path[i].rest;
  strip.reference =
      Quat::FromTwoVectors(before.reference, fitted.reference).toRotationMatrix() * strip.reference;
  const bool same =
      strip.slices.size() == before.slices.size() && strip.slices.size() == fitted.slices.size();
  for (std::size_t i = 0; i < strip.slices.size(); ++i) {
    Slice& slice = strip.slices[i];
    const Slice was = same ? before.slices[i] : slice_at(before, slice.s);
    const Slice is = same ? fitted.slices[i] : slice_at(fitted, slice.s);
    if (same) slice.s = std::clamp(slice.s + is.s - was.s, 0.0, 1.0);
    slice.roll += is.roll - was.roll;
    slice.offset += is.offset - was.offset;
    slice.radii = slice.radii.cwiseProduct(is.radii.cwiseQuotient(was.radii.cwiseMax(1e-6)));
    slice.outline = is.outline;
  }
  if (same) strip.belly_begin += fitted.belly_begin - before.belly_begin;
  if (same) strip.belly_end += fitted.belly_end - before.belly_end;
  strip.rest_length = line_length(strip.path);
}

// Slices in rising order, whatever was added to them.
void keep_rising(Strip& strip) {
  for (std::size_t i = 1; i < strip.slices.size(); ++i)
    strip.slices[i].s = std::max(strip.slices[i].s, strip.slices[i - 1].s + 1e-6);
}

bool alike(const Document& a, const Document& b, const EditedMuscle& muscle) {
  if (a.frame == b.frame) return true;
  return std::ranges::all_of(wraps_of(muscle), [&](int wrap) {
    const std::size_t k = std::size_t(wrap);
    if (k >= a.frame->wraps.size() || k >= b.frame->wraps.size()) return false;
    const TableWrap &x = a.frame->wraps[k], &y = b.frame->wraps[k];
    return x.name == y.name && x.landmark == y.landmark && x.offset == y.offset &&
           x.axis == y.axis && x.radii == y.radii;
  });
}

}  // namespace

BoneCarrier::BoneCarrier(const Anatomy& from, const Anatomy& to) {
  const std::size_t joints = to.skeleton.joints.size();
  std::map<std::string_view, const Bone*> before;
  for (const Bone& bone : from.bones) before[bone.name] = &bone;
  std::vector<std::vector<std::pair<Vec3, Vec3>>> pairs(joints);
  for (const Bone& bone : to.bones) {
    const auto same = before.find(bone.name);
    if (same == before.end() || same->second->mesh.V.rows() != bone.mesh.V.rows()) continue;
    const Points &x = same->second->mesh.V, &y = bone.mesh.V;
    auto& of = pairs[std::size_t(bone.joint)];
    const Eigen::Index step = std::max<Eigen::Index>(1, x.rows() / kSamples);
    for (Eigen::Index i = 0; i < x.rows(); i += step)
      of.emplace_back(x.row(i).transpose(), y.row(i).transpose());
  }
  for (std::size_t j = 0; j < joints; ++j) {
    const int parent = to.skeleton.joints[j].parent;
    maps_.push_back(pairs[j].empty() && parent >= 0 ? maps_[std::size_t(parent)]
                                                    : best_map(pairs[j]));
  }
}

void rename_joints(const Skeleton& from, const Skeleton& to, std::vector<Muscle>& muscles) {
  std::vector<int> number;
  for (const Joint& joint : from.joints) {
    const int same = find_joint(to, joint.name);
    number.push_back(same >= 0 || joint.parent < 0 ? std::max(same, 0)
                                                   : number[std::size_t(joint.parent)]);
  }
  renumber_joints(number, muscles);
}

Muscle grown_like(Muscle placed, const Muscle& before, const Muscle& fitted) {
  const std::size_t strips =
      std::min({placed.strips.size(), before.strips.size(), fitted.strips.size()});
  for (std::size_t k = 0; k < strips; ++k) {
    grow_strip(before.strips[k], fitted.strips[k], placed.strips[k]);
    keep_rising(placed.strips[k]);
  }
  if (before.volume > 0) placed.volume *= fitted.volume / before.volume;
  return placed;
}

LiveMuscleMaker::LiveMuscleMaker(Workshop& workshop, const Document& of, const Anatomy& shown)
    : workshop_(workshop), of_(of), shown_(shown), carrier_(workshop.base().anatomy, shown) {}

std::vector<Muscle> LiveMuscleMaker::placed(const Document& document, int entry) {
  const Shared<EditedMuscle>& muscle = document.muscles[std::size_t(entry)];
  if (const auto last = placed_.find(muscle->left.name); last != placed_.end()) {
    const Document& of = last->second.of;
    const int then = find_entry(of, muscle->left.name);
    if (of.muscles[std::size_t(then)] == muscle && of.frame == document.frame &&
        of.skeleton == document.skeleton && of.joints == document.joints && of.fit == document.fit)
      return last->second.sides;
  }
  std::vector<Muscle> sides = placed_entry(workshop_, document, entry);
  if (has_own_parts(document) || has_own_parts(of_))
    rename_joints(edited_joints(workshop_, document), shown_.skeleton, sides);
  sides =
      carry_muscles(sides, [this](const Vec3& x, int joint) { return carrier_.carry(x, joint); });
  placed_[muscle->left.name] = {document, sides};
  return sides;
}

LiveMuscles LiveMuscleMaker::make(const Document& wanted, int most) {
  LiveMuscles out;
  for (std::size_t m = 0; m < wanted.muscles.size(); ++m) {
    const int before = find_entry(of_, wanted.muscles[m]->left.name);
    if (before < 0 || wanted.muscles[m] != of_.muscles[std::size_t(before)] ||
        !alike(wanted, of_, *wanted.muscles[m]))
      out.entries.push_back(int(m));
  }
  if (int(out.entries.size()) > most) return {};
  for (const int entry : out.entries) {
    std::vector<Muscle> sides = placed(wanted, entry);
    const std::string& name = wanted.muscles[std::size_t(entry)]->left.name;
    const int own = find_entry(of_, name);
    if (own >= 0 && !before_.contains(name)) before_[name] = placed(of_, own);
    for (std::size_t side = 0; side < sides.size(); ++side) {
      const int fitted = find_muscle(shown_, sides[side].name);
      if (fitted >= 0) out.replaced.push_back(sides[side].name);
      out.muscles.push_back(own >= 0 && fitted >= 0
                                ? grown_like(std::move(sides[side]), before_[name][side],
                                             shown_.muscles[std::size_t(fitted)])
                                : std::move(sides[side]));
    }
  }
  for (const auto& muscle : of_.muscles)
    if (find_entry(wanted, muscle->left.name) < 0)
      for (const char* side : {"_l", "_r"}) out.replaced.push_back(muscle->left.name + side);
  return out;
}

}  // namespace ecorche
