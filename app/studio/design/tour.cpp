#include "app/studio/design/tour.h"

#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>
#include <string>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/studio/design/fields.h"

namespace ecorche {
namespace {

struct Seen {
  const DesignSession& session;
  const PanelState& state;
  const ViewDocument& view;

  const Trial& trial() const { return *session.seen().trial; }
  bool was_run(const char* action) const {
    const History& history = session.session().history();
    for (std::size_t k = 1; k < history.steps.size(); ++k)
      if (history.steps[k].line.starts_with(action)) return true;
    return false;
  }
};

struct Step {
  const char* text;
  const char* place;  // as the panels name it; one that ends in : is the last that begins so
  bool (*done)(const Seen&);
};

constexpr const char* kMuscle = "biceps_brachii_long";

const std::array kSteps{
    Step{"Find a muscle: click here and type  biceps long", "find",
         [](const Seen& s) { return s.state.find.find("biceps") != std::string::npos; }},
    Step{"Click its name to take hold of it.", "list:biceps_brachii_long",
         [](const Seen& s) { return s.session.seen().picked == kMuscle; }},
    Step{"Bring it near.", "closely", [](const Seen& s) { return !s.view.framed; }},
    Step{"Drag the point I, its insertion, a little. Muscle and skin follow.",
         "point:1:", [](const Seen& s) { return s.was_run("move_point"); }},
    Step{"Take it back: Ctrl + Z, or this button. Nothing is lost by trying.", "undo",
         [](const Seen& s) {
           const History& history = s.session.session().history();
           return history.now + 1 < history.steps.size();
         }},
    Step{"Let it work: slide the activation up, and see the belly swell.", "activation",
         [](const Seen& s) { return !s.trial().activations.empty(); }},
    Step{"Now bend a joint: open Joints, choose the elbow, and slide flexion.", "tab:Joints",
         [](const Seen& s) { return !s.trial().angles.empty(); }},
    Step{"All that you did stands here as lines of a script.", "tab:Script",
         [](const Seen& s) { return s.state.script_tab; }}};

// Where a step points to; nothing where its place is not in sight.
const Eigen::Vector2f* place_of(const Step& step, const ViewDocument& document) {
  const std::string name = step.place;
  if (name.back() != ':') {
    const auto own = document.places.find(name);
    return own == document.places.end() ? nullptr : &own->second;
  }
  const Eigen::Vector2f* out = nullptr;
  for (auto it = document.places.lower_bound(name);
       it != document.places.end() && it->first.starts_with(name); ++it)
    out = &it->second;
  return out;
}

void draw_ring(const Eigen::Vector2f& at) {
  const float em = ImGui::GetFontSize();
  const float swing = 0.15f * std::sin(4 * float(ImGui::GetTime()));
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.AddCircle({at.x(), at.y()}, (1.6f + swing) * em, IM_COL32(0, 0, 0, 160), 40, 6);
  list.AddCircle({at.x(), at.y()}, (1.6f + swing) * em, IM_COL32(250, 205, 60, 255), 40, 3);
}

}  // namespace

void Tour::begin() { step_ = 0; }

void Tour::draw(const DesignSession& session, const PanelState& state, float left, float top,
                float width, ViewDocument& document) {
  if (!runs()) return;
  if (kSteps[step_].done({session, state, document})) ++step_;
  const bool over = step_ == kSteps.size();
  if (!over)
    if (const Eigen::Vector2f* at = place_of(kSteps[step_], document)) draw_ring(*at);
  ImGui::SetNextWindowPos({left, top}, ImGuiCond_Always);
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, 1000});
  if (ImGui::Begin("tour", nullptr,
                   ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                       ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoTitleBar |
                       ImGuiWindowFlags_AlwaysAutoResize)) {
    if (over)
      ImGui::TextWrapped("That is all there is to know to begin. Ctrl + P finds every action.");
    else
      ImGui::TextWrapped(
          "%s", fmt::format("{} of {}: {}", step_ + 1, kSteps.size(), kSteps[step_].text).c_str());
    if (over) {
      if (ImGui::Button("good")) end();
      name_place(document, "tour end");
    } else {
      if (ImGui::Button("leave the tour")) end();
      name_place(document, "tour leave");
      ImGui::SameLine();
      if (ImGui::Button("next###tour next")) ++step_;
      name_place(document, "tour next");
    }
  }
  ImGui::End();
}

bool is_first_run(const std::filesystem::path& folder) {
  if (folder.empty() || std::filesystem::exists(folder / "toured.txt")) return false;
  try {
    make_output_folder(folder);
    write_file_atomically(folder / "toured.txt", "The tour was shown.\n");
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace ecorche
