#include "viewer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <memory>

#include "anatomy/errors.h"
#include "viewer/gl_api.h"
#include "viewer/image.h"
#include "viewer/panels.h"
#include "viewer/renderer.h"

namespace ecorche {
namespace {

constexpr const char* font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr double settle_seconds = 0.25;  // after the last change the picture is drawn again, finely

void* window_proc(const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); }

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

// GLFW, its window and ImGui, in this order and back.
class Screen {
 public:
  Screen(int width, int height) {
    if (width < 1 || height < 1) throw UsageError(fmt::format("window size {}x{}: must be at least 1x1", width, height));
    if (!glfwInit())
      throw OutputError(fmt::format("no display to open a window on ({}); set DISPLAY, use 'xvfb-run ecorche view ...' (package xvfb), "
                                    "or make pictures without a window with 'ecorche render'", last_glfw_error()));
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, "Ecorche", nullptr, nullptr);
    if (!window_) {
      const std::string reason = last_glfw_error();
      glfwTerminate();
      throw OutputError(fmt::format("no window with OpenGL 3.3 ({}); install libgl1-mesa-dri, or use 'ecorche render'", reason));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    if (std::filesystem::exists(font_file)) io.Fonts->AddFontFromFileTTF(font_file, 15);
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 6;
    ImGui::GetStyle().FrameRounding = 4;
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ~Screen() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  GLFWwindow* window() const { return window_; }

 private:
  GLFWwindow* window_ = nullptr;
};

// A press that does not travel is a click.
struct Press {
  bool down = false;
  float travelled = 0;
};

void read_keys(const ViewSubject& subject, ViewDocument& document) {
  if (ImGui::GetIO().WantCaptureKeyboard) return;
  auto step = [&](int frames) {
    document.playing = false;
    const int frame = std::clamp(frame_of(subject, document) + frames, 0, subject.frames - 1);
    document.time = frame / subject.fps;
  };
  if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) document.playing = !document.playing;
  if (ImGui::IsKeyPressed(GLFW_KEY_RIGHT)) step(1);
  if (ImGui::IsKeyPressed(GLFW_KEY_LEFT)) step(-1);
  if (ImGui::IsKeyPressed(GLFW_KEY_F, false)) {
    const ViewDocument fresh;
    document.center = fresh.center;
    document.radius = fresh.radius;
  }
  if (ImGui::IsKeyPressed(GLFW_KEY_1, false)) document.azimuth = 0, document.elevation = 0;
  if (ImGui::IsKeyPressed(GLFW_KEY_3, false)) document.azimuth = 1.5708f, document.elevation = 0;
}

// True for a click into the picture.
bool read_mouse(Press& press, int height, ViewDocument& document) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse && !press.down) return false;
  if (io.MouseWheel != 0) zoom(io.MouseWheel, document);
  const bool held = io.MouseDown[0] || io.MouseDown[1] || io.MouseDown[2];
  const bool clicked = press.down && !held && press.travelled < 4;
  if (held && press.down) {
    press.travelled += std::abs(io.MouseDelta.x) + std::abs(io.MouseDelta.y);
    if (io.KeyShift || io.MouseDown[1]) {
      pan(io.MouseDelta.x, io.MouseDelta.y, height, document);
    } else {
      orbit(io.MouseDelta.x, io.MouseDelta.y, document);
    }
  }
  if (held && !press.down) press.travelled = 0;
  press.down = held;
  return clicked;
}

// Poses and draws; keeps the posed values between frames as a cache of the document's time.
class View {
 public:
  explicit View(const ViewSubject& subject) : subject_(subject), renderer_(RenderOptions{}, window_proc) {}

  const PosedAnatomy& pose(const ViewDocument& document) {
    const int frame = frame_of(subject_, document);
    if (frame != frame_) {
      subject_.pose(frame, posed_, skin_);
      muscle_shortening(subject_.model, posed_, activity_);
      frame_ = frame;
    }
    return posed_;
  }

  // Brings the subject to what is asked; true when it changed.
  bool reshape(ViewDocument& document) {
    document.asked.resize(subject_.sliders.size());
    if (!subject_.reshape || (document.asked == asked_ && !document.achieved.empty())) return false;
    subject_.reshape(document.asked, document.achieved);
    asked_ = document.asked;
    frame_ = -1;
    return true;
  }

  void draw(const ViewDocument& document, int width, int height, bool fine) {
    renderer_.options().supersample = fine ? 2 : 1;
    renderer_.options().ambient_occlusion = fine;
    renderer_.options().shadow_size = fine ? 2048 : 1024;
    update_scene(subject_.model, pose(document), skin_.positions.empty() ? nullptr : &skin_, activity_, appearance_of(document), ++revision_, scene_);
    DrawList& list = scene_.list;
    list.ground.visible = document.ground;
    list.camera = camera_of(document, posed_.X_WJ.front().translation().cast<float>(), static_cast<float>(width) / static_cast<float>(height));
    renderer_.render_to(list, width, height, 0);
  }

  std::uint32_t part_at(int x, int y) { return renderer_.part_at(x, y); }

 private:
  const ViewSubject& subject_;
  Renderer renderer_;
  Scene scene_;
  PosedAnatomy posed_;
  SkinFrame skin_;
  std::vector<float> activity_;
  std::vector<std::optional<double>> asked_;
  std::uint64_t revision_ = 0;
  int frame_ = -1;
};

Image read_window(int width, int height) {
  const GlApi gl = load_gl(window_proc);
  Image upside_down = make_image(width, height), image = make_image(width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.ReadBuffer(GL_BACK);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.rgba.data());
  for (int y = 0; y < height; ++y) std::copy_n(upside_down.pixel(0, height - 1 - y), 4 * static_cast<std::size_t>(width), image.pixel(0, y));
  return image;
}

bool same_view(const ViewDocument& a, const ViewDocument& b) {
  return a.look.skin == b.look.skin && a.look.skin_dissolved == b.look.skin_dissolved && a.look.muscles == b.look.muscles &&
         a.look.bones == b.look.bones && a.muscle_colors == b.muscle_colors && a.ground == b.ground && a.follow == b.follow &&
         a.selected == b.selected && a.time == b.time && a.center == b.center && a.radius == b.radius && a.azimuth == b.azimuth &&
         a.elevation == b.elevation;
}

}  // namespace

ViewDocument run_window(const ViewSubject& subject, const WindowOptions& options, const ViewDocument& start) {
  const Screen screen(options.width, options.height);
  View view(subject);
  ViewDocument document = start, shown = start;
  Press press;
  double changed = glfwGetTime(), clock = changed;
  for (int frame = 0; !glfwWindowShouldClose(screen.window()) && (options.frames <= 0 || frame < options.frames); ++frame) {
    const bool settled = glfwGetTime() - changed > settle_seconds;
    if (document.playing || options.frames > 0 || !settled) {
      glfwPollEvents();
    } else {
      glfwWaitEventsTimeout(0.5);
    }
    int width = 0, height = 0, window_width = 1, window_height = 1;
    glfwGetFramebufferSize(screen.window(), &width, &height);
    glfwGetWindowSize(screen.window(), &window_width, &window_height);
    const double now = glfwGetTime();
    advance(subject, options.frames > 0 ? 1.0 / 30 : now - clock, document);
    clock = now;
    if (width < 1 || height < 1) continue;  // minimised

    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    if (view.reshape(document)) changed = now;
    draw_panels(subject, view.pose(document), document);
    read_keys(subject, document);
    const bool clicked = read_mouse(press, height, document);
    if (!same_view(document, shown)) changed = now;
    shown = document;
    const bool last = options.frames > 0 && frame + 1 == options.frames;
    view.draw(document, width, height, last || now - changed > settle_seconds);
    if (clicked) {
      const ImVec2 at = ImGui::GetIO().MousePos;
      document.selected = view.part_at(static_cast<int>(at.x * width / window_width), static_cast<int>(at.y * height / window_height));
    }
    if (frame == 0 && options.pick_x >= 0 && options.pick_y >= 0)
      document.selected = view.part_at(static_cast<int>(options.pick_x * width), static_cast<int>(options.pick_y * height));
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (last && !options.screenshot.empty()) write_png(options.screenshot, read_window(width, height));
    glfwSwapBuffers(screen.window());
  }
  return document;
}

}  // namespace ecorche
