#include "viewer/gl/gl_api.h"

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {

GlApi load_gl(void* (*get_proc)(const char*)) {
  GlApi gl;
#define ECORCHE_GL(TYPE, NAME)                             \
  gl.NAME = reinterpret_cast<TYPE>(get_proc("gl" #NAME));  \
  if (!gl.NAME)                                            \
    throw OutputError("OpenGL: the driver has no gl" #NAME \
                      "; a driver of version 3.3 or newer is needed (libgl1-mesa-dri)");
#include "viewer/gl/gl_functions.inc"
#undef ECORCHE_GL
  return gl;
}

}  // namespace ecorche
