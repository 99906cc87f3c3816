#include "app/studio/design/shape_handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/edit/document/edit_muscle.h"

namespace ecorche {
namespace {

using Kind = Handle::Kind;

constexpr double kSmallRoll = 4;        // deg; a hand that widens does not mean to roll
constexpr double kLeastShare = 0.1;     // that a size is dragged down to at once
constexpr double kLeastMeant = 0.1e-3;  // m

double tenths(double millimetres) { return std::round(10 * millimetres) / 10; }

std::string suffix_of(Side side) { return side == Side::right ? "_r" : ""; }

// The section at a share of a strip's line, between its slices.
struct SeenSection {
  Vec3 center = Vec3::Zero(), along = Vec3::UnitY(), width = Vec3::Zero(), thickness = Vec3::Zero();
};

SeenSection section_between(const Strip& strip, std::span<const Ellipse> slices, double share) {
  const auto after = std::ranges::upper_bound(strip.slices, share, {}, &Slice::s);
  const long last = long(strip.slices.size()) - 1;
  const long b = std::clamp(long(after - strip.slices.begin()), 1L, last), a = b - 1;
  const double from = strip.slices[std::size_t(a)].s, to = strip.slices[std::size_t(b)].s;
  const double u = std::clamp((share - from) / std::max(to - from, 1e-9), 0.0, 1.0);
  const auto arm = [](const Ellipse& e, int axis) -> Vec3 {
    const std::size_t sector = axis == 0 ? 0 : std::size_t(kOutlinePoints) / 4;
    return e.radii[axis] * double(e.outline[sector]) * e.axes.col(axis);
  };
  const Ellipse &x = slices[std::size_t(a)], &y = slices[std::size_t(b)];
  SeenSection out;
  out.center = (1 - u) * x.center + u * y.center;
  out.along = (y.center - x.center).normalized();
  out.width = (1 - u) * arm(x, 0) + u * arm(y, 0);
  out.thickness = (1 - u) * arm(x, 1) + u * arm(y, 1);
  return out;
}

void add_belly_ends(const Strip& strip, std::span<const Ellipse> slices, const Handle& base,
                    std::vector<Handle>& out) {
  std::vector<std::pair<double, Vec3>> way;
  for (std::size_t k = 0; k < strip.slices.size(); ++k)
    way.emplace_back(strip.slices[k].s, slices[k].center);
  for (const int end : {0, 1}) {
    Handle handle = base;
    handle.kind = Kind::belly;
    handle.index = end;
    handle.value = end == 0 ? strip.belly_begin : strip.belly_end;
    handle.place = section_between(strip, slices, handle.value).center;
    handle.name = fmt::format("belly{}:{}:{}", suffix_of(base.side), base.strip + 1,
                              end == 0 ? "begin" : "end");
    handle.way = way;
    out.push_back(std::move(handle));
  }
}

const TableMuscle* table_of(const DragInput& input, const Handle& handle) {
  const Document& document = input.document;
  const int entry = find_entry(document, document.picked);
  if (entry < 0) return nullptr;
  const EditedMuscle& edited = *document.muscles[std::size_t(entry)];
  const TableMuscle& muscle =
      handle.side == Side::right && edited.right ? *edited.right : edited.left;
  return handle.strip < int(muscle.strips.size()) ? &muscle : nullptr;
}

// How many times as long the arm is, and how far it has turned about `along`, deg.
struct ArmChange {
  double times = 1, turned = 0;
};
ArmChange change_of_arm(const Handle& handle, const Vec3& moved) {
  const Vec3 arm = handle.place - handle.middle;
  Vec3 now = arm + moved;
  now -= now.dot(handle.along) * handle.along;
  ArmChange out;
  out.times = std::max(now.dot(arm) / arm.squaredNorm(), kLeastShare);
  if (handle.along.isZero() || now.norm() < 1e-6) return out;
  const Vec3 from = arm - arm.dot(handle.along) * handle.along;
  out.turned = std::atan2(handle.along.dot(from.cross(now)), from.dot(now)) / kDegree;
  if (std::abs(out.turned) < kSmallRoll)
    out.turned = 0;
  else
    out.times = std::max(now.norm() / from.norm(), kLeastShare);
  return out;
}

std::optional<Action> drag_of_section(const TableMuscle& muscle, const Handle& handle,
                                      const Vec3& moved, const std::string& name) {
  const TableStrip& strip = muscle.strips[std::size_t(handle.strip)];
  const auto section = std::ranges::find(strip.sections, handle.value, &TableSection::s);
  if (section == strip.sections.end()) return std::nullopt;
  const ArmChange change = change_of_arm(handle, moved);
  SetSection action;
  action.muscle = name;
  action.strip = handle.strip + 1;
  action.at = handle.value;
  const int axis = handle.kind == Kind::width ? 0 : 1;
  const double now = 2e3 * section->radii[axis], wanted = tenths(now * change.times);
  if (std::abs(wanted - now) > 1e3 * kLeastMeant)
    (axis == 0 ? action.width : action.thickness) = std::max(wanted, 0.1);
  if (axis == 0 && change.turned != 0)
    action.roll = std::round(handle.side == Side::right ? -change.turned : change.turned);
  if (!action.width && !action.thickness && !action.roll) return std::nullopt;
  return action;
}

std::optional<Action> drag_of_belly(const TableMuscle& muscle, const Handle& handle,
                                    const Vec3& moved, const std::string& name) {
  const TableStrip& strip = muscle.strips[std::size_t(handle.strip)];
  const Vec3 wanted = handle.place + moved;
  double best = handle.value, least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < handle.way.size(); ++k) {
    const auto& [s0, a] = handle.way[k];
    const auto& [s1, b] = handle.way[k + 1];
    const Vec3 piece = b - a;
    const double u =
        std::clamp((wanted - a).dot(piece) / std::max(piece.squaredNorm(), 1e-12), 0.0, 1.0);
    const double far = (a + u * piece - wanted).norm();
    if (far < least) least = far, best = s0 + u * (s1 - s0);
  }
  constexpr double kShortest = 0.05;  // of the flesh
  SetBelly action;
  action.muscle = name;
  action.strip = handle.strip + 1;
  const auto thousandths = [](double share) { return std::round(1e3 * share) / 1e3; };
  if (handle.index == 0)
    action.begin = thousandths(std::clamp(best, 0.0, strip.belly_end - kShortest));
  else
    action.end = thousandths(std::clamp(best, strip.belly_begin + kShortest, 1.0));
  return action;
}

std::optional<Action> drag_of_wrap(const DragInput& input, const TableMuscle& muscle,
                                   const Handle& handle, const Vec3& moved,
                                   const std::string& name) {
  const auto& uses = muscle.strips[std::size_t(handle.strip)].wraps;
  if (handle.index >= int(uses.size())) return std::nullopt;
  const TableStrip::WrapUse& use = uses[std::size_t(handle.index)];
  const TableWrap& wrap = input.document.frame->wraps[std::size_t(use.wrap)];
  SetWrap action;
  action.wrap = wrap.name;
  if (handle.kind == Kind::wrap) {
    const Vec3 at = position(*input.document.frame, {wrap.landmark, wrap.offset});
    action.by = step_in_table(input, at, handle.at.joints[0], handle.side,
                              rest_step(handle.at, input.posed, moved));
    return action.by.isZero() ? std::nullopt : std::optional<Action>(action);
  }
  const double times = change_of_arm(handle, moved).times;
  const bool half = wrap.kind == Wrap::Kind::cylinder && handle.axis == 2;
  if (use.radius > 0 && !half) {
    UseWrap own{name, wrap.name, handle.strip + 1, tenths(1e3 * use.radius * times)};
    return own;
  }
  if (wrap.kind == Wrap::Kind::ellipsoid) {
    action.axes = 1e3 * wrap.radii;
    action.axes[handle.axis] = std::max(tenths(action.axes[handle.axis] * times), 0.1);
  } else if (half) {
    action.half = std::max(tenths(1e3 * wrap.radii.z() * times), 0.1);
  } else {
    action.radius = std::max(tenths(1e3 * wrap.radii.x() * times), 0.1);
  }
  return action;
}

}  // namespace

void add_section_handles(const TableMuscle& muscle, const DesignSession::SeenMuscle& seen,
                         std::vector<Handle>& out) {
  std::size_t at = 0;
  for (int k = 0; k < int(seen.muscle->strips.size()); ++k) {
    const Strip& strip = seen.muscle->strips[std::size_t(k)];
    if (at + strip.slices.size() > seen.slices.size() || k >= int(muscle.strips.size())) return;
    const std::span<const Ellipse> slices(seen.slices.data() + at, strip.slices.size());
    at += strip.slices.size();
    if (slices.size() < 2) continue;
    Handle base{.side = seen.muscle->side, .strip = k};
    for (const TableSection& section : muscle.strips[std::size_t(k)].sections) {
      if (section.s <= 0 || section.s >= 1) continue;
      const SeenSection shown = section_between(strip, slices, section.s);
      for (const Kind kind : {Kind::width, Kind::thickness}) {
        Handle handle = base;
        handle.kind = kind;
        handle.value = section.s;
        handle.middle = shown.center;
        handle.along = shown.along;
        handle.place = shown.center + (kind == Kind::width ? shown.width : shown.thickness);
        handle.name = fmt::format("{}{}:{}:{:g}", kind == Kind::width ? "width" : "thickness",
                                  suffix_of(base.side), k + 1, section.s);
        if ((handle.place - handle.middle).norm() > 1e-6) out.push_back(std::move(handle));
      }
    }
    add_belly_ends(strip, slices, base, out);
  }
}

void add_wrap_handles(const Muscle& muscle, std::span<const Vec3> joint_rest,
                      const PosedAnatomy& posed, std::vector<Handle>& out) {
  for (int k = 0; k < int(muscle.strips.size()); ++k) {
    const Strip& strip = muscle.strips[std::size_t(k)];
    for (int w = 0; w < int(strip.wraps.size()); ++w) {
      const Wrap& wrap = strip.wraps[std::size_t(w)];
      Handle handle{.kind = Kind::wrap, .side = muscle.side, .strip = k};
      handle.index = w;
      handle.at = {wrap.X_WO.translation(), {wrap.joint, -1}, 1};
      handle.place = posed_place(handle.at, joint_rest, posed);
      const std::string own = fmt::format("{}:{}:{}", suffix_of(muscle.side), k + 1, w + 1);
      handle.name = "wrap" + own;
      out.push_back(handle);
      const Mat3 turn = posed.X_WJ[std::size_t(wrap.joint)].linear() * wrap.X_WO.linear();
      handle.middle = handle.place;
      handle.kind = Kind::size;
      for (int axis = 0; axis < 3; ++axis) {
        const bool own_size = axis == 0 || wrap.kind == Wrap::Kind::ellipsoid ||
                              (wrap.kind == Wrap::Kind::cylinder && axis == 2);
        if (!own_size) continue;
        handle.axis = axis;
        handle.place = handle.middle + wrap.radii[axis] * turn.col(axis);
        handle.name = fmt::format("size{}:{}", own, "xyz"[axis]);
        out.push_back(handle);
      }
    }
  }
}

std::optional<Action> action_of_shape(const DragInput& input, const Handle& handle,
                                      const Vec3& moved, bool one_side) {
  const TableMuscle* muscle = table_of(input, handle);
  if (!muscle) return std::nullopt;
  const std::string name =
      muscle->name + (one_side ? (handle.side == Side::right ? "_r" : "_l") : "");
  switch (handle.kind) {
    case Kind::width:
    case Kind::thickness:
      return drag_of_section(*muscle, handle, moved, name);
    case Kind::belly:
      return drag_of_belly(*muscle, handle, moved, name);
    case Kind::wrap:
    case Kind::size:
      return drag_of_wrap(input, *muscle, handle, moved, name);
    default:
      return std::nullopt;
  }
}

}  // namespace ecorche
