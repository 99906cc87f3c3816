// The interactive window (GLFW, Dear ImGui).
#pragma once

#include <filesystem>

#include "viewer/window/view_document.h"

namespace ecorche {

struct WindowOptions {
  int width = 1280, height = 800;
  // close after so many; the clock then goes 1/30 s a frame. 0: until the person closes it
  int frames = 0;
  std::filesystem::path screenshot{};  // of the last frame, panels included; empty: none
  // share of the window's width and height: picked at the first frame, as by a click
  double pick_x = -1, pick_y = -1;
};

// Shows until closed and hands back what the person had chosen last. With `frames`, the last one
// waits for what is under way. Throws OutputError without a display or a driver, and says what to
// do; UsageError for a size below 1.
ViewDocument run_window(const ViewSubject& subject, const WindowOptions& options = {},
                        const ViewDocument& document = {});

}  // namespace ecorche
