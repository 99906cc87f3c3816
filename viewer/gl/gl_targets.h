// Render targets: framebuffers with textures.
#pragma once

#include <utility>
#include <vector>

#include "viewer/gl/gl_api.h"

namespace ecorche {

// A framebuffer with textures of one size; recreated when the size changes.
class GlTarget {
 public:
  // Internal formats of the colour attachments in order; depth as a texture if asked for.
  GlTarget(const GlApi& gl, std::vector<GLenum> formats, bool depth)
      : gl_(gl), formats_(std::move(formats)), has_depth_(depth) {}
  ~GlTarget() { release(); }
  GlTarget(const GlTarget&) = delete;
  GlTarget& operator=(const GlTarget&) = delete;

  // Throws LimitError if the driver cannot make it.
  void resize(int width, int height);
  // Binds it, with the first `count` colour attachments to draw into (all if negative), and sets
  // the viewport.
  void bind(int count = -1) const;
  GLuint framebuffer() const { return framebuffer_; }
  GLuint texture(int i) const { return textures_[i]; }
  GLuint depth() const { return depth_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  void release();
  const GlApi& gl_;
  std::vector<GLenum> formats_;
  bool has_depth_;
  std::vector<GLuint> textures_;
  GLuint framebuffer_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace ecorche
