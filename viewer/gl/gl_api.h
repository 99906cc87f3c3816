// The OpenGL 3.3 functions we call, fetched from whichever library made the context: EGL, OSMesa or
// a window.
//
// A loader library would bind them to EGL or GLX only, and leave OSMesa out.
#pragma once

#include <GL/glcorearb.h>

namespace ecorche {

struct GlApi {
#define ECORCHE_GL(TYPE, NAME) TYPE NAME = nullptr;
#include "viewer/gl/gl_functions.inc"
#undef ECORCHE_GL
};

// Throws OutputError naming the function that the driver lacks.
GlApi load_gl(void* (*get_proc)(const char*));

}  // namespace ecorche
