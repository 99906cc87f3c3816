#include "viewer/gl/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <map>
#include <string_view>

#include "anatomy/errors.h"
#include "viewer/gl/gl_probe.h"

namespace ecorche {
namespace {

// Both libraries are opened at run time: the program starts, and does all that needs no pictures,
// on a machine without them.
void* open_library(const char* name) {
  void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!library) throw OutputError(fmt::format("{} is missing", name));
  return library;
}

template <typename Function>
Function* symbol(void* library, const char* name) {
  auto* function = reinterpret_cast<Function*>(dlsym(library, name));
  if (!function) throw OutputError(fmt::format("no {} in the library", name));
  return function;
}

struct Egl {
  void* library = open_library("libEGL.so.1");
  decltype(&eglGetProcAddress) get_proc =
      symbol<decltype(eglGetProcAddress)>(library, "eglGetProcAddress");
  decltype(&eglQueryString) query_string =
      symbol<decltype(eglQueryString)>(library, "eglQueryString");
  decltype(&eglGetDisplay) get_display = symbol<decltype(eglGetDisplay)>(library, "eglGetDisplay");
  decltype(&eglInitialize) initialize = symbol<decltype(eglInitialize)>(library, "eglInitialize");
  decltype(&eglBindAPI) bind_api = symbol<decltype(eglBindAPI)>(library, "eglBindAPI");
  decltype(&eglChooseConfig) choose_config =
      symbol<decltype(eglChooseConfig)>(library, "eglChooseConfig");
  decltype(&eglCreateContext) create_context =
      symbol<decltype(eglCreateContext)>(library, "eglCreateContext");
  decltype(&eglCreatePbufferSurface) create_pbuffer =
      symbol<decltype(eglCreatePbufferSurface)>(library, "eglCreatePbufferSurface");
  decltype(&eglMakeCurrent) make_current =
      symbol<decltype(eglMakeCurrent)>(library, "eglMakeCurrent");
  decltype(&eglDestroyContext) destroy_context =
      symbol<decltype(eglDestroyContext)>(library, "eglDestroyContext");
  decltype(&eglDestroySurface) destroy_surface =
      symbol<decltype(eglDestroySurface)>(library, "eglDestroySurface");
  decltype(&eglGetError) get_error = symbol<decltype(eglGetError)>(library, "eglGetError");
};

const Egl& egl() {
  static const Egl functions;
  return functions;
}

void* egl_proc(const char* name) { return reinterpret_cast<void*>(egl().get_proc(name)); }

class EglContext : public GlContext {
 public:
  explicit EglContext(bool pbuffer) : pbuffer_(pbuffer) {
    display_ = pbuffer ? egl().get_display(EGL_DEFAULT_DISPLAY) : surfaceless_display();
    if (display_ == EGL_NO_DISPLAY || !egl().initialize(display_, nullptr, nullptr))
      fail("no display could be initialised");
    const EGLint wanted[] = {EGL_SURFACE_TYPE, pbuffer ? EGL_PBUFFER_BIT : 0, EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!egl().choose_config(display_, wanted, &config, 1, &count) || count == 0)
      fail("no configuration for OpenGL");
    if (!egl().bind_api(EGL_OPENGL_API)) fail("no desktop OpenGL");
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    context_ = egl().create_context(display_, config, EGL_NO_CONTEXT, version);
    if (context_ == EGL_NO_CONTEXT) fail("no OpenGL 3.3 core context");
    if (pbuffer) {
      const EGLint size[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
      surface_ = egl().create_pbuffer(display_, config, size);
      if (surface_ == EGL_NO_SURFACE) fail("no pbuffer");
    }
    if (!egl().make_current(display_, surface_, surface_, context_))
      fail("the context cannot be made current");
  }

  ~EglContext() override { release(); }

  GetProc get_proc() const override { return egl_proc; }
  void make_current() override { egl().make_current(display_, surface_, surface_, context_); }
  std::string kind() const override { return pbuffer_ ? "EGL pbuffer" : "EGL surfaceless"; }

 private:
  static EGLDisplay surfaceless_display() {
    const char* extensions = egl().query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!extensions || std::string_view(extensions).find("EGL_MESA_platform_surfaceless") ==
                           std::string_view::npos)
      return EGL_NO_DISPLAY;
    const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        egl().get_proc("eglGetPlatformDisplayEXT"));
    return get ? get(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr) : EGL_NO_DISPLAY;
  }
  void fail(const char* what) {
    const int code = egl().get_error();
    release();
    throw OutputError(fmt::format("{} (EGL error {:#x})", what, code));
  }
  // The display stays initialised: it is the process's, and another context may live on it.
  void release() {
    if (display_ == EGL_NO_DISPLAY) return;
    egl().make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface_ != EGL_NO_SURFACE) egl().destroy_surface(display_, surface_);
    if (context_ != EGL_NO_CONTEXT) egl().destroy_context(display_, context_);
    surface_ = EGL_NO_SURFACE;
    context_ = EGL_NO_CONTEXT;
  }

  bool pbuffer_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
};

struct OsMesa {
  void* library = open_library("libOSMesa.so.8");
  decltype(&OSMesaGetProcAddress) get_proc =
      symbol<decltype(OSMesaGetProcAddress)>(library, "OSMesaGetProcAddress");
  decltype(&OSMesaCreateContextAttribs) create =
      symbol<decltype(OSMesaCreateContextAttribs)>(library, "OSMesaCreateContextAttribs");
  decltype(&OSMesaMakeCurrent) make_current =
      symbol<decltype(OSMesaMakeCurrent)>(library, "OSMesaMakeCurrent");
  decltype(&OSMesaDestroyContext) destroy =
      symbol<decltype(OSMesaDestroyContext)>(library, "OSMesaDestroyContext");
};

const OsMesa& osmesa() {
  static const OsMesa functions;
  return functions;
}

void* osmesa_proc(const char* name) { return reinterpret_cast<void*>(osmesa().get_proc(name)); }

class OsMesaContext : public GlContext {
 public:
  OsMesaContext() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              24,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = osmesa().create(attributes, nullptr);
    if (!context_) throw OutputError("no OpenGL 3.3 core context");
    make_current();
  }
  ~OsMesaContext() override {
    osmesa().make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
    osmesa().destroy(context_);
  }

  GetProc get_proc() const override { return osmesa_proc; }
  void make_current() override {
    osmesa().make_current(context_, pixels_.data(), GL_UNSIGNED_BYTE, side, side);
  }
  std::string kind() const override { return "OSMesa"; }

 private:
  static constexpr int side = 16;  // we draw into framebuffers of our own
  std::array<unsigned char, 4 * side * side> pixels_{};
  OSMesaContext context_ = nullptr;
};

struct Way {
  std::string_view name;
  std::unique_ptr<GlContext> (*make)();
};

constexpr Way ways[] = {
    {"egl", []() -> std::unique_ptr<GlContext> { return std::make_unique<EglContext>(false); }},
    {"pbuffer", []() -> std::unique_ptr<GlContext> { return std::make_unique<EglContext>(true); }},
    {"osmesa", []() -> std::unique_ptr<GlContext> { return std::make_unique<OsMesaContext>(); }},
};

// Why a way leads nowhere; empty where it does not. Asked once a process, before the first context:
// later a copy of the process would lack the driver's threads.
const std::string& fault_of(const Way& way) {
  static std::map<std::string_view, std::string> faults;
  const auto [known, fresh] = faults.try_emplace(way.name);
  if (fresh) known->second = failure_in_child([&way] { way.make(); });
  return known->second;
}

}  // namespace

std::unique_ptr<GlContext> make_headless_context() {
  const char* asked = std::getenv("ECORCHE_GL");
  const std::string_view only = asked ? asked : "";
  std::string reasons;
  for (const Way& way : ways) {
    if (!only.empty() && only != way.name) continue;
    std::string fault = fault_of(way);
    if (fault.empty()) try {
        return way.make();
      } catch (const OutputError& error) {
        fault = error.what();
      }
    reasons += fmt::format("\n  {}: {}", way.name, fault);
  }
  if (reasons.empty())
    throw UsageError(fmt::format("ECORCHE_GL={}: unknown; expected egl, pbuffer or osmesa", only));
  throw OutputError(fmt::format(
      "no OpenGL context for drawing; install libegl1 and libgl1-mesa-dri, or libosmesa6:{}",
      reasons));
}

}  // namespace ecorche
