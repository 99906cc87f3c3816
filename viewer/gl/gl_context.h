// An OpenGL context without a display.
#pragma once

#include <memory>
#include <string>

namespace ecorche {

class GlContext {
 public:
  virtual ~GlContext() = default;
  using GetProc = void* (*)(const char*);
  virtual GetProc get_proc() const = 0;
  virtual void make_current() = 0;
  virtual std::string kind() const = 0;  // "EGL surfaceless"
};

// Tries EGL surfaceless, EGL with a pbuffer, OSMesa, in this order; ECORCHE_GL=egl|pbuffer|osmesa
// asks for one of them. The context is current in this thread. Throws OutputError with the reason
// of each that failed.
std::unique_ptr<GlContext> make_headless_context();

}  // namespace ecorche
