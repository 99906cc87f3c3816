#include "viewer/gl/window_copies.h"

namespace ecorche {

void keep_pixels(const GlApi& gl, const PixelBox& box, const GlTarget& store) {
  const int top = store.height() - box.y0, bottom = store.height() - box.y1;
  gl.Disable(GL_SCISSOR_TEST);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, store.framebuffer());
  gl.BlitFramebuffer(box.x0, bottom, box.x1, top, box.x0, box.y1, box.x1, box.y0,
                     GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

void put_pixels(const GlApi& gl, const PixelBox& box, const GlTarget& store) {
  const int top = store.height() - box.y0, bottom = store.height() - box.y1;
  gl.Disable(GL_SCISSOR_TEST);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, store.framebuffer());
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl.BlitFramebuffer(box.x0, box.y1, box.x1, box.y0, box.x0, bottom, box.x1, top,
                     GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace ecorche
