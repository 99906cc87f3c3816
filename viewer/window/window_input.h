// What a person did since the last frame, in order: nothing is lost between frames, however long
// they take.
#pragma once

#include <utility>
#include <vector>

#include "viewer/window/window_event.h"

struct GLFWwindow;

namespace ecorche {

// Listens to a window; whoever listens after it (ImGui) passes events on. The window's user pointer
// is taken.
class WindowInput {
 public:
  explicit WindowInput(GLFWwindow* window);
  WindowInput(const WindowInput&) = delete;
  WindowInput& operator=(const WindowInput&) = delete;

  // All since the last call.
  std::vector<WindowEvent> take() { return std::exchange(events_, {}); }
  void add(WindowEvent event) { events_.push_back(std::move(event)); }

 private:
  std::vector<WindowEvent> events_;
};

}  // namespace ecorche
