#include "viewer/gl/gl_targets.h"

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

struct Transfer {
  GLenum format, type;
};

Transfer transfer(GLenum internal) {
  switch (internal) {
    case GL_R32UI:
      return {GL_RED_INTEGER, GL_UNSIGNED_INT};
    case GL_R8:
      return {GL_RED, GL_UNSIGNED_BYTE};
    case GL_RGBA:  // as windows have it, so that pixels are copied as they are
      return {GL_BGRA, GL_UNSIGNED_BYTE};
    case GL_RGBA16F:
      return {GL_RGBA, GL_HALF_FLOAT};
    default:
      return {GL_RGBA, GL_UNSIGNED_BYTE};
  }
}

}  // namespace

void GlTarget::release() {
  gl_.DeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
  gl_.DeleteTextures(1, &depth_);
  gl_.DeleteFramebuffers(1, &framebuffer_);
  textures_.clear();
  framebuffer_ = depth_ = 0;
}

void GlTarget::resize(int width, int height) {
  if (framebuffer_ && width == width_ && height == height_) return;
  release();
  width_ = width;
  height_ = height;
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  textures_.assign(formats_.size(), 0);
  gl_.GenTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
  auto make = [&](GLuint id, GLenum internal, GLenum format, GLenum type, GLenum attachment) {
    gl_.BindTexture(GL_TEXTURE_2D, id);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), width, height, 0, format, type,
                   nullptr);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, id, 0);
  };
  for (std::size_t i = 0; i < formats_.size(); ++i) {
    const Transfer t = transfer(formats_[i]);
    make(textures_[i], formats_[i], t.format, t.type,
         static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
  }
  if (has_depth_) {
    gl_.GenTextures(1, &depth_);
    make(depth_, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_ATTACHMENT);
  }
  bind();
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
      gl_.GetError() == GL_OUT_OF_MEMORY)
    throw LimitError(fmt::format(
        "the graphics driver cannot draw a picture of {} x {} samples; ask for a smaller one",
        width, height));
}

void GlTarget::bind(int count) const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const GLenum buffers[4] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
                             GL_COLOR_ATTACHMENT3};
  const int n = count < 0 ? int(formats_.size()) : count;
  if (n == 0) {
    gl_.DrawBuffer(GL_NONE);
  } else {
    gl_.DrawBuffers(n, buffers);
  }
  gl_.Viewport(0, 0, width_, height_);
}

}  // namespace ecorche
