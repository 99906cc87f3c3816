#include "app/studio/design/draw_handles.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/design/fields.h"
#include "app/studio/design/shape_handles.h"
#include "app/studio/handles/axis_handles.h"
#include "app/studio/handles/limit_arcs.h"

namespace ecorche {
namespace {

constexpr float kReach = 0.85f, kRadius = 0.55f;  // of a letter's height
// Told apart by form and lightness, not by hue alone.
constexpr ImU32 kLineColor = IM_COL32(255, 235, 120, 255),
                kSectionColor = IM_COL32(255, 255, 255, 110),
                kWrapColor = IM_COL32(90, 200, 255, 220), kPointFill = IM_COL32(250, 205, 60, 255),
                kEdge = IM_COL32(25, 22, 18, 255), kJointFill = IM_COL32(120, 210, 255, 255),
                kHover = IM_COL32(255, 255, 255, 255), kFleshFill = IM_COL32(235, 110, 80, 255);
// Of flexion, abduction and rotation; letters tell them apart, too.
constexpr ImU32 kArcColors[] = {IM_COL32(255, 190, 60, 255), IM_COL32(110, 220, 150, 255),
                                IM_COL32(150, 180, 255, 255)};
constexpr const char* kArcLetters[] = {"F", "A", "R"};

void draw_wire(const WireShape& shape, const ViewProjection& view, ImDrawList& list) {
  std::vector<ImVec2> pixels;
  for (const Vec3f& point : shape.points) {
    const auto at = view.pixel(point);
    if (!at) return;
    pixels.emplace_back(at->x(), at->y());
  }
  const bool line = shape.kind == WireShape::Kind::line;
  const ImU32 color = line                                  ? kLineColor
                      : shape.kind == WireShape::Kind::wrap ? kWrapColor
                                                            : kSectionColor;
  const ImDrawFlags closed = shape.closed ? ImDrawFlags_Closed : ImDrawFlags_None;
  if (line) list.AddPolyline(pixels.data(), int(pixels.size()), kEdge, closed, 4);
  list.AddPolyline(pixels.data(), int(pixels.size()), color, closed, line ? 2.0f : 1.4f);
}

void draw_arc(const LimitArc& arc, const ViewProjection& view, ImDrawList& list) {
  std::vector<ImVec2> pixels;
  for (const Vec3& point : arc.points)
    if (const auto at = view.pixel(point.cast<float>())) pixels.emplace_back(at->x(), at->y());
  const auto middle = view.pixel(arc.middle.cast<float>()), now = view.pixel(arc.now.cast<float>());
  if (pixels.size() != arc.points.size() || !middle || !now) return;
  const ImU32 color = kArcColors[arc.axis];
  const ImVec2 from(middle->x(), middle->y());
  list.AddLine(from, pixels.front(), color, 1.2f);
  list.AddLine(from, pixels.back(), color, 1.2f);
  list.AddPolyline(pixels.data(), int(pixels.size()), kEdge, ImDrawFlags_None, 4.5f);
  list.AddPolyline(pixels.data(), int(pixels.size()), color, ImDrawFlags_None, 2.5f);
  list.AddLine(from, {now->x(), now->y()}, kHover, 1.6f);
}

void draw_axis(const Handle& handle, const ViewProjection& view, ImDrawList& list) {
  const auto from = view.pixel(handle.middle.cast<float>()),
             to = view.pixel(handle.place.cast<float>());
  if (!from || !to) return;
  list.AddLine({from->x(), from->y()}, {to->x(), to->y()}, kEdge, 4.5f);
  list.AddLine({from->x(), from->y()}, {to->x(), to->y()}, kArcColors[handle.axis], 2.5f);
}

// Forms that are neither round nor have letters: what shapes a muscle.
void draw_shape_handle(const Handle& handle, const ImVec2& at, bool hovered, ImDrawList& list) {
  using Kind = Handle::Kind;
  const float r = (hovered ? 0.38f : 0.27f) * ImGui::GetFontSize();
  const ImU32 edge = hovered ? kHover : kEdge;
  if (handle.kind == Kind::belly) {
    list.AddTriangleFilled({at.x - r, at.y + r}, {at.x + r, at.y + r}, {at.x, at.y - r},
                           kFleshFill);
    list.AddTriangle({at.x - r, at.y + r}, {at.x + r, at.y + r}, {at.x, at.y - r}, edge, 1.5f);
    return;
  }
  if (handle.kind == Kind::axis) {
    const ImVec2 points[] = {{at.x - 1.4f * r, at.y},
                             {at.x, at.y - 1.4f * r},
                             {at.x + 1.4f * r, at.y},
                             {at.x, at.y + 1.4f * r}};
    list.AddConvexPolyFilled(points, 4, kArcColors[handle.axis]);
    list.AddPolyline(points, 4, edge, ImDrawFlags_Closed, 1.6f);
    return;
  }
  if (handle.kind == Kind::wrap) {
    list.AddCircleFilled(at, 1.2f * r, kWrapColor);
    list.AddCircle(at, 1.2f * r, edge, 0, 1.5f);
    return;
  }
  const ImU32 fill = handle.kind == Kind::size        ? kWrapColor
                     : handle.kind == Kind::thickness ? kSectionColor | IM_COL32(0, 0, 0, 255)
                                                      : kHover;
  list.AddRectFilled({at.x - r, at.y - r}, {at.x + r, at.y + r}, fill);
  list.AddRect({at.x - r, at.y - r}, {at.x + r, at.y + r}, edge, 0, 0, 1.5f);
}

void draw_limit(const Handle& handle, const ImVec2& at, bool hovered, ImDrawList& list) {
  const float em = ImGui::GetFontSize(), radius = (hovered ? 0.6f : 0.55f) * em;
  list.AddCircleFilled(at, radius, kArcColors[handle.axis]);
  list.AddCircle(at, radius, hovered ? kHover : kEdge, 0, 1.6f);
  const char* letter = kArcLetters[handle.axis];
  const ImVec2 size = ImGui::CalcTextSize(letter);
  list.AddText({at.x - 0.5f * size.x, at.y - 0.5f * size.y}, kEdge, letter);
}

void draw_point(const Handle& handle, const ImVec2& at, bool hovered, ImDrawList& list) {
  const float em = ImGui::GetFontSize(), radius = (hovered ? 1.25f : 1.0f) * kRadius * em;
  if (handle.kind == Handle::Kind::limit) return draw_limit(handle, at, hovered, list);
  const bool joint = handle.kind == Handle::Kind::joint;
  if (!joint && handle.kind != Handle::Kind::point)
    return draw_shape_handle(handle, at, hovered, list);
  if (joint) {
    list.AddNgonFilled(at, 0.8f * radius, kJointFill, 4);
    list.AddNgon(at, 0.8f * radius, hovered ? kHover : kEdge, 4, 1.6f);
    return;
  }
  list.AddCircleFilled(at, radius, kPointFill);
  list.AddCircle(at, radius, hovered ? kHover : kEdge, 0, hovered ? 2.4f : 1.6f);
  const std::string text = handle.point == 0 ? "O"
                           : handle.point + 1 == handle.points
                               ? "I"
                               : fmt::format("{}", handle.point + 1);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  list.AddText({at.x - 0.5f * size.x, at.y - 0.5f * size.y}, kEdge, text.c_str());
}

std::string told_of_shape(const Handle& handle) {
  using Kind = Handle::Kind;
  switch (handle.kind) {
    case Kind::width:
      return fmt::format("width of the section at {:g}\ndrag: wider; around the line: it rolls",
                         handle.value);
    case Kind::thickness:
      return fmt::format("thickness of the section at {:g}\ndrag: thicker", handle.value);
    case Kind::belly:
      return fmt::format("the flesh {} here\ndrag: along the line",
                         handle.index == 0 ? "begins" : "ends");
    case Kind::wrap:
      return "middle of a wrap\ndrag: move it, for all who slide over it";
    case Kind::axis:
      return fmt::format("axis of {}\ndrag: turn the joint's axes",
                         kAngleNames[std::size_t(handle.axis)]);
    case Kind::size:
      return "size of a wrap\ndrag: larger or smaller";
    default:
      return fmt::format("{}, {} {:.0f} deg\ndrag: how far the joint goes",
                         kAngleNames[std::size_t(handle.axis)],
                         handle.index == 0 ? "at least" : "at most", handle.value);
  }
}

void tell(const Handle& handle, const DesignSession& session) {
  std::string text;
  if (handle.kind != Handle::Kind::joint && handle.kind != Handle::Kind::point) {
    text = told_of_shape(handle);
  } else if (handle.kind == Handle::Kind::joint) {
    text = session.anatomy().skeleton.joints[std::size_t(handle.joint)].name +
           "\ndrag: move its centre; click: its angles and limits";
  } else {
    text = handle.point == 0                   ? "origin"
           : handle.point + 1 == handle.points ? "insertion"
                                               : fmt::format("point {}", handle.point + 1);
    text += handle.side == Side::right ? ", right" : ", left";
    text += "\ndrag: move it";
  }
  ImGui::SetTooltip("%s", text.c_str());
}

int handle_at(const PanelState& state, const ViewProjection& view, float x, float y) {
  int best = -1;
  float least = kReach * ImGui::GetFontSize();
  for (int k = 0; k < int(state.handles.size()); ++k) {
    const auto at = view.pixel(state.handles[std::size_t(k)].place.cast<float>());
    if (!at) continue;
    const float distance = (*at - Vec2f(x, y)).norm();
    if (distance >= least) continue;
    least = distance;
    best = k;
  }
  return best;
}

// The arcs of the joint that is chosen, on the left where it is of both sides.
void draw_limits_of(DesignSession& session, PanelState& state, const PosedAnatomy& posed,
                    const ViewProjection& view, ImDrawList& list) {
  const Skeleton& skeleton = session.anatomy().skeleton;
  int joint = find_joint(skeleton, state.joint);
  if (joint < 0) joint = find_joint(skeleton, state.joint + "_l");
  if (joint < 0 || posed.X_WJ.size() != skeleton.joints.size()) return;
  for (const LimitArc& arc : limit_arcs(skeleton, session.seen(), joint, posed, state.handles))
    draw_arc(arc, view, list);
  if (!state.axes) return;
  const std::size_t first = state.handles.size();
  add_axes(skeleton, session.shown().of, session.seen(), joint, posed, state.handles);
  for (std::size_t k = first; k < state.handles.size(); ++k)
    draw_axis(state.handles[k], view, list);
}

// Of the picked muscle, as this side of it is seen.
void add_shape_handles(const DesignSession& session, PanelState& state,
                       const DesignSession::SeenMuscle& seen, const PosedAnatomy& posed) {
  const Document& document = session.seen();
  const int entry = find_entry(document, document.picked);
  if (entry < 0) return;
  const EditedMuscle& edited = *document.muscles[std::size_t(entry)];
  const bool right = seen.muscle->side == Side::right && edited.right;
  if (state.sections) add_section_handles(right ? *edited.right : edited.left, seen, state.handles);
  if (state.wraps) add_wrap_handles(*seen.muscle, session.joint_rest(), posed, state.handles);
}

std::optional<Action> action_of(const DragInput& input, const HandleDrag& drag, bool one_side) {
  using Kind = Handle::Kind;
  const Kind kind = drag.handle.kind;
  if (kind == Kind::axis) return action_of_axis(input, drag.handle, drag.moved, one_side);
  if (kind == Kind::limit) return action_of_limit(input, drag.handle, drag.moved, one_side);
  if (kind == Kind::point || kind == Kind::joint)
    return action_of_drag(input, drag.handle, drag.moved, one_side);
  return action_of_shape(input, drag.handle, drag.moved, one_side);
}

// Where a new muscle begins, until it is clicked where it ends.
void draw_bone_click(DesignSession& session, const BoneClick& click, const PosedAnatomy& posed,
                     const ViewProjection& view, ViewDocument& document, ImDrawList& list) {
  const auto seen = [&](const Vec3& rest, int joint) {
    const PathPoint at{rest, {joint, -1}, 1};
    return view.pixel(posed_place(at, session.joint_rest(), posed).cast<float>());
  };
  if (document.recorded)
    for (const Bone& bone : session.anatomy().bones)
      if (const auto at = seen(bone.mesh.V.colwise().mean().transpose(), bone.joint))
        document.places["bone:" + bone.name] = *at;
  for (const BonePlace& place : click.painted)
    if (const auto at = seen(place.rest, place.joint))
      list.AddCircleFilled({at->x(), at->y()}, 0.3f * ImGui::GetFontSize(), kPointFill);
  if (!click.origin) return;
  const auto from = seen(click.origin->rest, click.origin->joint);
  if (!from) return;
  const ImVec2 begin(from->x(), from->y()), mouse = ImGui::GetIO().MousePos;
  list.AddLine(begin, mouse, kPointFill, 2);
  list.AddCircleFilled(begin, 0.4f * ImGui::GetFontSize(), kPointFill);
}

}  // namespace

void draw_handles(DesignSession& session, PanelState& state, const PosedAnatomy& posed,
                  const ViewProjection& view, ViewDocument& document) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  std::vector<WireShape> wires;
  state.handles.clear();
  if (state.bone_click) {
    draw_bone_click(session, *state.bone_click, posed, view, document, list);
    return;
  }
  if (state.joints) {
    const Skeleton& skeleton = session.anatomy().skeleton;
    add_joints(skeleton, posed, state.handles);
    std::erase_if(state.handles, [&](const Handle& handle) {
      return !session.has_joint(skeleton.joints[std::size_t(handle.joint)].name);
    });
  }
  for (const auto& seen : session.picked(posed)) {
    if (state.joint_tab) break;  // its own handles are enough
    add_wires(*seen.muscle, seen.slices, session.joint_rest(), posed, wires);
    if (state.points) add_points(*seen.muscle, session.joint_rest(), posed, state.handles);
    add_shape_handles(session, state, seen, posed);
  }
  if (state.joint_tab && !state.joint.empty()) draw_limits_of(session, state, posed, view, list);
  for (const WireShape& wire : wires) {
    const bool shown = wire.kind == WireShape::Kind::section ? state.sections
                       : wire.kind == WireShape::Kind::wrap  ? state.wraps
                                                             : state.points;
    if (shown) draw_wire(wire, view, list);
  }
  if (state.drag && state.drag->handle.kind == Handle::Kind::joint) {
    // The skeleton follows when it is fitted; until then its new place is seen.
    const Handle& joint = state.drag->handle;
    const auto from = view.pixel(joint.place.cast<float>());
    const auto to = view.pixel((joint.place + state.drag->moved).cast<float>());
    if (from && to) {
      list.AddLine({from->x(), from->y()}, {to->x(), to->y()}, kJointFill, 2);
      draw_point(joint, {to->x(), to->y()}, true, list);
    }
  }
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  state.hovered = ImGui::GetIO().WantCaptureMouse ? -1 : handle_at(state, view, mouse.x, mouse.y);
  for (int k = 0; k < int(state.handles.size()); ++k) {
    const Handle& handle = state.handles[std::size_t(k)];
    const auto at = view.pixel(handle.place.cast<float>());
    if (!at) continue;
    const bool held = state.drag && state.drag->handle.name == handle.name;
    draw_point(handle, {at->x(), at->y()}, held || k == state.hovered, list);
    if (document.recorded || document.names_places) document.places[handle.name] = *at;
  }
  if (state.hovered >= 0 && !state.drag) tell(state.handles[std::size_t(state.hovered)], session);
}

bool take_handle(DesignSession& session, PanelState& state, const PosedAnatomy& posed,
                 const WindowEvent& event, const ViewProjection& view) {
  using Kind = WindowEvent::Kind;
  if (event.kind == Kind::press && event.key == GLFW_MOUSE_BUTTON_LEFT &&
      !ImGui::GetIO().WantCaptureMouse) {
    const int found = handle_at(state, view, event.x, event.y);
    if (found < 0) return false;
    state.drag = HandleDrag{.handle = state.handles[std::size_t(found)]};
    state.pressed = {event.x, event.y};
    return true;
  }
  if (!state.drag) return false;
  HandleDrag& drag = *state.drag;
  const bool joint = drag.handle.kind == Handle::Kind::joint;
  const bool of_joint =
      joint || drag.handle.kind == Handle::Kind::limit || drag.handle.kind == Handle::Kind::axis;
  const std::string where = of_joint ? "joint" : "line";
  if (event.kind == Kind::key && event.key == GLFW_KEY_ESCAPE) {
    session.let_go();
    state.drag.reset();
    return true;
  }
  if (event.kind == Kind::move) {
    const Vec2f by = Vec2f(event.x, event.y) - state.pressed;
    if (!drag.begun && by.norm() < 3) return true;
    drag.begun = true;
    drag.moved = view.moved(drag.handle.place.cast<float>(), by.x(), by.y()).cast<double>();
    const DragInput input{session.session().document(), session.workshop(), session.carrier(),
                          posed, session.anatomy().skeleton};
    if (const auto action = action_of(input, drag, state.one_side)) session.try_out(*action, where);
    return true;
  }
  if (event.kind == Kind::release && event.key == GLFW_MOUSE_BUTTON_LEFT) {
    if (drag.begun) session.keep_tried(where);
    if (!drag.begun && joint) {
      const std::string& name =
          session.anatomy().skeleton.joints[std::size_t(drag.handle.joint)].name;
      state.joint =
          name.ends_with("_l") || name.ends_with("_r") ? name.substr(0, name.size() - 2) : name;
    }
    session.let_go();
    state.drag.reset();
    return true;
  }
  return false;
}

}  // namespace ecorche
