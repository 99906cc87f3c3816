#include "viewer/window/panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "viewer/part_names.h"
#include "viewer/window/file_panel.h"
#include "viewer/window/measure_panel.h"
#include "viewer/window/view_keys.h"

namespace ecorche {
namespace {

constexpr float kEdge = 0.8f, kLeftColumn = 17.5f, kSelected = 19;  // of a letter's height

const ImVec4 quiet(0.66f, 0.66f, 0.68f, 1);
constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;

float em_panels() { return ImGui::GetFontSize(); }

void key_button(const char* word, ViewAction action, const ViewSubject& subject,
                const PosedAnatomy& posed, ViewDocument& document) {
  if (ImGui::Button(word)) act(action, subject, posed, document);
}

void draw_colours(ViewDocument& document) {
  bool lengths = document.muscle_colors == MuscleColors::shortening;
  if (ImGui::Checkbox("colour-blind colours", &lengths))
    document.muscle_colors = lengths ? MuscleColors::shortening : MuscleColors::flesh;
  for (const auto& [word, activity] :
       {std::pair{"longer", -1.0f}, {"at rest", 0.0f}, {"shorter", 1.0f}}) {
    const Vec3f c = muscle_color(document.muscle_colors, activity);
    ImGui::ColorButton(word, ImVec4(c.x(), c.y(), c.z(), 1), ImGuiColorEditFlags_NoTooltip,
                       {0.9f * em_panels(), 0.9f * em_panels()});
    ImGui::SameLine();
    ImGui::TextUnformatted(word);
    if (activity < 1) ImGui::SameLine();
  }
}

// A slider with its value beside it, where the grab does not cover it.
void layer_slider(const char* name, float& value) {
  ImGui::SetNextItemWidth(8 * em_panels());
  ImGui::SliderFloat(fmt::format("##{}", name).c_str(), &value, 0, 1, "");
  ImGui::SameLine();
  ImGui::Text("%3.0f %%  %s", 100 * value, name);
}

float draw_layers(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document) {
  ImGui::SetNextWindowPos({kEdge * em_panels(), kEdge * em_panels()}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({kLeftColumn * em_panels(), 0}, ImGuiCond_Always);
  if (ImGui::Begin("View", nullptr, kFixed)) {
    draw_look(document);
    draw_section(subject, document);
    draw_views(subject, posed, document);
    if (subject.open) key_button("open...", ViewAction::open, subject, posed, document);
    if (subject.open) ImGui::SameLine();
    key_button("picture", ViewAction::picture, subject, posed, document);
    ImGui::SameLine();
    key_button("keys", ViewAction::help, subject, posed, document);
    ImGui::TextColored(quiet, "drag: turn, shift+drag: move\nwheel: nearer, click: pick, F1: keys");
  }
  const float bottom = ImGui::GetWindowPos().y + ImGui::GetWindowHeight();
  ImGui::End();
  return bottom;
}

void draw_fact(const char* name, const std::string& value) {
  if (value.empty()) return;
  ImGui::TextColored(quiet, "%s", name);
  ImGui::TextWrapped("%s", value.c_str());
}

void draw_selection(const ViewSubject& subject, const PosedAnatomy& posed, float top,
                    ViewDocument& document) {
  if (part_of(document.selected).kind == Part::Kind::none) return;
  const PartInfo info = describe(subject, posed, document.selected);
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - (kSelected + kEdge) * em_panels(), top},
                          ImGuiCond_Always);
  ImGui::SetNextWindowSize({kSelected * em_panels(), 0}, ImGuiCond_Always);
  if (ImGui::Begin("Selected", nullptr, kFixed)) {
    ImGui::TextWrapped("%s", info.label.c_str());
    if (info.name != info.label) ImGui::TextColored(quiet, "%s", info.name.c_str());
    draw_fact("rides on", info.joint);
    draw_fact("origin", info.origin);
    draw_fact("insertion", info.insertion);
    if (info.rest_length > 0)
      draw_fact("length", fmt::format("{:.1f} cm ({:+.0f} % of rest)", 100 * info.length,
                                      100 * (info.length / info.rest_length - 1)));
    if (info.volume > 0) draw_fact("volume", fmt::format("{:.0f} ml", 1e6 * info.volume));
    key_button("hide", ViewAction::hide, subject, posed, document);
    ImGui::SameLine();
    key_button("only this", ViewAction::isolate, subject, posed, document);
    ImGui::SameLine();
    key_button("closely", ViewAction::frame_selected, subject, posed, document);
    ImGui::SameLine();
    key_button("let go", ViewAction::let_go, subject, posed, document);
  }
  ImGui::End();
}

// A tick: it is seen. A click: it is selected.
void part_entry(const ViewSubject& subject, std::uint32_t part, const ImGuiTextFilter& filter,
                ViewDocument& document) {
  const std::string label = part_label(*subject.anatomy, part);
  if (!filter.PassFilter(label.c_str()) &&
      !filter.PassFilter(part_name(*subject.anatomy, part).c_str()))
    return;
  ImGui::PushID(int(part));
  bool seen = !is_hidden(document, part);
  if (ImGui::Checkbox("##seen", &seen)) set_hidden(part, !seen, document);
  ImGui::SameLine();
  if (ImGui::Selectable(label.c_str(), document.selected == part)) document.selected = part;
  if (ImGui::IsItemHovered() &&
      ImGui::CalcTextSize(label.c_str()).x > ImGui::GetContentRegionAvail().x)
    ImGui::SetTooltip("%s", label.c_str());
  ImGui::PopID();
}

void draw_parts(const ViewSubject& subject, const PosedAnatomy& posed, float top, float bottom,
                ViewDocument& document) {
  ImGui::SetNextWindowPos({kEdge * em_panels(), top}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({kLeftColumn * em_panels(), std::max(bottom - top, 8 * em_panels())},
                           ImGuiCond_Always);
  ImGui::SetNextWindowCollapsed(true, ImGuiCond_FirstUseEver);
  const std::string title = document.hidden.empty()
                                ? "Parts###parts"
                                : fmt::format("Parts ({} hidden)###parts", document.hidden.size());
  if (ImGui::Begin(title.c_str(), nullptr, kFixed)) {
    static ImGuiTextFilter filter;
    filter.Draw("find", 9 * em_panels());
    ImGui::SameLine();
    key_button("all", ViewAction::show_all, subject, posed, document);
    ImGui::BeginChild("list");
    for (const std::uint32_t part : all_parts(*subject.anatomy))
      part_entry(subject, part, filter, document);
    ImGui::EndChild();
  }
  ImGui::End();
}

// What is not played, darker, over the slider that was drawn last.
void draw_marks(const ViewSubject& subject, const ViewDocument& document) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const auto at = [&](int frame) {
    return low.x + (high.x - low.x) * float(frame) / float(std::max(subject.frames, 1));
  };
  constexpr ImU32 shade = IM_COL32(0, 0, 0, 150), line = IM_COL32(250, 205, 60, 255);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (document.in) {
    list.AddRectFilled(low, {at(*document.in), high.y}, shade);
    list.AddLine({at(*document.in), low.y}, {at(*document.in), high.y}, line, 2);
  }
  if (document.out) {
    list.AddRectFilled({at(*document.out + 1), low.y}, high, shade);
    list.AddLine({at(*document.out + 1), low.y}, {at(*document.out + 1), high.y}, line, 2);
  }
}

// State of the subject, and the last message.
void draw_state(const ViewDocument& document, float left, float bottom) {
  if (document.state.empty() && document.message.empty()) return;
  ImGui::SetNextWindowPos({left, bottom}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints(
      {0, 0}, {std::max(ImGui::GetIO().DisplaySize.x - left - kEdge * em_panels(), 8 * em_panels()),
               12 * em_panels()});
  constexpr ImGuiWindowFlags flags = kFixed | ImGuiWindowFlags_NoTitleBar |
                                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs;
  if (ImGui::Begin("state", nullptr, flags)) {
    ImGui::PushTextWrapPos(30 * em_panels());
    if (!document.state.empty()) ImGui::TextUnformatted(document.state.c_str());
    if (!document.message.empty()) ImGui::TextUnformatted(document.message.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
}

}  // namespace

void name_place(ViewDocument& document, const std::string& name) {
  if (!document.recorded && !document.names_places) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  document.places[name] = {0.5f * (low.x + high.x), 0.5f * (low.y + high.y)};
}

void draw_look(ViewDocument& document) {
  layer_slider("skin", document.look.skin);
  layer_slider("dissolve", document.look.skin_dissolved);
  layer_slider("muscles", document.look.muscles);
  layer_slider("bones", document.look.bones);
  draw_colours(document);
  ImGui::Checkbox("ground", &document.ground);
  ImGui::SameLine();
  ImGui::Checkbox("follow", &document.follow);
  ImGui::SameLine();
  ImGui::Checkbox("parallel", &document.parallel);
}

void draw_section(const ViewSubject& subject, ViewDocument& document) {
  using Kind = SectionPlane::Kind;
  constexpr std::pair<Kind, const char*> kinds[] = {{Kind::none, "whole"},
                                                    {Kind::transverse, "across (transverse)"},
                                                    {Kind::frontal, "from the front (frontal)"},
                                                    {Kind::sagittal, "from the side (sagittal)"}};
  SectionPlane& section = document.section;
  ImGui::TextUnformatted("cut");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  const auto now = std::ranges::find(kinds, section.kind, &std::pair<Kind, const char*>::first);
  if (ImGui::BeginCombo("##cut", now != std::end(kinds) ? now->second : "square to a limb")) {
    for (const auto& [kind, word] : kinds)
      if (ImGui::Selectable(word, kind == section.kind))
        while (section.kind != kind) next_section(subject, document);
    ImGui::EndCombo();
  }
  name_place(document, "cut");
  if (section.kind == Kind::none) return;
  const auto [low, high] = section_range(subject, section.kind);
  float centimetres = float(100 * section.place);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##place", &centimetres, float(100 * low), float(100 * high), "%.1f cm"))
    section.place = 0.01 * centimetres;
  name_place(document, "cut:place");
}

void draw_views(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document) {
  using A = ViewAction;
  key_button("front", A::front, subject, posed, document);
  ImGui::SameLine();
  key_button("back", A::back, subject, posed, document);
  ImGui::SameLine();
  key_button("left", A::left, subject, posed, document);
  ImGui::SameLine();
  key_button("right", A::right, subject, posed, document);
  key_button("top", A::top, subject, posed, document);
  ImGui::SameLine();
  key_button("bottom", A::bottom, subject, posed, document);
  ImGui::SameLine();
  key_button("oblique", A::oblique, subject, posed, document);
  ImGui::SameLine();
  key_button("all", A::frame_all, subject, posed, document);
}

float draw_timeline(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document) {
  if (subject.frames < 2) return 0;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float height = ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().WindowPadding.y;
  ImGui::SetNextWindowPos({kEdge * em_panels(), size.y - height - kEdge * em_panels()},
                          ImGuiCond_Always);
  ImGui::SetNextWindowSize({std::max(size.x - 2 * kEdge * em_panels(), 8 * em_panels()), height},
                           ImGuiCond_Always);
  if (ImGui::Begin("time", nullptr,
                   kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar)) {
    for (const auto& [word, action] : {std::pair{"|<", ViewAction::first_frame},
                                       {"<", ViewAction::previous_frame},
                                       {"play", ViewAction::play},
                                       {">", ViewAction::next_frame},
                                       {">|", ViewAction::last_frame}}) {
      const bool plays = action == ViewAction::play;
      if (ImGui::Button(plays && document.playing ? "pause###play"
                        : plays                   ? "play###play"
                                                  : word,
                        {plays ? 4 * em_panels() : 0, 0}))
        act(action, subject, posed, document);
      name_place(document, plays ? "play" : word);
      ImGui::SameLine();
    }
    ImGui::SetNextItemWidth(5 * em_panels());
    float speed = document.speed;
    if (ImGui::SliderFloat("##speed", &speed, 0.1f, 2, "")) document.speed = speed;
    ImGui::SameLine();
    ImGui::Text("x %.1f", document.speed);
    const int frame = frame_of(subject, document);
    int number = frame + 1;
    ImGui::SameLine();
    if (ImGui::Button("in")) mark(subject, &ViewDocument::in, document);
    ImGui::SameLine();
    if (ImGui::Button("out")) mark(subject, &ViewDocument::out, document);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(4 * em_panels());
    if (ImGui::InputInt("##number", &number, 0, 0, ImGuiInputTextFlags_EnterReturnsTrue))
      go_to(subject, number - 1, document);
    ImGui::SameLine();
    const std::string time = fmt::format("/ {}   {:.2f} / {:.2f} s", subject.frames,
                                         frame / subject.fps, (subject.frames - 1) / subject.fps);
    ImGui::TextUnformatted(time.c_str());
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderInt("##frame", &number, 1, subject.frames, ""))
      go_to(subject, number - 1, document);
    name_place(document, "time");
    draw_marks(subject, document);
  }
  ImGui::End();
  return height + kEdge * em_panels();
}

void draw_help(ViewDocument& document, std::span<const KeyLine> more) {
  if (!document.help) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({28 * em_panels(), std::min(0.9f * size.y, 50 * em_panels())},
                           ImGuiCond_Appearing);
  if (ImGui::Begin("Keys", &document.help,
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
    if (ImGui::BeginTable("keys", 2)) {
      ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, 10 * em_panels());
      for (const KeyLine& key : more) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(key.name.c_str());
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", key.effect.c_str());
      }
      for (const ViewKey& key : view_keys()) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(key.name.data(), key.name.data() + key.name.size());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(key.effect.data(), key.effect.data() + key.effect.size());
      }
      ImGui::EndTable();
    }
  }
  ImGui::End();
}

PartInfo describe(const ViewSubject& subject, const PosedAnatomy& posed, std::uint32_t number) {
  const Part part = part_of(number);
  const Anatomy& a = *subject.anatomy;
  PartInfo info;
  info.name = part_name(a, number);
  info.label = part_label(a, number);
  if (info.name.empty()) return info;
  if (part.kind == Part::Kind::bone) info.joint = a.skeleton.joints[a.bones[part.index].joint].name;
  if (part.kind == Part::Kind::muscle) {
    const Muscle& muscle = a.muscles[part.index];
    info.origin = muscle.origin;
    info.insertion = muscle.insertion;
    info.group = muscle.group;
    info.layer = muscle.layer;
    info.volume = muscle.volume;
    int strips = 0;
    for (std::size_t k = 0; k < subject.model->strips.size() && k < posed.lengths.size(); ++k) {
      if (subject.model->strips[k].muscle != part.index) continue;
      info.length += posed.lengths[k];
      info.rest_length += subject.model->rest_lengths[k];
      ++strips;
    }
    if (strips > 0) info.length /= strips, info.rest_length /= strips;
  }
  return info;
}

ViewRoom draw_panels(const ViewSubject& subject, const PosedAnatomy& posed,
                     ViewDocument& document) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ViewRoom room{0, 0, size.x, size.y};
  draw_help(document);
  draw_file_panel(subject, document);
  if (!document.panels) return room;
  const float edge = kEdge * em_panels(), timeline = draw_timeline(subject, posed, document),
              bottom = size.y - timeline - edge;
  const float layers = draw_layers(subject, posed, document) + 0.3f * em_panels();
  draw_parts(subject, posed, layers, bottom, document);
  const MeasurePanel measures = draw_measure_panel(subject, edge, bottom, document);
  draw_selection(subject, posed, measures.width > 0 ? measures.bottom + 0.3f * em_panels() : edge,
                 document);
  const float left = kLeftColumn * em_panels() + 2 * edge,
              right = measures.width > 0 ? measures.width + 2 * edge : 0;
  draw_state(document, left, bottom);
  // In a small window the panels overlap the figure.
  if (size.x - left - right > 0.35f * size.x) room.x = left, room.width = size.x - left - right;
  room.height = std::max(size.y - timeline, 0.35f * size.y);
  return room;
}

}  // namespace ecorche
