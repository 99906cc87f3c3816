// Pixels of panels that have not changed: copied from the frame before in place of drawing them
// anew. A driver without a graphics card takes a third of a frame for panels alone.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "viewer/gl/gl_api.h"
#include "viewer/gl/gl_targets.h"
#include "viewer/gl/renderer.h"
#include "viewer/gl/window_copies.h"

struct ImDrawData;

namespace ecorche {

class PanelPixels {
 public:
  explicit PanelPixels(Renderer::GetProc get_proc);

  // Draws what ImGui has made into the window's back buffer, over the figure. Panels have to be
  // opaque; tooltips, menus and whatever lies over another panel are drawn anew.
  void draw(ImDrawData& data, int width, int height);

 private:
  struct Panel {
    PixelBox box;
    std::uint64_t hash = 0;  // of all that it draws
    std::vector<int> lists;  // of the draw data
    bool passing = false;    // a tooltip, a menu
  };
  struct Kept {
    std::uint64_t hash = 0;
    bool stored = false;
  };

  std::map<std::string, Panel> panels_of(const ImDrawData& data, int width, int height) const;

  GlApi gl_;
  GlTarget store_{gl_, {GL_RGBA}, false};
  std::map<std::string, Kept> kept_;  // by the panel's name
};

}  // namespace ecorche
