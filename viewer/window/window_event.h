// One thing that a person did to the window.
#pragma once

#include <filesystem>
#include <vector>

namespace ecorche {

struct WindowEvent {
  enum class Kind { key, press, release, move, scroll, drop } kind = Kind::move;
  int key = 0;  // GLFW's number; of a mouse button
  bool ctrl = false, shift = false, alt = false;
  float x = 0, y = 0;  // pixels of the window from the upper left; of the wheel: clicks
  std::vector<std::filesystem::path> files{};
};

}  // namespace ecorche
