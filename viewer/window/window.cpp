#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "anatomy/errors.h"
#include "viewer/gl/gl_api.h"
#include "viewer/image.h"
#include "viewer/part_names.h"
#include "viewer/window/figure_view.h"
#include "viewer/window/panel_pixels.h"
#include "viewer/window/panels.h"
#include "viewer/window/recorded_input.h"
#include "viewer/window/view_keys.h"
#include "viewer/window/window_input.h"

namespace ecorche {
namespace {

constexpr const char* font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
// Letters of 13 points at 96 dots an inch, which the font's lines exceed by what hangs below.
constexpr float letters = 21;            // pixels
constexpr double settle_seconds = 0.25;  // after the last change the picture is drawn again, finely
constexpr double idle_seconds = 0.5, busy_seconds = 0.05;

void* window_proc(const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); }

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

// Letters as large as the screen's settings ask for, where the system does not enlarge the window
// itself.
float letter_scale(GLFWwindow* window) {
  float scale = 1, ignored = 1;
  glfwGetWindowContentScale(window, &scale, &ignored);
  int pixels = 0, units = 0, unused = 0;
  glfwGetFramebufferSize(window, &pixels, &unused);
  glfwGetWindowSize(window, &units, &unused);
  return pixels == units ? std::clamp(scale, 1.0f, 4.0f) : 1.0f;
}

// GLFW, its window, who listens to it, and ImGui, in this order and back.
class Screen {
 public:
  Screen(int width, int height) {
    if (width < 1 || height < 1)
      throw UsageError(fmt::format("window size {}x{}: must be at least 1x1", width, height));
    if (!glfwInit())
      throw OutputError(
          fmt::format("no display to open a window on ({}); set DISPLAY, use 'xvfb-run ecorche "
                      "view ...' (package xvfb), "
                      "or make pictures without a window with 'ecorche render'",
                      last_glfw_error()));
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, "Ecorche", nullptr, nullptr);
    if (!window_) {
      const std::string reason = last_glfw_error();
      glfwTerminate();
      throw OutputError(fmt::format(
          "no window with OpenGL 3.3 ({}); install libgl1-mesa-dri, or use 'ecorche render'",
          reason));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    input_ = std::make_unique<WindowInput>(window_);
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    const float scale = letter_scale(window_);
    if (std::filesystem::exists(font_file))
      io.Fonts->AddFontFromFileTTF(font_file, std::round(scale * letters));
    ImGui::StyleColorsDark();
    ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 1;  // nothing is drawn behind a panel
    ImGui::GetStyle().WindowRounding = 6;
    ImGui::GetStyle().FrameRounding = 4;
    ImGui::GetStyle().ScaleAllSizes(scale);
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
  WindowInput& input() const { return *input_; }

 private:
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<WindowInput> input_;
};

Image read_window(int width, int height) {
  const GlApi gl = load_gl(window_proc);
  Image upside_down = make_image(width, height), image = make_image(width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.ReadBuffer(GL_BACK);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.rgba.data());
  for (int y = 0; y < height; ++y)
    std::copy_n(upside_down.pixel(0, height - 1 - y), 4 * std::size_t(width), image.pixel(0, y));
  return image;
}

// Over the rooms of organs in a cut.
void write_names(const std::vector<FacePlace>& places, const Anatomy& anatomy,
                 const ViewProjection& view) {
  constexpr float least = 2e-3f;  // m^2
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (const FacePlace& place : places) {
    const auto at = view.pixel(place.middle);
    if (!at || place.area < least) continue;
    const std::string label = part_label(anatomy, place.part);
    const ImVec2 size = ImGui::CalcTextSize(label.c_str());
    const ImVec2 from(at->x() - 0.5f * size.x, at->y() - 0.5f * size.y);
    list.AddRectFilled({from.x - 4, from.y - 2}, {from.x + size.x + 4, from.y + size.y + 2},
                       IM_COL32(20, 20, 24, 190), 4);
    list.AddText(from, IM_COL32(255, 255, 255, 255), label.c_str());
  }
}

// Into the folder that the program was started in, under a name that is free.
void take_picture(int width, int height, ViewDocument& document) {
  document.wants_picture = false;
  constexpr int most = 9999;
  for (int number = 1; number <= most; ++number) {
    const std::filesystem::path file = fmt::format("ecorche-{:04}.png", number);
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) continue;
    try {
      write_png(file, read_window(width, height));
      document.message = fmt::format("picture: {}", std::filesystem::absolute(file).string());
    } catch (const OutputError& error) {
      document.message = error.what();
    }
    return;
  }
  document.message =
      "no name is free for a picture: ecorche-0001.png to ecorche-9999.png are there";
}

struct Point {
  float x = 0, y = 0;
};

// A press that does not travel is a click.
struct Mouse {
  bool down = false;
  float travelled = 0;
  Point at;
  int button = 0;
};

// Turns, moves, and hands back where a click fell. Presses on a panel are the panel's.
std::optional<Point> read_mouse(const WindowEvent& event, float height, Mouse& mouse,
                                ViewDocument& document) {
  using Kind = WindowEvent::Kind;
  constexpr float click = 4;  // pixels
  const ImGuiIO& io = ImGui::GetIO();
  const Point from = mouse.at;
  if (event.kind == Kind::scroll && !io.WantCaptureMouse) zoom(event.y, document);
  if (event.kind == Kind::scroll || event.kind == Kind::drop) return std::nullopt;
  mouse.at = {event.x, event.y};
  if (event.kind == Kind::press && !io.WantCaptureMouse) mouse = {true, 0, mouse.at, event.key};
  if (event.kind == Kind::release && mouse.down && event.key == mouse.button) {
    mouse.down = false;
    if (mouse.travelled < click && mouse.button == GLFW_MOUSE_BUTTON_LEFT) return mouse.at;
  }
  if (event.kind != Kind::move || !mouse.down) return std::nullopt;
  const float dx = event.x - from.x, dy = event.y - from.y;
  mouse.travelled += std::abs(dx) + std::abs(dy);
  if (mouse.travelled < click) return std::nullopt;
  if (io.KeyShift || mouse.button == GLFW_MOUSE_BUTTON_RIGHT)
    pan(dx, dy, height, document);
  else
    orbit(dx, dy, document);
  return std::nullopt;
}

void read_key(const WindowEvent& event, const ViewSubject& subject, const PosedAnatomy& posed,
              ViewDocument& document) {
  if (ImGui::GetIO().WantTextInput) return;
  if (event.key == GLFW_KEY_ESCAPE &&
      (document.help || document.asking != ViewDocument::Asking::nothing)) {
    document.help = false;
    document.asking = ViewDocument::Asking::nothing;
    return;
  }
  const auto action = action_of(event.key, event.ctrl, event.shift, event.alt);
  if (action) act(*action, subject, posed, document);
}

bool same_view(const ViewDocument& a, const ViewDocument& b) {
  return a.look.skin == b.look.skin && a.look.skin_dissolved == b.look.skin_dissolved &&
         a.look.muscles == b.look.muscles && a.look.bones == b.look.bones &&
         a.muscle_colors == b.muscle_colors && a.ground == b.ground && a.follow == b.follow &&
         a.selected == b.selected && a.hidden == b.hidden && a.time == b.time &&
         a.center == b.center && a.radius == b.radius && a.azimuth == b.azimuth &&
         a.elevation == b.elevation && a.parallel == b.parallel && a.section == b.section &&
         a.touched == b.touched;
}

bool same_room(const ViewRoom& a, const ViewRoom& b) {
  return a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height;
}

// The loop's memory from one frame to the next.
struct Session {
  const ViewSubject& subject;
  const WindowTool& tool;
  const WindowOptions& options;
  Screen& screen;
  FigureView view;
  PanelPixels panels;
  ViewDocument document, shown;
  std::optional<RecordedInput> recorded{};
  // another figure beside it, drawn by a view of its own
  const ViewSubject* beside_of = nullptr;
  WindowTool beside_tool{};
  std::unique_ptr<FigureView> beside{};
  Mouse mouse{};
  ViewRoom room{};
  ViewProjection projection{};  // of the frame before
  std::vector<WindowEvent> events{};
  std::uint64_t framed_revision = ~std::uint64_t{0};
  double changed = glfwGetTime(), clock = changed;

  bool is_last(int frame) const { return options.frames > 0 && frame + 1 == options.frames; }
  bool goes_on(int frame);
  bool is_settled() const { return glfwGetTime() - changed > settle_seconds; }
  void wait_for_events() const;
  void read_events(float width, float height);
  std::optional<Point> take_input(const PosedAnatomy& posed, float height);
  void frame_view(const ViewRoom& now, bool jumped);
  struct Halves {
    ViewRoom own, other;        // what is seen of each
    ViewRoom own_view, camera;  // that the cameras fill
  };
  Halves halves_of(const ViewRoom& whole, const FigureBeside& figure) const;
  void take_beside(const FigureBeside& figure);
  void show(int frame, int width, int height, Point unit);
};

// What is not saved may keep a window open that a person closes.
bool Session::goes_on(int frame) {
  if (options.frames > 0 && frame >= options.frames) return false;
  if (recorded && recorded->ended()) return false;
  const bool asked = document.closing || glfwWindowShouldClose(screen.window());
  if (!asked) return true;
  if (!tool.may_close || tool.may_close()) return false;
  document.closing = false;
  glfwSetWindowShouldClose(screen.window(), GLFW_FALSE);
  return true;
}

void Session::wait_for_events() const {
  const bool waits = recorded && recorded->waits() && document.busy;
  if (!waits && (document.playing || options.frames > 0 || recorded || !is_settled()))
    glfwPollEvents();
  else
    glfwWaitEventsTimeout(document.busy ? busy_seconds : idle_seconds);
}

void Session::read_events(float width, float height) {
  events = screen.input().take();
  if (recorded) events = recorded->next(document, width, height);
  document.places.clear();
}

// Keys first change the document, the mouse after them; the last click counts.
std::optional<Point> Session::take_input(const PosedAnatomy& posed, float height) {
  std::optional<Point> clicked;
  for (const WindowEvent& event : events) {
    if (tool.take && tool.take(event, projection, document)) continue;
    if (event.kind == WindowEvent::Kind::key)
      read_key(event, subject, posed, document);
    else if (event.kind == WindowEvent::Kind::drop && subject.open && !event.files.empty())
      subject.open(event.files.front());
    else if (const auto at = read_mouse(event, height, mouse, document))
      clicked = at;
  }
  return clicked;
}

// The figure stays in its room when either changes, or the eye leaps to another side of it.
void Session::frame_view(const ViewRoom& now, bool jumped) {
  const bool again = jumped || !shown.framed || shown.parallel != document.parallel ||
                     framed_revision != subject.revision || !same_room(room, now);
  if (document.framed && again) frame_figure(subject, now, document);
  framed_revision = subject.revision;
  room = now;
}

Session::Halves Session::halves_of(const ViewRoom& whole, const FigureBeside& figure) const {
  if (!figure.subject) return {whole, whole, whole, whole};
  const float left = whole.width * (figure.wiped ? std::clamp(figure.share, 0.0f, 1.0f) : 0.5f);
  ViewRoom own = whole, other = whole;
  own.width = left;
  other.x += left;
  other.width -= left;
  own.alone = other.alone = true;
  if (figure.wiped) return {own, other, whole, whole};
  return {own, other, own, other};
}

void Session::take_beside(const FigureBeside& figure) {
  if (figure.subject == beside_of) return;
  beside_of = figure.subject;
  beside.reset();
  beside_tool = {};
  beside_tool.dress = tool.dress_beside;
  if (beside_of) beside = std::make_unique<FigureView>(*beside_of, beside_tool, window_proc);
}

void Session::show(int frame, int width, int height, Point unit) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  const double began = glfwGetTime();
  read_events(float(width) / unit.x, float(height) / unit.y);
  ImGui::NewFrame();
  const PosedAnatomy& posed = view.pose(document);
  const float azimuth = document.azimuth, elevation = document.elevation;
  const ViewRoom whole =
      tool.panels ? tool.panels(posed, document) : draw_panels(subject, posed, document);
  const FigureBeside figure = tool.beside ? tool.beside() : FigureBeside{};
  take_beside(figure);
  const Halves halves = halves_of(whole, figure);
  const ViewRoom now = halves.own_view;
  if (document.recorded)
    document.places["view"] = {now.x + 0.5f * now.width, now.y + 0.9f * now.height};
  const float turned = document.azimuth, tilted = document.elevation;
  auto clicked = take_input(posed, now.height);
  if (figure.subject && clicked && clicked->x > halves.other.x) clicked.reset();
  const bool dragged = mouse.down && mouse.travelled > 0;
  frame_view(now, azimuth != turned || elevation != tilted ||
                      (!dragged && (document.azimuth != turned || document.elevation != tilted)));
  if (!same_view(document, shown)) changed = glfwGetTime();
  shown = document;
  const std::filesystem::path wanted =
      recorded ? recorded->take_picture() : std::filesystem::path();
  const float window_width = float(width) / unit.x, window_height = float(height) / unit.y;
  const Camera camera = view.camera(document, room, window_width, window_height);
  projection = ViewProjection(camera, window_width, window_height);
  if (tool.draw_over) tool.draw_over(view.pose(document), projection, document);
  const bool pictured = is_last(frame) || document.wants_picture || !wanted.empty();
  const FigureView::Wish wish = pictured                    ? FigureView::Wish::finest
                                : !recorded && is_settled() ? FigureView::Wish::still
                                                            : FigureView::Wish::moving;
  view.draw(document, camera, {width, height, unit.x, figure.subject ? halves.own : room}, wish);
  if (beside)
    beside->draw(document, beside->camera(document, halves.camera, window_width, window_height),
                 {width, height, unit.x, halves.other, true}, wish);
  write_names(view.cut_rooms(), *subject.anatomy, projection);
  if (clicked) document.selected = view.part_at(clicked->x * unit.x, clicked->y * unit.y);
  if (clicked && tool.picked) tool.picked(document.selected);
  if (frame == 0 && options.pick_x >= 0 && options.pick_y >= 0)
    document.selected = view.part_at(float(options.pick_x * width), float(options.pick_y * height));
  if (document.wants_picture) take_picture(width, height, document);
  ImGui::Render();
  panels.draw(*ImGui::GetDrawData(), width, height);
  if (is_last(frame) && !options.screenshot.empty())
    write_png(options.screenshot, read_window(width, height));
  if (!wanted.empty()) write_png(wanted, read_window(width, height));
  glfwSwapBuffers(screen.window());
  view.took(glfwGetTime() - began);
  if (beside) beside->took(glfwGetTime() - began);
  // A picture of a session is drawn as finely as can be, which a person never waits for.
  if (tool.shown && wanted.empty()) tool.shown(began, glfwGetTime() - began, document);
}

}  // namespace

ViewDocument run_window(const ViewSubject& subject, const WindowOptions& options,
                        const ViewDocument& start, const WindowTool& tool) {
  std::optional<RecordedInput> recorded;
  if (!options.input.empty()) recorded.emplace(options.input);
  Screen screen(options.width, options.height);
  Session session{.subject = subject,
                  .tool = tool,
                  .options = options,
                  .screen = screen,
                  .view{subject, tool, window_proc},
                  .panels = PanelPixels(window_proc),
                  .document = start,
                  .shown = start,
                  .recorded = std::move(recorded)};
  session.document.closing = false;  // what another window ended with may be shown again
  session.document.recorded = session.recorded.has_value();
  std::string title;
  for (int frame = 0; session.goes_on(frame); ++frame) {
    session.wait_for_events();
    int width = 0, height = 0, window_width = 1, window_height = 1;
    glfwGetFramebufferSize(screen.window(), &width, &height);
    glfwGetWindowSize(screen.window(), &window_width, &window_height);
    if (subject.update) subject.update(session.document, session.is_last(frame));
    const double now = glfwGetTime();
    advance(subject, options.frames > 0 ? 1.0 / 30 : now - session.clock, session.document);
    session.clock = now;
    if (width < 1 || height < 1) continue;  // minimised
    if (title != subject.name)
      glfwSetWindowTitle(screen.window(), ("Ecorche: " + subject.name).c_str());
    title = subject.name;
    session.show(frame, width, height,
                 {float(width) / float(window_width), float(height) / float(window_height)});
  }
  return session.document;
}

}  // namespace ecorche
