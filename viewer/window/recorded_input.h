// A session at the window that is played from a text, for tests and pictures: one step a line, #
// before remarks.
//
//   click PLACE            press and release; PLACE: a name that the panels give to what they show,
//                          or X,Y as shares of the window
//   drag PLACE DX,DY       press, move by so many pixels, release
//   type TEXT              into the field that was clicked
//   key Ctrl + Z           as the list of keys names it
//   turn DX,DY             drag the view by so many pixels, a pixel a frame
//   frames N               let so many frames go by
//   wait                   until nothing runs in the background
//   drop FILE              into the window, as from another program
//   close                  as the window's own button does it; what may keep it open is asked
//   picture FILE.png       of the window, panels included
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "viewer/window/view_document.h"
#include "viewer/window/window_event.h"

namespace ecorche {

class RecordedInput {
 public:
  // Throws InputError that names file and line.
  explicit RecordedInput(const std::filesystem::path& file);

  // What happens in the next frame, for us and for ImGui, which reads it in its NewFrame. Throws
  // InputError for a place that is not shown.
  std::vector<WindowEvent> next(ViewDocument& document, float width, float height);
  bool waits() const { return !ended() && moves_[at_].kind == Move::Kind::wait; }
  bool ended() const { return at_ == moves_.size(); }
  // A picture that the last frame is wanted as; empty: none.
  std::filesystem::path take_picture();

 private:
  struct Move {
    enum class Kind {
      aim,
      shift,
      press,
      release,
      type,
      key,
      pass,
      wait,
      drop,
      close,
      say,
      picture
    } kind{};
    std::string text{};
    float dx = 0, dy = 0;
    std::string where{};
  };
  void add_drag(const std::string& place, float dx, float dy, int steps, const std::string& where);

  std::vector<Move> moves_;
  std::size_t at_ = 0;
  float x_ = 0, y_ = 0;
  bool down_ = false;
  std::filesystem::path picture_;
};

}  // namespace ecorche
