#include "app/studio/design/design_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>
#include <utility>

#include "app/edit/recent_files.h"
#include "app/studio/design/body_panel.h"
#include "app/studio/design/bone_input.h"
#include "app/studio/design/comparison_view.h"
#include "app/studio/design/design_session.h"
#include "app/studio/design/draw_handles.h"
#include "app/studio/design/dropped_files.h"
#include "app/studio/design/fields.h"
#include "app/studio/design/frame_times.h"
#include "app/studio/design/muscle_card.h"
#include "app/studio/design/muscle_list.h"
#include "app/studio/design/panel_state.h"
#include "app/studio/design/script_panel.h"
#include "app/studio/design/tour.h"
#include "viewer/window/file_panel.h"
#include "viewer/window/panels.h"

namespace ecorche {
namespace {

constexpr float kMargin = 0.5f, kLeft = 14.5f, kRight = 19.5f;  // of a letter's height
constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse;
constexpr float kFaint = 0.5f;  // of the skin's opacity
constexpr const char* kPeeled[] = {"all layers", "without the superficial",
                                   "without those between, too", "no muscles"};

float em() { return ImGui::GetFontSize(); }

std::vector<std::filesystem::path> recent_projects(const std::filesystem::path& states) {
  constexpr std::size_t kShown = 4;
  std::vector<std::filesystem::path> out;
  for (const RecentFile& each : recent_files(states))
    if (each.kind == "project" && out.size() < kShown) out.push_back(each.file);
  return out;
}

// Everything of one window; its members are what the hooks of the window work on.
class DesignWindow {
 public:
  DesignWindow(Session& session, const Common& common, const Session::Drawer& draw)
      : work_(session, common, draw), comparison_(work_) {
    const std::filesystem::path& states = session.kept_unsaved();
    if (session.has_project()) {
      note_recent(states, {"project", session.project()});
    } else {
      state_.left = unsaved_sessions(states);
      state_.projects = recent_projects(states);
    }
    subject_.update = [this](ViewDocument& document, bool wait) { update(document, wait); };
    subject_.pose = [this](int frame, PosedAnatomy& posed, SkinFrame& skin) {
      work_.pose(frame, quick_, posed, skin);
    };
    subject_.open = [this](const std::filesystem::path& file) {
      open_dropped(work_, state_, file);
    };
    show();
  }

  ViewSubject& subject() { return subject_; }
  WindowTool tool();
  const FrameTimes& times() const { return times_; }
  const ShownBody& shown_body() const { return work_.shown(); }
  void begin_tour() { state_.asks_tour = true; }

 private:
  void update(ViewDocument& document, bool wait);
  void show();
  ViewRoom panels(const PosedAnatomy& posed, ViewDocument& document);
  void draw_left(const PosedAnatomy& posed, ViewDocument& document, float bottom);
  void draw_right(ViewDocument& document, float bottom);
  void dress(Appearance& appearance, bool beside) const;
  bool take(const WindowEvent& event, const ViewProjection& view, ViewDocument& document);
  bool take_key(const WindowEvent& event, ViewDocument& document);
  void pick(std::uint32_t part);
  void follow_pick(ViewDocument& document);
  void shown(double seconds, const ViewDocument& document);

  DesignSession work_;
  ComparisonView comparison_;
  Tour tour_;
  BarPlace bar_{};  // below the bar of the last frame
  ViewRoom room_;   // of the last frame's figure
  PanelState state_;
  ViewSubject subject_;
  const PosedAnatomy* posed_ = nullptr;  // of this frame
  std::uint64_t revision_ = 0;
  std::string followed_;  // the muscle that the view has selected
  const char* side_ = "_l";
  // A motion plays under a faint skin, which then is not worth the time that it takes to settle.
  bool quick_ = false;
  bool undone_ = false, edited_ = false;
  float azimuth_ = 0, elevation_ = 0;
  std::string tried_;
  FrameTimes times_;
};

void DesignWindow::show() {
  const ShownBody& shown = work_.shown();
  const Character& character = shown.character();
  subject_.anatomy = &character.anatomy;
  subject_.model = shown.model.get();
  subject_.frames = int(shown.motion->frames.size());
  subject_.fps = shown.motion->fps;
  subject_.bounds = Eigen::AlignedBox3f();
  const Vec3 root = rest_positions(character.anatomy.skeleton).front();
  for (Eigen::Index i = 0; i < character.body.skin.V.rows(); ++i)
    subject_.bounds.extend(Vec3f(
        (character.body.skin.V.row(i).transpose() - Vec3(root.x(), 0, root.z())).cast<float>()));
  subject_.name = "studio";
  followed_.clear();
}

void DesignWindow::update(ViewDocument& document, bool wait) {
  times_.begin();
  work_.update();
  while (wait && (work_.fit().busy() || work_.beside().busy())) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    work_.update();
  }
  if (work_.revision() != revision_) {
    const bool other = subject_.model != work_.shown().model.get();
    const int frames = subject_.frames;
    if (other || frames != int(work_.shown().motion->frames.size())) show();
    if (frames < 2 && subject_.frames > 1) document.playing = true, document.time = 0;
    ++subject_.revision;
    ++document.touched;
    revision_ = work_.revision();
  }
  if (quick_ != (document.playing && document.look.skin < kFaint)) {
    quick_ = !quick_;
    ++subject_.revision;
  }
  comparison_.update();
  document.busy = work_.fit().busy() || work_.beside().busy();
  follow_pick(document);
}

// The view's selection is the picked muscle, until a bone or the skin is clicked.
void DesignWindow::follow_pick(ViewDocument& document) {
  const std::string& picked = work_.seen().picked;
  if (picked == followed_) return;
  followed_ = picked;
  int own = find_muscle(work_.anatomy(), picked + side_);
  if (own < 0) own = find_muscle(work_.anatomy(), picked + "_l");
  document.selected = picked.empty() || own < 0 ? 0 : kFirstMusclePart + std::uint32_t(own);
}

void DesignWindow::pick(std::uint32_t part) {
  if (std::exchange(state_.bone_clicked, false)) return;
  const Part found = part_of(part);
  if (found.kind != Part::Kind::muscle || found.index >= int(work_.anatomy().muscles.size()))
    return;
  const Muscle& muscle = work_.anatomy().muscles[std::size_t(found.index)];
  const std::string name = muscle.name.substr(0, muscle.name.size() - 2);
  side_ = muscle.side == Side::right ? "_r" : "_l";
  if (work_.seen().picked != name) work_.run("pick " + name, "view");
  followed_ = name;
}

void DesignWindow::dress(Appearance& appearance, bool beside) const {
  std::set<std::uint32_t> hidden(appearance.hidden.begin(), appearance.hidden.end());
  const Anatomy& anatomy = work_.anatomy();
  const std::string& picked = work_.seen().picked;
  for (int m = 0; m < int(anatomy.muscles.size()); ++m) {
    const Muscle& muscle = anatomy.muscles[std::size_t(m)];
    const bool own = muscle.name.size() == picked.size() + 2 && muscle.name.starts_with(picked);
    const int depth = muscle.layer == "deep" ? 3 : muscle.layer == "intermediate" ? 2 : 1;
    if ((!beside && work_.is_replaced(m)) || state_.bone_click || (depth <= state_.peel && !own))
      hidden.insert(kFirstMusclePart + std::uint32_t(m));
  }
  for (std::size_t f = 0; (state_.peel > 0 || state_.bone_click) && f < anatomy.fascia.size(); ++f)
    hidden.insert(kFirstFasciaPart + std::uint32_t(f));
  appearance.hidden.assign(hidden.begin(), hidden.end());
  if (state_.mark_changed)
    for (const int m : work_.changed_since_saved())
      appearance.marked.push_back(kFirstMusclePart + std::uint32_t(m));
}

void DesignWindow::draw_left(const PosedAnatomy& posed, ViewDocument& document, float bottom) {
  const float edge = kMargin * em();
  ImGui::SetNextWindowPos({edge, edge}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({kLeft * em(), bottom - edge}, ImGuiCond_Always);
  if (ImGui::Begin("Muscles", nullptr, kPanel)) {
    const bool open = ImGui::CollapsingHeader("View: cut, layers, sides");
    name_place(document, "section:View");
    if (open) {
      draw_look(document);
      draw_section(subject_, document);
      draw_views(subject_, posed, document);
    }
    ImGui::SetNextItemWidth(7 * em());
    ImGui::SliderInt("##peel", &state_.peel, 0, 3, "");
    name_place(document, "peel");
    ImGui::SameLine();
    ImGui::TextUnformatted("peel");
    help_of_last("Take layers of muscles off, superficial to deep (key L)");
    if (state_.peel > 0) quiet_text(kPeeled[state_.peel]);
    ImGui::Checkbox("colour what is not saved", &state_.mark_changed);
    bool saved = work_.shows_saved();
    if (ImGui::Checkbox("as it was saved", &saved)) work_.show_saved(saved);
    name_place(document, "as it was saved");
    help_of_last("Before and after what is not saved, in the same pose (key C)");
    draw_comparison_choice(work_, document);
    ImGui::Separator();
    draw_muscle_list(work_, state_, document);
  }
  ImGui::End();
}

void DesignWindow::draw_right(ViewDocument& document, float bottom) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float edge = kMargin * em();
  ImGui::SetNextWindowPos({size.x - (kRight + kMargin) * em(), edge}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({kRight * em(), bottom - edge}, ImGuiCond_Always);
  if (ImGui::Begin("Design", nullptr, kPanel | ImGuiWindowFlags_NoTitleBar) &&
      ImGui::BeginTabBar("tabs")) {
    const auto tab = [&](const char* name, const auto& draw) {
      const bool asked = state_.asks_tab == name;
      const bool open = ImGui::BeginTabItem(
          name, nullptr, asked ? ImGuiTabItemFlags_SetSelected : ImGuiTabItemFlags_None);
      name_place(document, std::string("tab:") + name);
      if (!open) return;
      state_.joint_tab = std::string(name) == "Joints";
      state_.script_tab = std::string(name) == "Script";
      ImGui::BeginChild(name);
      if (asked) {
        ImGui::SetScrollY(0);
        state_.asks_tab.clear();
      }
      draw();
      ImGui::EndChild();
      ImGui::EndTabItem();
    };
    tab("Muscle", [&] { draw_muscle_card(work_, state_, document); });
    tab("Joints", [&] { draw_joint_panel(work_, state_, document); });
    tab("Try", [&] { draw_trial_panel(work_, document); });
    tab("Body", [&] { draw_body_panel(work_, state_, document); });
    tab("Script", [&] { draw_script_panel(work_, document); });
    ImGui::EndTabBar();
  }
  ImGui::End();
}

ViewRoom DesignWindow::panels(const PosedAnatomy& posed, ViewDocument& document) {
  posed_ = &posed;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  draw_help(document, tool().keys);
  draw_file_panel(subject_, document);
  ViewRoom room{0, 0, size.x, size.y};
  if (!document.panels) return room;
  work_.note_fault_seen(false);
  const float timeline = draw_timeline(subject_, posed, document), edge = kMargin * em();
  const float bottom = size.y - timeline - edge;
  draw_left(posed, document, bottom);
  draw_right(document, bottom);
  if (!state_.joint.empty() && !work_.has_joint(state_.joint)) state_.joint.clear();
  const float left = (kLeft + 2 * kMargin) * em(), right = (kRight + 2 * kMargin) * em();
  const BarPlace bar{left, edge, std::max(size.x - left - right, 20 * em())};
  const float under = draw_top_bar(work_, state_, document, bar);
  draw_actions_box(work_, state_, document, {bar.left, under, bar.width});
  bar_ = {bar.left, under, bar.width};
  if (state_.look) act(*std::exchange(state_.look, std::nullopt), subject_, posed, document);
  if (state_.closes) document.closing = true;
  if (size.x - left - right > 0.3f * size.x) room = {left, 0, size.x - left - right, 0, true};
  room.y = 3 * em();
  room.height = std::max(size.y - timeline - room.y, 0.35f * size.y);
  comparison_.draw(room);
  room_ = room;
  return room;
}

bool DesignWindow::take_key(const WindowEvent& event, ViewDocument& document) {
  if (event.ctrl && event.key == GLFW_KEY_P) {
    state_.actions = state_.actions_begin = !state_.actions;
    return true;
  }
  if (event.ctrl && event.key == GLFW_KEY_S) {
    save_or_ask(work_, state_);
    return true;
  }
  if (event.key == GLFW_KEY_ESCAPE &&
      (state_.actions || state_.asks_folder || state_.asks_to_close)) {
    state_.actions = state_.asks_folder = state_.asks_to_close = false;
    return true;
  }
  if (ImGui::GetIO().WantTextInput) return false;
  const bool again =
      event.ctrl && ((event.shift && event.key == GLFW_KEY_Z) || event.key == GLFW_KEY_Y);
  if (again || (event.ctrl && event.key == GLFW_KEY_Z)) {
    const History& history = work_.session().history();
    if (again ? history.now + 1 < history.steps.size() : history.now > 0)
      work_.run(again ? "redo" : "undo", "bar");
    else
      work_.say(again ? "there is nothing to do again" : "there is nothing to take back");
    undone_ = true;
    return true;
  }
  if (event.ctrl || event.alt || event.shift) return false;
  if (event.key == GLFW_KEY_L) {
    state_.peel = (state_.peel + 1) % 4;
    return true;
  }
  if (event.key == GLFW_KEY_C) {
    work_.show_saved(!work_.shows_saved());
    return true;
  }
  if (event.key == GLFW_KEY_J) {
    state_.joints = !state_.joints;
    return true;
  }
  (void)document;
  return false;
}

bool DesignWindow::take(const WindowEvent& event, const ViewProjection& view,
                        ViewDocument& document) {
  if (event.kind == WindowEvent::Kind::drop) {
    guess_joint(work_, state_, posed_, event, view);
    for (const std::filesystem::path& file : event.files) open_dropped(work_, state_, file);
    return true;
  }
  if (state_.bone_click && take_bone_click(work_, state_, posed_, event, view)) return true;
  if (comparison_.take(event, room_)) {
    ++document.touched;
    return true;
  }
  if (posed_ && !state_.bone_click && take_handle(work_, state_, *posed_, event, view)) {
    ++document.touched;
    return true;
  }
  if (event.kind != WindowEvent::Kind::key) return false;
  if (!take_key(event, document)) return false;
  ++document.touched;
  return true;
}

void DesignWindow::shown(double seconds, const ViewDocument& document) {
  using Doing = FrameTimes::Doing;
  const bool tries = work_.tried_line() != tried_ && !work_.tried_line().empty();
  tried_ = work_.tried_line();
  const bool turned = document.azimuth != azimuth_ || document.elevation != elevation_;
  azimuth_ = document.azimuth;
  elevation_ = document.elevation;
  const Doing doing = undone_            ? Doing::undoing
                      : tries            ? Doing::editing
                      : turned           ? Doing::turning
                      : document.playing ? Doing::playing
                                         : Doing::still;
  undone_ = false;
  times_.end(doing, seconds, document.busy);
}

WindowTool DesignWindow::tool() {
  WindowTool out;
  out.panels = [this](const PosedAnatomy& posed, ViewDocument& document) {
    return panels(posed, document);
  };
  out.dress = [this](Appearance& appearance) { dress(appearance, false); };
  out.beside = [this] { return comparison_.figure(); };
  out.dress_beside = [this](Appearance& appearance) {
    dress(appearance, true);
    comparison_.dress(appearance);
  };
  out.add = [this](const PosedAnatomy& posed, const Appearance& appearance, DrawList& list) {
    work_.add_live(posed, appearance, list);
  };
  out.draw_over = [this](const PosedAnatomy& posed, const ViewProjection& view,
                         ViewDocument& document) {
    if (work_.follow()) ++document.touched;
    draw_handles(work_, state_, posed, view, document);
    if (std::exchange(state_.asks_tour, false)) tour_.begin();
    document.names_places = tour_.runs();
    if (document.panels && !state_.actions)
      tour_.draw(work_, state_, bar_.left, bar_.top + 0.4f * em(), bar_.width, document);
  };
  out.take = [this](const WindowEvent& event, const ViewProjection& view, ViewDocument& document) {
    return take(event, view, document);
  };
  out.picked = [this](std::uint32_t part) { pick(part); };
  out.may_close = [this] {
    if (state_.closes || !work_.session().unsaved()) return true;
    state_.asks_to_close = true;
    return false;
  };
  out.shown = [this](double, double seconds, const ViewDocument& document) {
    shown(seconds, document);
  };
  out.keys = {{"Click", "pick a muscle"},
              {"Drag a point", "move it: one step, Ctrl + Z takes it back"},
              {"Drag", "turn the view; Shift + drag moves it, the wheel goes nearer"},
              {"Ctrl + Z", "take back"},
              {"Ctrl + Shift + Z", "do again"},
              {"Ctrl + S", "save the project"},
              {"Ctrl + P", "find and run an action"},
              {"L", "peel a layer of muscles, superficial to deep"},
              {"C", "as it was saved, and as it is"},
              {"J", "centres of joints on and off"}};
  return out;
}

}  // namespace

void run_design_window(Session& session, const Common& common, Report& report,
                       const Session::Drawer& draw, const WindowOptions& options) {
  DesignWindow window(session, common, draw);
  ViewDocument begin;
  begin.look.skin = 0.1f;
  // not of pictures and played sessions
  if (options.input.empty() && options.frames == 0 && is_first_run(session.kept_unsaved()))
    window.begin_tour();
  const WindowTool tool = window.tool();
  run_window(window.subject(), options, begin, tool);
  window.times().report(report);
  const ShownBody& shown = window.shown_body();
  report.set("window.fit_ms", 1e3 * shown.fit_seconds);
  report.set("window.fit_cpu_ms", 1e3 * shown.fit_cpu_seconds);
}

}  // namespace ecorche
