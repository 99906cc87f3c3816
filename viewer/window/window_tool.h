// What a tool adds to the window: panels of its own, shapes in and over the figure, and the mouse
// and the keys before the view has them. Every function may be left out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "viewer/scene.h"
#include "viewer/window/view_document.h"
#include "viewer/window/window_event.h"

namespace ecorche {

using Vec2f = Eigen::Vector2f;

// The camera of the displayed picture, in the window's pixels from the upper left.
class ViewProjection {
 public:
  ViewProjection() = default;
  ViewProjection(const Camera& camera, float width, float height);

  std::optional<Vec2f> pixel(const Vec3f& place) const;  // none behind the eye
  float depth(const Vec3f& place) const;  // larger farther from the eye, linear in the picture
  // How far a place has moved, m, that goes so many pixels in the plane of the picture.
  Vec3f moved(const Vec3f& place, float dx, float dy) const;

 private:
  Mat4f clip_from_world_ = Mat4f::Identity();
  Vec3f right_ = Vec3f::UnitX(), up_ = Vec3f::UnitY();
  float width_ = 1, height_ = 1;
};

// Another figure in the same view.
struct FigureBeside {
  const ViewSubject* subject = nullptr;  // null: there is none
  bool wiped = false;  // over the tool's own, right of a line; else each has half of the room
  float share = 0.5f;  // of the room's width, where that line is
};

struct KeyLine {
  std::string name, effect;
};

struct WindowTool {
  // In place of the view's own panels; returns the room that they leave for the figure.
  std::function<ViewRoom(const PosedAnatomy& posed, ViewDocument& document)> panels{};
  // Changes how the figure looks; of the document's look.
  std::function<void(Appearance& appearance)> dress{};
  // The figure beside, and how it looks; of the document's look.
  std::function<FigureBeside()> beside{};
  std::function<void(Appearance& appearance)> dress_beside{};
  // Adds meshes and items to the picture; they are gone again after it.
  std::function<void(const PosedAnatomy& posed, const Appearance& appearance, DrawList& list)>
      add{};
  // Between ImGui::NewFrame and ImGui::Render, with the camera of this frame.
  std::function<void(const PosedAnatomy& posed, const ViewProjection& view, ViewDocument& document)>
      draw_over{};
  // Returns whether the tool has used the event up.
  std::function<bool(const WindowEvent& event, const ViewProjection& view, ViewDocument& document)>
      take{};
  std::function<void(std::uint32_t part)> picked{};  // by a click; 0: nothing
  std::function<bool()> may_close{};                 // false: stays open
  // After a frame is on the screen. `began`: when its events were read, by the steady clock, s.
  std::function<void(double began, double seconds, const ViewDocument& document)> shown{};
  std::vector<KeyLine> keys{};  // for the list of keys, before the view's own
};

}  // namespace ecorche
