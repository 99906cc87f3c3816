#include "app/studio/design/bone_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <string>

#include "app/studio/handles/bone_clicks.h"

namespace ecorche {
namespace {

// The button that is held on a bone paints; elsewhere it turns the view as ever.
bool take_brush(DesignSession& session, PanelState& state, const PosedAnatomy* posed,
                const WindowEvent& event, const ViewProjection& view) {
  using Kind = WindowEvent::Kind;
  BoneClick& click = *state.bone_click;
  const auto place = [&] {
    return bone_under(session.anatomy(), session.joint_rest(), *posed, view, {event.x, event.y},
                      session.workshop());
  };
  if (event.kind == Kind::press && event.key == GLFW_MOUSE_BUTTON_LEFT && posed &&
      !ImGui::GetIO().WantCaptureMouse) {
    const auto first = place();
    if (!first) return false;
    click.painting = true;
    paint(*first, click);
    return true;
  }
  if (!click.painting) return false;
  if (event.kind == Kind::move) {
    if (const auto next = place()) paint(*next, click);
    return true;
  }
  if (event.kind != Kind::release) return false;
  click.painting = false;
  state.bone_clicked = true;
  return true;
}

}  // namespace

bool take_bone_click(DesignSession& session, PanelState& state, const PosedAnatomy* posed,
                     const WindowEvent& event, const ViewProjection& view) {
  using Kind = WindowEvent::Kind;
  const Vec2f at(event.x, event.y);
  if (event.kind == Kind::key && event.key == GLFW_KEY_ESCAPE) {
    state.bone_click.reset();
    return true;
  }
  if (state.bone_click->what == BoneClick::For::area)
    return take_brush(session, state, posed, event, view);
  if (event.kind == Kind::press) state.pressed = at;
  if (event.kind != Kind::release || event.key != GLFW_MOUSE_BUTTON_LEFT || !posed ||
      ImGui::GetIO().WantCaptureMouse || (at - state.pressed).norm() > 3)
    return false;
  state.bone_clicked = true;
  const auto place =
      bone_under(session.anatomy(), session.joint_rest(), *posed, view, at, session.workshop());
  if (!place) {
    session.say("there is no bone of the built-in skeleton; click on one");
    return false;
  }
  session.say({});
  if (state.bone_click->what == BoneClick::For::origin) {
    state.bone_click->what = BoneClick::For::insertion;
    state.bone_click->origin = place;
    return false;
  }
  const std::string line = line_of_click(*state.bone_click, *place, session.session().document());
  if (!session.run(line, "bar")) return false;
  if (state.bone_click->what == BoneClick::For::insertion)
    session.run("pick " + split_words(line)[1], "bar");
  state.bone_click.reset();
  return false;
}

}  // namespace ecorche
