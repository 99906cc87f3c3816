// The window under a virtual display: it shows, picks and closes by itself.
#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <thread>
#include <tuple>

#include "anatomy/errors.h"
#include "viewer/window/file_panel.h"
#include "viewer/window/panels.h"
#include "viewer/window/view_keys.h"

#ifdef ECORCHE_X11
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>
#endif

namespace ecorche {
namespace {

// One joint that carries one bone, a block of 0.4 m.
Anatomy block() {
  Anatomy a;
  a.skeleton.joints.resize(1);
  a.skeleton.joints[0].name = "pelvis";
  a.skeleton.joints[0].X_PJ.translation() = Vec3(0, 0.9, 0);
  Bone bone{"hip_bone_l", Side::left, 0, {}};
  bone.mesh.V.resize(8, 3);
  for (int k = 0; k < 8; ++k)
    bone.mesh.V.row(k) << (k & 1 ? 0.2 : -0.2), 0.9 + (k & 2 ? 0.2 : -0.2), (k & 4 ? 0.2 : -0.2);
  bone.mesh.F.resize(12, 3);
  bone.mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2,
      4, 6, 1, 3, 5, 3, 7, 5;
  a.bones.push_back(bone);
  return a;
}

ViewSubject look_at(const Anatomy& a, const SceneModel& model,
                    std::chrono::milliseconds slow = {}) {
  ViewSubject subject{.anatomy = &a, .model = &model, .frames = 10, .fps = 30};
  subject.pose = [&a, slow](int frame, PosedAnatomy& posed, SkinFrame&) {
    std::this_thread::sleep_for(slow);
    Pose pose = rest_pose(a.skeleton);
    pose.root.z() += 0.01 * frame;
    forward_kinematics(a.skeleton, pose, posed.X_WJ);
  };
  subject.bounds = {Vec3f(-0.2f, 0.7f, -0.2f), Vec3f(0.2f, 1.1f, 0.2f)};
  return subject;
}

// Red, green, blue of a PNG file that we wrote, without decoding: the pictures themselves are
// compared.
std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class WindowTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no display; run under xvfb-run";
    folder_ = std::filesystem::temp_directory_path() / fmt::format("ecorche_window_{}", ::getpid());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }
  std::filesystem::path folder_;
};

TEST_F(WindowTest, shows_picks_and_takes_a_picture) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  const std::filesystem::path picture = folder_ / "window.png";
  ViewDocument start;
  start.playing = true;
  // The figure's room is to the right of the panels; in a window as small as this, all of it.
  const ViewDocument end = run_window(look_at(a, model),
                                      {.width = 320,
                                       .height = 480,
                                       .frames = 4,
                                       .screenshot = picture,
                                       .pick_x = 0.5,
                                       .pick_y = 0.42},
                                      start);
  EXPECT_EQ(part_of(end.selected).kind, Part::Kind::bone);
  EXPECT_NEAR(end.time, 4.0 / 30, 1e-6);
  EXPECT_EQ(bytes_of(picture).substr(0, 8), "\x89PNG\r\n\x1a\n");
}

TEST_F(WindowTest, a_click_leaves_the_panels_where_they_are) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  run_window(look_at(a, model), {.width = 640,
                                 .height = 480,
                                 .frames = 1,
                                 .screenshot = folder_ / "clicked.png",
                                 .pick_x = 0.99,
                                 .pick_y = 0.01});
  run_window(look_at(a, model),
             {.width = 640, .height = 480, .frames = 1, .screenshot = folder_ / "left_alone.png"});
  EXPECT_EQ(bytes_of(folder_ / "clicked.png"), bytes_of(folder_ / "left_alone.png"))
      << "nothing lies there: nothing is picked, nothing changes";
}

#ifdef ECORCHE_X11
// What a person does, sent to our window by another client of the display.
class Hands {
 public:
  Hands() {
    XSetErrorHandler([](Display*, XErrorEvent*) {
      return 0;
    });  // a window may close between a key's way down and up
    for (int tries = 0; tries < 400 && !window_; ++tries) {
      if (display_) window_ = find(DefaultRootWindow(display_));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  ~Hands() {
    if (display_) XCloseDisplay(display_);
  }
  bool ready() const { return window_ != 0; }
  // Down and up in one breath.
  void tap(KeySym symbol, unsigned state = 0) const {
    XEvent event = begun<XKeyEvent>(1, 1);
    event.xkey.state = state;
    event.xkey.keycode = XKeysymToKeycode(display_, symbol);
    send(event, KeyPress, KeyPressMask);
    send(event, KeyRelease, KeyReleaseMask);
  }
  void click(int x, int y) const {
    XWarpPointer(display_, None, window_, 0, 0, 0, 0, x, y);
    send(begun<XMotionEvent>(x, y), MotionNotify, PointerMotionMask);
    XEvent event = begun<XButtonEvent>(x, y);
    event.xbutton.button = 1;
    send(event, ButtonPress, ButtonPressMask);
    send(event, ButtonRelease, ButtonReleaseMask);
  }

 private:
  // Keys, buttons and motions begin alike.
  template <class Event>
  XEvent begun(int x, int y) const {
    XEvent event{};
    Event& e = reinterpret_cast<Event&>(event);
    e.display = display_;
    e.window = window_;
    e.root = DefaultRootWindow(display_);
    e.time = CurrentTime;
    e.x = x;
    e.y = y;
    e.same_screen = True;
    return event;
  }
  void send(XEvent event, int type, long mask) const {
    event.type = type;
    XSendEvent(display_, window_, True, mask, &event);
    XFlush(display_);
  }
  Window find(Window at) const {
    char* name = nullptr;
    if (XFetchName(display_, at, &name) && name) {
      const bool ours = std::string_view(name).starts_with("Ecorche");
      XFree(name);
      if (ours) return at;
    }
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    if (!XQueryTree(display_, at, &root, &parent, &children, &count)) return 0;
    for (unsigned i = 0; i < count && !found; ++i) found = find(children[i]);
    if (children) XFree(children);
    return found;
  }
  Display* display_ = XOpenDisplay(nullptr);
  Window window_ = 0;
};

// Shows while another thread has its hands on the window, and closes it; it closes by itself should
// they fail.
template <class Act>
ViewDocument with_hands(ViewSubject subject, const ViewDocument& start, const Act& act) {
  const WindowOptions options{.width = 320, .height = 240, .frames = 3000};
  subject.update = [](ViewDocument&, bool) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  std::jthread person([&] {
    std::this_thread::sleep_for(
        std::chrono::milliseconds(300));  // the window of before goes, ours comes
    const Hands hands;
    EXPECT_TRUE(hands.ready());
    if (!hands.ready()) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    act(hands);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    hands.tap(XK_q, ControlMask);
  });
  return run_window(subject, options, start);
}

TEST_F(WindowTest, a_short_tap_counts_however_long_a_frame_takes) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  ViewDocument start;
  start.playing = true;  // so that each frame is posed, slowly
  start.panels = false;
  // Layers: skin once, bones twice; a view; pause.
  const ViewDocument end =
      with_hands(look_at(a, model, std::chrono::milliseconds(250)), start, [](const Hands& hands) {
        hands.tap(XK_s);
        hands.tap(XK_b);
        hands.tap(XK_b);
        hands.tap(XK_7, ControlMask);
        hands.tap(XK_space);
      });
  EXPECT_FALSE(end.playing);
  EXPECT_EQ(end.look.skin, 1);
  EXPECT_EQ(end.look.bones, 1);
  EXPECT_FLOAT_EQ(end.elevation, -std::numbers::pi_v<float> / 2);
}

TEST_F(WindowTest, clicks_pick_and_keys_hide_isolate_and_show) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  ViewDocument start;
  start.panels = false;
  const ViewDocument picked =
      with_hands(look_at(a, model), start, [](const Hands& hands) { hands.click(160, 120); });
  EXPECT_EQ(picked.selected, kFirstBonePart);
  EXPECT_EQ(picked.azimuth, start.azimuth) << "a click does not turn";
  const ViewDocument hidden =
      with_hands(look_at(a, model), picked, [](const Hands& hands) { hands.tap(XK_h); });
  EXPECT_EQ(hidden.hidden, std::vector<std::uint32_t>{kFirstBonePart});
  EXPECT_EQ(hidden.selected, 0u);
  const ViewDocument shown =
      with_hands(look_at(a, model), hidden, [](const Hands& hands) { hands.tap(XK_h, Mod1Mask); });
  EXPECT_TRUE(shown.hidden.empty());
  EXPECT_TRUE(shown.closing);
}
#endif

TEST(NoDisplay, says_what_to_do) {
  const char* display = std::getenv("DISPLAY");
  const std::string before = display ? display : "";
  unsetenv("DISPLAY");
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  try {
    run_window(look_at(a, model), {.frames = 1});
    ADD_FAILURE() << "there was a window without a display";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find("ecorche render"), std::string::npos) << error.what();
  }
  EXPECT_THROW(run_window(look_at(a, model), {.width = 0}), UsageError);
  if (display) setenv("DISPLAY", before.c_str(), 1);
}

TEST(ViewKeysTest, each_key_does_one_thing_and_the_manual_has_the_same_table) {
  std::set<std::tuple<int, bool, bool, bool>> seen;
  std::map<std::string, std::string> listed;
  for (const ViewKey& key : view_keys()) {
    EXPECT_TRUE(seen.insert({key.key, key.ctrl, key.shift, key.alt}).second) << key.name;
    EXPECT_EQ(action_of(key.key, key.ctrl, key.shift, key.alt), key.action) << key.name;
    std::string& names = listed[std::string(key.effect)];
    names += fmt::format("{}`{}`", names.empty() ? "" : ", ", key.name);
  }
  EXPECT_FALSE(action_of(GLFW_KEY_SPACE, true, true, true));
  // Rows "| `Space` | play and pause |" under "## Keys".
  std::ifstream manual(std::filesystem::path(ECORCHE_TEST_DIR) / ".." / "docs" / "viewer.md");
  std::map<std::string, std::string> written;
  bool keys = false;
  for (std::string line; std::getline(manual, line);) {
    if (line.starts_with("#")) keys = line == "## Keys";
    const std::size_t middle = line.find(" | ");
    if (!keys || !line.starts_with("| `") || middle == std::string::npos) continue;
    written[line.substr(middle + 3, line.size() - middle - 5)] = line.substr(2, middle - 2);
  }
  EXPECT_EQ(written, listed);
}

TEST(ViewKeysTest, hiding_isolating_and_showing) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  const ViewSubject subject = look_at(a, model);
  ViewDocument document;
  act(ViewAction::hide, subject, {}, document);
  act(ViewAction::isolate, subject, {}, document);
  EXPECT_TRUE(document.hidden.empty()) << "nothing was selected";
  document.selected = kFirstBonePart;
  act(ViewAction::isolate, subject, {}, document);
  EXPECT_EQ(document.hidden, (std::vector<std::uint32_t>{kSkinPart, kEyesPart}));
  act(ViewAction::isolate, subject, {}, document);
  EXPECT_TRUE(document.hidden.empty()) << "and back";
  act(ViewAction::hide, subject, {}, document);
  EXPECT_TRUE(is_hidden(document, kFirstBonePart));
  act(ViewAction::show_all, subject, {}, document);
  EXPECT_TRUE(document.hidden.empty());
  act(ViewAction::last_frame, subject, {}, document);
  EXPECT_EQ(frame_of(subject, document), 9);
  act(ViewAction::next_frame, subject, {}, document);
  EXPECT_EQ(frame_of(subject, document), 9);
  act(ViewAction::first_frame, subject, {}, document);
  EXPECT_EQ(frame_of(subject, document), 0);
}

TEST(FilePanelTest, folders_first_then_what_can_be_opened) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("ecorche_files_{}", ::getpid());
  std::filesystem::create_directories(folder / "motions");
  for (const char* name : {"walk.bvh", "anna.glb", "notes.txt", ".hidden.glb"})
    std::ofstream(folder / name) << "x";
  std::vector<std::string> names;
  for (const FolderEntry& entry : list_folder(folder)) names.push_back(entry.name);
  EXPECT_EQ(names, (std::vector<std::string>{"motions", "anna.glb", "walk.bvh"}));
  EXPECT_TRUE(list_folder(folder / "none").empty());
  std::filesystem::remove_all(folder);
}

TEST(PanelsTest, a_part_is_described_for_people) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  const PartInfo info = describe(look_at(a, model), {}, kFirstBonePart);
  EXPECT_EQ(info.label, "hip bone, left");
  EXPECT_EQ(info.joint, "pelvis");
  EXPECT_EQ(describe(look_at(a, model), {}, kFirstBonePart + 99).name, "");
  EXPECT_EQ(describe(look_at(a, model), {}, 0).name, "");
}

}  // namespace
}  // namespace ecorche
