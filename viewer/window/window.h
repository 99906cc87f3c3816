// The interactive window (GLFW, Dear ImGui).
#pragma once

#include <filesystem>

#include "viewer/window/view_document.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

struct WindowOptions {
  int width = 1280, height = 800;
  // closes after this number of frames, with a clock of 1/30 s a frame; 0: runs until closed
  int frames = 0;
  std::filesystem::path screenshot{};  // of the last frame, panels included; empty: none
  // share of the window's width and height: picked at the first frame, as by a click
  double pick_x = -1, pick_y = -1;
  // a session that is played from a text (recorded_input.h); the window closes at its end; empty: a
  // person's
  std::filesystem::path input{};
};

// Runs the window until it is closed and returns the final document. With `frames`, the last frame
// waits for jobs in the background. Throws OutputError without a display or a driver, with a remedy
// in its message; UsageError for a size below 1; as RecordedInput.
ViewDocument run_window(const ViewSubject& subject, const WindowOptions& options = {},
                        const ViewDocument& document = {}, const WindowTool& tool = {});

}  // namespace ecorche
