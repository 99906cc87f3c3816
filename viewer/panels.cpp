#include "viewer/panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ecorche {
namespace {

constexpr float kSliderWidth = 130;  // pixels

const ImVec4 quiet(0.66f, 0.66f, 0.68f, 1);

void draw_layers(ViewDocument& document) {
  ImGui::SetNextWindowPos({12, 12}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({270, 0}, ImGuiCond_FirstUseEver);
  if (ImGui::Begin("Layers")) {
    ImGui::SliderFloat("skin", &document.look.skin, 0, 1, "%.2f");
    ImGui::SliderFloat("dissolve", &document.look.skin_dissolved, 0, 1, "%.2f");
    ImGui::SliderFloat("muscles", &document.look.muscles, 0, 1, "%.2f");
    ImGui::SliderFloat("bones", &document.look.bones, 0, 1, "%.2f");
    bool lengths = document.muscle_colors == MuscleColors::shortening;
    if (ImGui::Checkbox("colour-blind colours", &lengths)) document.muscle_colors = lengths ? MuscleColors::shortening : MuscleColors::flesh;
    for (const auto& [word, activity] : {std::pair{"longer", -1.0f}, {"at rest", 0.0f}, {"shorter", 1.0f}}) {
      const Vec3f c = muscle_color(document.muscle_colors, activity);
      ImGui::ColorButton(word, ImVec4(c.x(), c.y(), c.z(), 1), ImGuiColorEditFlags_NoTooltip, {14, 14});
      ImGui::SameLine();
      ImGui::TextUnformatted(word);
      if (activity < 1) ImGui::SameLine();
    }
    ImGui::Checkbox("ground", &document.ground);
    ImGui::SameLine();
    ImGui::Checkbox("follow", &document.follow);
    for (const auto& [name, azimuth] : {std::pair{"front", 0.0f}, {"left", 1.5708f}, {"back", 3.1416f}, {"right", -1.5708f}}) {
      if (ImGui::Button(name)) document.azimuth = azimuth, document.elevation = 0;
      ImGui::SameLine();
    }
    ImGui::NewLine();
    ImGui::TextColored(quiet, "drag: turn, shift+drag: move\nwheel: nearer, click: pick\nspace: play, arrows: step, F: frame");
  }
  ImGui::End();
}

void draw_fact(const char* name, const std::string& value) {
  if (value.empty()) return;
  ImGui::TextColored(quiet, "%s", name);
  ImGui::TextWrapped("%s", value.c_str());
}

void draw_selection(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document) {
  if (part_of(document.selected).kind == Part::Kind::none) return;
  const PartInfo info = describe(subject, posed, document.selected);
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - 312, 12}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({300, 0}, ImGuiCond_Always);
  if (ImGui::Begin("Selected", nullptr, ImGuiWindowFlags_NoResize)) {
    ImGui::TextWrapped("%s", info.label.c_str());
    if (info.name != info.label) ImGui::TextColored(quiet, "%s", info.name.c_str());
    draw_fact("rides on", info.joint);
    draw_fact("origin", info.origin);
    draw_fact("insertion", info.insertion);
    if (info.rest_length > 0)
      draw_fact("length", fmt::format("{:.1f} cm ({:+.0f} % of rest)", 100 * info.length, 100 * (info.length / info.rest_length - 1)));
    if (info.volume > 0) draw_fact("volume", fmt::format("{:.0f} ml", 1e6 * info.volume));
    if (ImGui::Button("let go")) document.selected = 0;
  }
  ImGui::End();
}

void draw_parts(const ViewSubject& subject, ViewDocument& document) {
  ImGui::SetNextWindowPos({12, 290}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({270, 300}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowCollapsed(true, ImGuiCond_FirstUseEver);
  if (ImGui::Begin("Parts")) {
    static ImGuiTextFilter filter;
    filter.Draw("find", 200);
    ImGui::BeginChild("list");
    auto entry = [&](const std::string& label, std::uint32_t part) {
      if (!filter.PassFilter(label.c_str())) return;
      ImGui::PushID(static_cast<int>(part));
      if (ImGui::Selectable(label.c_str(), document.selected == part)) document.selected = part;
      ImGui::PopID();
    };
    const Anatomy& a = subject.anatomy;
    for (std::size_t m = 0; m < a.muscles.size(); ++m) entry(a.muscles[m].name, kFirstMusclePart + static_cast<std::uint32_t>(m));
    for (std::size_t b = 0; b < a.bones.size(); ++b) entry(a.bones[b].name, kFirstBonePart + static_cast<std::uint32_t>(b));
    ImGui::EndChild();
  }
  ImGui::End();
}

// A tick beside what is asked for; what is not follows, and shows what it is.
void draw_sliders(const ViewSubject& subject, ViewDocument& document) {
  if (subject.sliders.empty() || document.asked.size() != subject.sliders.size() || document.achieved.size() != subject.sliders.size()) return;
  // As wide as its longest line, with the value that a slider reads when it misses what is asked.
  float widest = 0;
  for (const Slider& slider : subject.sliders) widest = std::max(widest, ImGui::CalcTextSize((slider.name + ": 000.0").c_str()).x);
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width = widest + kSliderWidth + ImGui::GetFrameHeight() + 2 * style.ItemSpacing.x + 2 * style.WindowPadding.x;
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - width - 12, 12}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({width, 0}, ImGuiCond_Always);
  if (ImGui::Begin("Measures")) {
    for (std::size_t i = 0; i < subject.sliders.size(); ++i) {
      const Slider& slider = subject.sliders[i];
      std::optional<double>& asked = document.asked[i];
      ImGui::PushID(static_cast<int>(i));
      bool held = asked.has_value();
      if (ImGui::Checkbox("##asked", &held)) asked = held ? std::optional(document.achieved[i]) : std::nullopt;
      ImGui::SameLine();
      float value = static_cast<float>(slider.scale * asked.value_or(document.achieved[i]));
      const std::string format = slider.scale * slider.high < 10 ? "%.2f " + slider.unit : "%.1f " + slider.unit;
      ImGui::SetNextItemWidth(kSliderWidth);
      if (ImGui::SliderFloat("##value", &value, static_cast<float>(slider.scale * slider.low), static_cast<float>(slider.scale * slider.high),
                             slider.unit == "%" ? "%.1f %%" : format.c_str()))
        asked = value / slider.scale;
      ImGui::SameLine();
      const double off = asked ? document.achieved[i] - *asked : 0;
      ImGui::TextUnformatted(std::abs(off) > 1e-3 * slider.high ? fmt::format("{}: {:.1f}", slider.name, slider.scale * document.achieved[i]).c_str() : slider.name.c_str());
      ImGui::PopID();
    }
    if (ImGui::Button("let all go")) document.asked.assign(subject.sliders.size(), std::nullopt);
  }
  ImGui::End();
}

void draw_timeline(const ViewSubject& subject, ViewDocument& document) {
  if (subject.frames < 2) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({12, size.y - 58}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({std::max(size.x - 24, 120.0f), 46}, ImGuiCond_Always);
  if (ImGui::Begin("time", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    if (ImGui::Button(document.playing ? "pause" : " play ")) document.playing = !document.playing;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(90);
    float speed = static_cast<float>(document.speed);
    if (ImGui::SliderFloat("##speed", &speed, 0.1f, 2, "x %.1f")) document.speed = speed;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    int frame = frame_of(subject, document);
    if (ImGui::SliderInt("##frame", &frame, 0, subject.frames - 1, fmt::format("{:.2f} s", frame / subject.fps).c_str()))
      document.time = frame / subject.fps;
  }
  ImGui::End();
}

}  // namespace

PartInfo describe(const ViewSubject& subject, const PosedAnatomy& posed, std::uint32_t number) {
  const Part part = part_of(number);
  const Anatomy& a = subject.anatomy;
  PartInfo info;
  if (part.kind == Part::Kind::skin) info.name = info.label = "skin";
  if (part.kind == Part::Kind::bone && part.index < static_cast<int>(a.bones.size())) {
    const Bone& bone = a.bones[part.index];
    info.name = bone.name;
    info.label = bone.name;
    std::replace(info.label.begin(), info.label.end(), '_', ' ');
    info.joint = a.skeleton.joints[bone.joint].name;
  }
  if (part.kind == Part::Kind::muscle && part.index < static_cast<int>(a.muscles.size())) {
    const Muscle& muscle = a.muscles[part.index];
    info = {.name = muscle.name, .label = muscle.label, .joint = {}, .origin = muscle.origin, .insertion = muscle.insertion,
            .group = muscle.group, .layer = muscle.layer, .volume = muscle.volume};
    int strips = 0;
    for (std::size_t k = 0; k < subject.model.strips.size() && k < posed.lengths.size(); ++k) {
      if (subject.model.strips[k].muscle != part.index) continue;
      info.length += posed.lengths[k];
      info.rest_length += subject.model.rest_lengths[k];
      ++strips;
    }
    if (strips > 0) info.length /= strips, info.rest_length /= strips;
  }
  return info;
}

void draw_panels(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document) {
  draw_layers(document);
  draw_parts(subject, document);
  draw_sliders(subject, document);
  draw_selection(subject, posed, document);
  draw_timeline(subject, document);
}

}  // namespace ecorche
