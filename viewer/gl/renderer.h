// Draw list -> picture, by OpenGL 3.3 without a display: EGL surfaceless, else OSMesa.
//
// Linear light, one soft-edged shadow map, ambient occlusion of the screen, supersampled edges,
// thin lines between parts. The same list gives the same bytes on the same driver.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "viewer/draw_list.h"
#include "viewer/image.h"

namespace ecorche {

struct RenderOptions {
  // samples a pixel in x and in y, 1..4; lowered by itself where the picture is very large
  int supersample = 2;
  int shadow_size = 2048;  // texels a side of the shadow map; 0: no shadows
  bool ambient_occlusion =
      true;               // of the screen; costs about 40 ms at 1280x720 on a software driver
  float outline = 0.35f;  // darkness of the line between neighbouring parts, 0..1
  // for what moves: plain flesh and ground, no shadows
  bool quick = false;
  // of the picture, from the left, the columns that are drawn, others keep what they had; 0: all
  int first_column = 0, columns = 0;
  // neither ground nor background; the picture's fourth byte says how much the figure covers
  bool transparent = false;
};

class Renderer {
 public:
  using GetProc = void* (*)(const char*);

  // Makes its own context. Throws OutputError that names the attempts and the package to install.
  explicit Renderer(RenderOptions options = {});
  // Draws with the context that is current in this thread (a window's).
  Renderer(RenderOptions options, GetProc get_proc);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  RenderOptions& options();

  // Call from the thread that made the renderer. Throws UsageError for sizes below 1, LimitError
  // above 16384 or what the driver can do, std::invalid_argument for arrays of unequal length or
  // indices out of range.
  Image render(const DrawList& list, int width, int height);

  // The same into a framebuffer of the current context, its origin at the lower left.
  void render_to(const DrawList& list, int width, int height, unsigned framebuffer);

  // Parts of the picture drawn last, top row first, 0 where there is none. #pixels
  std::vector<std::uint32_t> parts();
  // The part at one pixel of it, top left (0, 0); 0 outside. The bound framebuffer stays bound.
  std::uint32_t part_at(int x, int y);

  // "EGL surfaceless, llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5"
  const std::string& driver() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
