#include "viewer/window/recorded_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <utility>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

constexpr int kDragSteps = 12;   // frames
constexpr int kMostWait = 4000;  // frames without an end: something hangs
constexpr std::size_t kMostMoves = 100000;

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

std::optional<std::pair<float, float>> pair_of(const std::string& text) {
  float x = 0, y = 0;
  char more = 0;
  if (std::sscanf(text.c_str(), "%f,%f%c", &x, &y, &more) != 2) return std::nullopt;
  return std::pair{x, y};
}

struct NamedKey {
  const char* name;
  int key;
};
constexpr NamedKey kNamedKeys[] = {
    {"Escape", GLFW_KEY_ESCAPE},  {"Enter", GLFW_KEY_ENTER},    {"Tab", GLFW_KEY_TAB},
    {"Space", GLFW_KEY_SPACE},    {"Home", GLFW_KEY_HOME},      {"Left", GLFW_KEY_LEFT},
    {"Right", GLFW_KEY_RIGHT},    {"Up", GLFW_KEY_UP},          {"Down", GLFW_KEY_DOWN},
    {"F1", GLFW_KEY_F1},          {"F12", GLFW_KEY_F12},        {".", GLFW_KEY_PERIOD},
    {"[", GLFW_KEY_LEFT_BRACKET}, {"]", GLFW_KEY_RIGHT_BRACKET}};

// "Ctrl + Shift + Z"; key 0 where there is no such key.
WindowEvent key_of(const std::string& text) {
  WindowEvent event{.kind = WindowEvent::Kind::key};
  std::string rest = text;
  for (auto plus = rest.find(" + "); plus != std::string::npos; plus = rest.find(" + ")) {
    const std::string word = rest.substr(0, plus);
    rest = rest.substr(plus + 3);
    (word == "Ctrl" ? event.ctrl : word == "Shift" ? event.shift : event.alt) = true;
  }
  if (rest.size() == 1 && std::isalnum(static_cast<unsigned char>(rest[0])))
    event.key = std::toupper(static_cast<unsigned char>(rest[0]));  // GLFW's numbers are ASCII's
  for (const NamedKey& each : kNamedKeys)
    if (rest == each.name) event.key = each.key;
  return event;
}

}  // namespace

void RecordedInput::add_drag(const std::string& place, float dx, float dy, int steps,
                             const std::string& where) {
  using Kind = Move::Kind;
  moves_.push_back({Kind::aim, place, 0, 0, where});
  moves_.push_back({Kind::pass, {}, 0, 0, where});
  moves_.push_back({Kind::press, {}, 0, 0, where});
  for (int k = 0; k < steps; ++k)
    moves_.push_back({Kind::shift, {}, dx / float(steps), dy / float(steps), where});
  moves_.push_back({Kind::release, {}, 0, 0, where});
  moves_.push_back({Kind::pass, {}, 0, 0, where});
}

RecordedInput::RecordedInput(const std::filesystem::path& file) {
  using Kind = Move::Kind;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file.string()));
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    line = trimmed(line);
    if (line.empty() || line[0] == '#') continue;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    const std::string word = line.substr(0, line.find(' '));
    const std::string rest = trimmed(line.substr(word.size()));
    const auto fail = [&](const char* expected) {
      throw InputError(fmt::format("{}: '{}': expected {}", where, line, expected));
    };
    if (moves_.size() > kMostMoves)
      throw LimitError(fmt::format("{}: more than {} frames", where, kMostMoves));
    if (word == "click" && !rest.empty()) {
      add_drag(rest, 0, 0, 0, where);
    } else if (word == "drag") {
      const auto space = rest.rfind(' ');
      const auto by = pair_of(space == std::string::npos ? "" : rest.substr(space + 1));
      if (!by) fail("drag PLACE DX,DY");
      add_drag(trimmed(rest.substr(0, space)), by->first, by->second, kDragSteps, where);
    } else if (word == "turn") {
      const auto by = pair_of(rest);
      if (!by) fail("turn DX,DY");
      const int steps =
          int(std::clamp(std::max(std::abs(by->first), std::abs(by->second)), 1.0f, 2000.0f));
      add_drag("view", by->first, by->second, steps, where);
    } else if (word == "type" && !rest.empty()) {
      moves_.push_back({Kind::type, rest, 0, 0, where});
      moves_.push_back({Kind::pass, {}, 0, 0, where});
    } else if (word == "key") {
      if (key_of(rest).key == 0) fail("a key as the list of keys names it");
      moves_.push_back({Kind::key, rest, 0, 0, where});
      moves_.push_back({Kind::pass, {}, 0, 0, where});
    } else if (word == "frames") {
      int count = 0;
      if (std::sscanf(rest.c_str(), "%d", &count) != 1 || count < 1 || count > 10000)
        fail("frames 1 .. 10000");
      for (int k = 0; k < count; ++k) moves_.push_back({Kind::pass, {}, 0, 0, where});
    } else if (word == "wait" && rest.empty()) {
      moves_.push_back({Kind::wait, {}, 0, 0, where});
    } else if (word == "drop" && !rest.empty()) {
      moves_.push_back({Kind::drop, rest, 0, 0, where});
      moves_.push_back({Kind::pass, {}, 0, 0, where});
    } else if (word == "close" && rest.empty()) {
      moves_.push_back({Kind::close, {}, 0, 0, where});
      for (int k = 0; k < 3; ++k) moves_.push_back({Kind::pass, {}, 0, 0, where});
    } else if (word == "say" && !rest.empty()) {
      moves_.push_back({Kind::say, rest, 0, 0, where});
    } else if (word == "picture" && rest.ends_with(".png")) {
      moves_.push_back({Kind::picture, rest, 0, 0, where});
    } else {
      fail(
          "click, drag, turn, type, key, frames, wait, drop FILE, say WORDS, close or "
          "picture FILE.png");
    }
  }
}

std::filesystem::path RecordedInput::take_picture() { return std::exchange(picture_, {}); }

std::vector<WindowEvent> RecordedInput::next(ViewDocument& document, float width, float height) {
  using Kind = Move::Kind;
  ImGuiIO& io = ImGui::GetIO();
  std::vector<WindowEvent> out;
  std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
  io.KeyCtrl = io.KeyShift = io.KeyAlt = false;
  if (at_ < moves_.size()) {
    Move& move = moves_[at_];
    switch (move.kind) {
      case Kind::aim:
        if (const auto share = pair_of(move.text)) {
          x_ = share->first * width;
          y_ = share->second * height;
        } else {
          const auto found = document.places.find(move.text);
          if (found == document.places.end())
            throw InputError(
                fmt::format("{}: '{}': nothing of that name is shown", move.where, move.text));
          x_ = found->second.x();
          y_ = found->second.y();
        }
        out.push_back({.kind = WindowEvent::Kind::move, .x = x_, .y = y_});
        break;
      case Kind::shift:
        x_ += move.dx;
        y_ += move.dy;
        out.push_back({.kind = WindowEvent::Kind::move, .x = x_, .y = y_});
        break;
      case Kind::press:
      case Kind::release:
        down_ = move.kind == Kind::press;
        out.push_back({.kind = down_ ? WindowEvent::Kind::press : WindowEvent::Kind::release,
                       .x = x_,
                       .y = y_});
        break;
      case Kind::type:
        io.AddInputCharactersUTF8(move.text.c_str());
        break;
      case Kind::key: {
        const WindowEvent event = key_of(move.text);
        io.KeysDown[event.key] = true;
        io.KeyCtrl = event.ctrl;
        io.KeyShift = event.shift;
        io.KeyAlt = event.alt;
        out.push_back(event);
        break;
      }
      case Kind::wait:
        if (document.busy && ++move.dx > kMostWait)
          throw InputError(fmt::format("{}: what runs in the background does not end", move.where));
        break;
      case Kind::drop:
        out.push_back({.kind = WindowEvent::Kind::drop, .x = x_, .y = y_, .files = {move.text}});
        break;
      case Kind::close:
        document.closing = true;
        break;
      case Kind::say:
        fmt::print("{}\n", move.text);
        std::fflush(stdout);
        break;
      case Kind::picture:
        picture_ = move.text;
        break;
      case Kind::pass:
        break;
    }
    if (move.kind != Kind::wait || !document.busy) ++at_;
  }
  io.MousePos = {x_, y_};
  io.MouseDown[0] = down_;
  return out;
}

}  // namespace ecorche
