#include "app/studio/design/muscle_card.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/design/fields.h"
#include "app/studio/design/motion_curves.h"
#include "app/studio/design/muscle_lines.h"

namespace ecorche {
namespace {

float em_card() { return ImGui::GetFontSize(); }

// A field of set_muscle, with its name before it.
void figure_row(DesignSession& session, const std::string& name, const char* key, const char* label,
                const std::string& now, const char* help, ViewDocument& document) {
  if (const auto text = value_row(key, label, now, help))
    session.run(fmt::format("set_muscle {} {}={}", name, key, ecorche::quoted(*text)), "figures");
  name_place(document, fmt::format("field:{}", key));
}

void draw_figures(DesignSession& session, const TableMuscle& m, ViewDocument& document) {
  if (!ImGui::BeginTable("figures", 2)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 8.5f * em_card());
  figure_row(session, m.name, "volume", "volume", fmt::format("{:.4g} ml", 1e6 * m.volume_male),
             "One side of a man of 77 kg; a body's own is scaled to what such a person has",
             document);
  figure_row(session, m.name, "female", "of a woman",
             fmt::format("{:.4g} ml", 1e6 * m.volume_female), "One side of a woman of 62 kg",
             document);
  figure_row(session, m.name, "fibre", "fibre length",
             fmt::format("{:.4g} cm", 1e2 * m.fibre_length), "Optimal length of its fibres",
             document);
  figure_row(session, m.name, "pennation", "pennation",
             fmt::format("{:.4g} deg", m.pennation / kDegree), "Angle of its fibres to the line",
             document);
  figure_row(session, m.name, "force", "force",
             m.max_force > 0 ? fmt::format("{:.4g} N", m.max_force) : "by volume and fibres",
             "Isometric, at full effort", document);
  figure_row(session, m.name, "tendon", "tendon", fmt::format("{:.4g}", m.tendon_fraction),
             "Share of tendon in the whole length, 0 to 0.99", document);
  ImGui::EndTable();
  quiet_text("Type a number, with another unit if you like (12 cm, 0.2 l), and press Enter.");
  show_fault(session, "figures");
}

void draw_words(const TableMuscle& m) {
  const auto line = [](const char* name, const std::string& text) {
    if (text.empty()) return;
    ImGui::TextWrapped("%s %s", name, text.c_str());
  };
  line("from", m.origin);
  line("to", m.insertion);
  if (!m.action.empty()) quiet_text(m.action);
  if (!m.note.empty()) quiet_text(m.note);
  std::string sources;
  for (const std::string& source : m.sources) sources += (sources.empty() ? "" : ", ") + source;
  if (!sources.empty()) quiet_text("figures: " + sources);
}

void draw_effort(DesignSession& session, const std::string& name, ViewDocument& document) {
  const auto& values = session.seen().trial->activations;
  const auto own = values.find(name);
  if (own != values.end() && !own->second.keys.empty()) {
    ImGui::TextUnformatted("activation: as its curve over the motion");
    show_fault(session, "effort");
    return;
  }
  ImGui::TextUnformatted("activation");
  action_slider(session, "##activation", own == values.end() ? 0 : own->second.value, 0, 1, "%.2f",
                fmt::format("activate {} value=", name), "effort");
  name_place(document, "activation");
  help_of_last("0 relaxed, 1 full effort: the belly shortens and bulges");
  show_fault(session, "effort");
}

void draw_first_steps() {
  ImGui::TextWrapped("No muscle is picked yet.");
  ImGui::Spacing();
  ImGui::TextWrapped("1. Click a muscle in the figure, or find it in the list on the left.");
  ImGui::TextWrapped(
      "2. Its line appears with points on it: the round one with O is the origin, that with I the "
      "insertion. Drag a point; the muscle goes along.");
  ImGui::TextWrapped("3. Ctrl + Z takes it back, Ctrl + Shift + Z does it again.");
  ImGui::TextWrapped("4. Ctrl + S saves; Ctrl + P finds every action; F1 shows the keys.");
}

}  // namespace

void draw_muscle_card(DesignSession& session, PanelState& state, ViewDocument& document) {
  const Document held = session.seen();  // stays while fields make a new one
  const int entry = find_entry(held, held.picked);
  if (entry < 0) {
    draw_first_steps();
    return;
  }
  const EditedMuscle& edited = *held.muscles[std::size_t(entry)];
  const TableMuscle& m = edited.left;
  ImGui::TextWrapped("%s", m.label.empty() ? m.name.c_str() : m.label.c_str());
  quiet_text(fmt::format("{}, {}, {}", m.name, m.group, m.layer));
  if (ImGui::Button("closely")) state.look = ViewAction::frame_selected;
  name_place(document, "closely");
  help_of_last("Bring it near (key .)");
  ImGui::SameLine();
  if (ImGui::Button("only this")) state.look = ViewAction::isolate;
  help_of_last("Hide all other parts, and show them again (key I)");
  ImGui::SameLine();
  if (ImGui::Button("copy")) {
    for (int k = 2;; ++k)
      if (find_entry(held, fmt::format("{}_{}", m.name, k)) < 0) {
        session.run(fmt::format("copy_muscle {} as={}_{}", m.name, m.name, k), "muscle");
        break;
      }
  }
  ImGui::SameLine();
  if (ImGui::Button("remove")) session.run("remove_muscle " + m.name, "muscle");
  help_of_last("Ctrl + Z brings it back");
  if (edited.right) {
    quiet_text("The right side differs; what is shown here is the left.");
    if (ImGui::Button("make the sides alike")) session.run("mirror_muscle " + m.name, "muscle");
  }
  show_fault(session, "muscle");
  if (const std::string& now = session.figures(state.joint, document.playing); !now.empty()) {
    ImGui::TextUnformatted(("now " + now).c_str());  // wrapped, numbers would break at their points
    help_of_last(
        "The left one in the pose that is shown; choose a joint under Joints to see the moment "
        "arms about it");
  }
  draw_effort(session, m.name, document);
  if (session.shown().motion->frames.size() > 1) {
    const bool open = ImGui::CollapsingHeader("Over the motion");
    name_place(document, "section:Over the motion");
    if (open) draw_motion_curves(session, state, document);
  }
  ImGui::SetNextItemOpen(true, ImGuiCond_FirstUseEver);
  if (ImGui::CollapsingHeader("Line and sections")) draw_muscle_lines(session, state, m, document);
  ImGui::SetNextItemOpen(true, ImGuiCond_FirstUseEver);
  if (ImGui::CollapsingHeader("Figures")) draw_figures(session, m, document);
  ImGui::SetNextItemOpen(true, ImGuiCond_FirstUseEver);
  if (ImGui::CollapsingHeader("What is known")) draw_words(m);
}

}  // namespace ecorche
