// What a person did since the last frame, in order: nothing is lost between frames, however long
// they take.
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

struct GLFWwindow;

namespace ecorche {

struct WindowEvent {
  enum class Kind { key, press, release, move, scroll, drop } kind = Kind::move;
  int key = 0;  // GLFW's number; of a mouse button
  bool ctrl = false, shift = false, alt = false;
  float x = 0, y = 0;  // pixels of the window from the upper left; of the wheel: clicks
  std::vector<std::filesystem::path> files{};
};

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
