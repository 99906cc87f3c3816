#include "app/studio/design/draw_handles.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/design/fields.h"

namespace ecorche {
namespace {

constexpr float kReach = 0.85f, kRadius = 0.5f;  // of a letter's height
// Told apart by form and lightness, not by hue alone.
constexpr ImU32 kLineColor = IM_COL32(255, 235, 120, 255),
                kSectionColor = IM_COL32(255, 255, 255, 110),
                kWrapColor = IM_COL32(90, 200, 255, 220), kPointFill = IM_COL32(250, 205, 60, 255),
                kEdge = IM_COL32(25, 22, 18, 255), kJointFill = IM_COL32(120, 210, 255, 255),
                kHover = IM_COL32(255, 255, 255, 255);

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

void draw_point(const Handle& handle, const ImVec2& at, bool hovered, ImDrawList& list) {
  const float em = ImGui::GetFontSize(), radius = (hovered ? 1.25f : 1.0f) * kRadius * em;
  const bool joint = handle.kind == Handle::Kind::joint;
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
  const float scale = 0.9f;
  list.AddText(nullptr, scale * em, {at.x - 0.5f * scale * size.x, at.y - 0.5f * scale * size.y},
               kEdge, text.c_str());
}

void tell(const Handle& handle, const DesignSession& session) {
  std::string text;
  if (handle.kind == Handle::Kind::joint) {
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

}  // namespace

void draw_handles(DesignSession& session, PanelState& state, const PosedAnatomy& posed,
                  const ViewProjection& view, ViewDocument& document) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  std::vector<WireShape> wires;
  state.handles.clear();
  if (state.joints) add_joints(session.anatomy().skeleton, posed, state.handles);
  for (const auto& seen : session.picked(posed)) {
    add_wires(*seen.muscle, seen.slices, session.joint_rest(), posed, wires);
    if (state.points) add_points(*seen.muscle, session.joint_rest(), posed, state.handles);
  }
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
    if (document.recorded) document.places[handle.name] = *at;
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
  const std::string where = joint ? "joint" : "line";
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
    if (const auto action = action_of_drag(input, drag.handle, drag.moved, state.one_side))
      session.try_out(*action, where);
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
