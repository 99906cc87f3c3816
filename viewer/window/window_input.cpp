#include "viewer/window/window_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace ecorche {
namespace {

using Kind = WindowEvent::Kind;

WindowInput& input_of(GLFWwindow* window) {
  return *static_cast<WindowInput*>(glfwGetWindowUserPointer(window));
}

WindowEvent made(Kind kind, GLFWwindow* window, int modifiers) {
  double x = 0, y = 0;
  glfwGetCursorPos(window, &x, &y);
  return {.kind = kind,
          .ctrl = (modifiers & GLFW_MOD_CONTROL) != 0,
          .shift = (modifiers & GLFW_MOD_SHIFT) != 0,
          .alt = (modifiers & GLFW_MOD_ALT) != 0,
          .x = float(x),
          .y = float(y)};
}

void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
  if (action == GLFW_RELEASE) return;
  WindowEvent event = made(Kind::key, window, modifiers);
  event.key = key;
  input_of(window).add(std::move(event));
}

void on_button(GLFWwindow* window, int button, int action, int modifiers) {
  WindowEvent event = made(action == GLFW_PRESS ? Kind::press : Kind::release, window, modifiers);
  event.key = button;
  input_of(window).add(std::move(event));
}

void on_move(GLFWwindow* window, double x, double y) {
  input_of(window).add({.kind = Kind::move, .x = float(x), .y = float(y)});
}

void on_scroll(GLFWwindow* window, double x, double y) {
  input_of(window).add({.kind = Kind::scroll, .x = float(x), .y = float(y)});
}

void on_drop(GLFWwindow* window, int count, const char** files) {
  WindowEvent event = made(Kind::drop, window, 0);
  for (int i = 0; i < count; ++i) event.files.emplace_back(files[i]);
  input_of(window).add(std::move(event));
}

}  // namespace

WindowInput::WindowInput(GLFWwindow* window) {
  glfwSetWindowUserPointer(window, this);
  glfwSetKeyCallback(window, on_key);
  glfwSetMouseButtonCallback(window, on_button);
  glfwSetCursorPosCallback(window, on_move);
  glfwSetScrollCallback(window, on_scroll);
  glfwSetDropCallback(window, on_drop);
}

}  // namespace ecorche
