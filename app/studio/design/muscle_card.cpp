#include "app/studio/design/muscle_card.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/design/fields.h"
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
  ImGui::TextUnformatted("activation");
  action_slider(session, "##activation", own == values.end() ? 0 : own->second, 0, 1, "%.2f",
                fmt::format("activate {} value=", name), "effort");
  name_place(document, "activation");
  help_of_last("0 relaxed, 1 full effort: the belly shortens and bulges");
  show_fault(session, "effort");
}

// A curve with its range, and a line at the moment that is shown.
void draw_curve(const char* name, const char* unit, const std::vector<double>& values,
                std::size_t frames, double moment) {
  if (values.empty()) return;
  std::vector<float> shown(values.size());
  std::ranges::transform(values, shown.begin(), [](double value) { return float(1e3 * value); });
  const auto [low, high] = std::ranges::minmax(shown);
  const std::size_t now =
      std::min(std::size_t(moment * double(frames - 1) + 0.5), shown.size() - 1);
  ImGui::TextUnformatted(
      fmt::format("{} {:.1f} {}, {:.1f} to {:.1f}", name, shown[now], unit, low, high).c_str());
  ImGui::PushID(name);
  ImGui::PlotLines("##curve", shown.data(), int(shown.size()), 0, nullptr, low, high,
                   {ImGui::GetContentRegionAvail().x, 3 * em_card()});
  ImGui::PopID();
  const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
  const float x = from.x + (to.x - from.x) * float(moment);
  ImGui::GetWindowDrawList()->AddLine({x, from.y}, {x, to.y}, IM_COL32(250, 205, 60, 255), 2);
}

void draw_curves(DesignSession& session, PanelState& state, ViewDocument& document) {
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##about", kAngleNames[std::size_t(state.curve_axis)])) {
    for (int axis = 0; axis < 3; ++axis)
      if (ImGui::Selectable(kAngleNames[std::size_t(axis)], axis == state.curve_axis))
        state.curve_axis = axis;
    ImGui::EndCombo();
  }
  help_of_last("The angle of the moment arm; its joint is the one chosen under Joints");
  const Motion& motion = *session.shown().motion;
  const DesignSession::Curves& curves = session.curves(state.joint, state.curve_axis);
  const std::size_t frames = motion.frames.size();
  const double moment = std::clamp(document.time * motion.fps / double(frames - 1), 0.0, 1.0);
  draw_curve("length", "mm", curves.lengths, frames, moment);
  draw_curve("speed", "mm/s", curves.speeds, frames, moment);
  if (!state.joint.empty()) draw_curve("moment arm", "mm", curves.moment_arms, frames, moment);
  quiet_text("export FILE.csv writes them.");
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
    ImGui::TextWrapped("now: %s", now.c_str());
    help_of_last(
        "The left one in the pose that is shown; choose a joint under Joints to see the moment "
        "arms about it");
  }
  draw_effort(session, m.name, document);
  if (session.shown().motion->frames.size() > 1) {
    const bool open = ImGui::CollapsingHeader("Over the motion");
    name_place(document, "section:Over the motion");
    if (open) draw_curves(session, state, document);
  }
  ImGui::SetNextItemOpen(true, ImGuiCond_FirstUseEver);
  if (ImGui::CollapsingHeader("Line and sections")) draw_muscle_lines(session, state, m, document);
  ImGui::SetNextItemOpen(true, ImGuiCond_FirstUseEver);
  if (ImGui::CollapsingHeader("Figures")) draw_figures(session, m, document);
  ImGui::SetNextItemOpen(true, ImGuiCond_FirstUseEver);
  if (ImGui::CollapsingHeader("What is known")) draw_words(m);
}

}  // namespace ecorche
