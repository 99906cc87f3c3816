#include "viewer/window/measure_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace ecorche {
namespace {

constexpr float kNumber = 3.8f, kUnit = 1.8f;  // of a letter's height

const ImVec4 missed(1.0f, 0.75f, 0.35f, 1);

float em() { return ImGui::GetFontSize(); }

// Where what is asked for is not reached, what is reached is said. known: `achieved` is of what is
// asked.
void draw_slider(const Slider& slider, double achieved, bool known, std::optional<double>& asked) {
  bool held = asked.has_value();
  if (ImGui::Checkbox("##asked", &held)) asked = held ? std::optional(achieved) : std::nullopt;
  ImGui::SameLine();
  const bool reached = !known || !asked || std::abs(*asked - achieved) <= 1e-3 * slider.high;
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(reached ? ImGui::GetStyleColorVec4(ImGuiCol_Text) : missed, "%s",
                     slider.name.c_str());
  const float right = ImGui::GetWindowContentRegionMax().x;
  float value = slider.scale * asked.value_or(achieved);
  ImGui::SameLine(right - (kNumber + kUnit) * em());
  ImGui::SetNextItemWidth(kNumber * em());
  const char* digits = slider.unit.empty() ? "%.2f" : "%.1f";
  if (ImGui::InputFloat("##number", &value, 0, 0, digits, ImGuiInputTextFlags_EnterReturnsTrue) &&
      std::isfinite(value))
    asked = std::clamp(value / slider.scale, slider.low, slider.high);
  ImGui::SameLine(right - (kUnit - 0.3f) * em());
  ImGui::TextUnformatted(slider.unit.c_str());
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, 0.05f * em()});
  ImGui::SetNextItemWidth(-1);
  const std::string words = reached ? ""
                                    : fmt::format("reaches {:.1f} {}", slider.scale * achieved,
                                                  slider.unit == "%" ? "%%" : slider.unit);
  if (ImGui::SliderFloat("##value", &value, float(slider.scale * slider.low),
                         float(slider.scale * slider.high), words.c_str()))
    asked = value / slider.scale;
  ImGui::PopStyleVar();
}

float widest_name(const ViewSubject& subject) {
  float widest = 0;
  for (const Slider& slider : subject.sliders)
    widest = std::max(widest, ImGui::CalcTextSize(slider.name.c_str()).x);
  return widest;
}

}  // namespace

MeasurePanel draw_measure_panel(const ViewSubject& subject, float top, float bottom,
                                ViewDocument& document) {
  const std::size_t count = subject.sliders.size();
  if (count == 0 || document.asked.size() != count || document.achieved.size() != count) return {};
  const ImGuiStyle& style = ImGui::GetStyle();
  const float numbers = (kNumber + kUnit) * em();
  const float width = widest_name(subject) + numbers + ImGui::GetFrameHeight() +
                      3 * style.ItemSpacing.x + 2 * style.WindowPadding.x;
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - width - top, top}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({width, 0}, ImGuiCond_Always);
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, std::max(bottom - top, 10 * em())});
  MeasurePanel panel{width, 0};
  constexpr ImGuiWindowFlags flags =
      ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {style.ItemSpacing.x, 0.12f * em()});
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {style.FramePadding.x, 0.08f * em()});
  if (ImGui::Begin("Measures", nullptr, flags)) {
    for (std::size_t i = 0; i < count; ++i) {
      ImGui::PushID(int(i));
      draw_slider(subject.sliders[i], document.achieved[i], !document.busy, document.asked[i]);
      ImGui::PopID();
    }
    if (ImGui::Button("let all go"))
      std::fill(document.asked.begin(), document.asked.end(), std::nullopt);
    ImGui::SameLine();
    if (subject.save && ImGui::Button("save...")) document.asking = ViewDocument::Asking::save;
  }
  panel.bottom = ImGui::GetWindowPos().y + ImGui::GetWindowHeight();
  ImGui::End();
  ImGui::PopStyleVar(2);
  return panel;
}

}  // namespace ecorche
