#include "app/studio/design/motion_curves.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "app/studio/design/fields.h"

namespace ecorche {
namespace {

constexpr ImU32 kNow = IM_COL32(250, 205, 60, 255), kLine = IM_COL32(230, 230, 225, 255),
                kKey = IM_COL32(120, 190, 255, 255), kField = IM_COL32(38, 40, 44, 255);

float em_curves() { return ImGui::GetFontSize(); }

struct PlotBox {
  ImVec2 from, to;

  float x(double share) const { return from.x + float(share) * (to.x - from.x); }
  float y(double share) const { return to.y - float(share) * (to.y - from.y); }
  double share_of_x(float x) const {
    return std::clamp(double((x - from.x) / (to.x - from.x)), 0.0, 1.0);
  }
  double share_of_y(float y) const {
    return std::clamp(double((to.y - y) / (to.y - from.y)), 0.0, 1.0);
  }
};

// A field of the panel's width that takes the mouse.
PlotBox plot_box(const char* id, float height) {
  ImGui::InvisibleButton(id, {std::max(ImGui::GetContentRegionAvail().x, 10.0f), height},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  const PlotBox box{ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
  ImGui::GetWindowDrawList()->AddRectFilled(box.from, box.to, kField);
  return box;
}

void draw_moment(const PlotBox& box, double moment) {
  ImGui::GetWindowDrawList()->AddLine({box.x(moment), box.from.y}, {box.x(moment), box.to.y}, kNow,
                                      2);
}

struct CurveName {
  const char *name, *unit;
  double scale;  // shown: value * scale
  const char* format;
};

// A curve with its range, and a line at the moment that is shown.
void draw_curve(const CurveName& name, const std::vector<double>& values, std::size_t frames,
                double moment) {
  if (values.empty()) return;
  const auto [low, high] = std::ranges::minmax(values);
  const std::size_t now =
      std::min(std::size_t(moment * double(frames - 1) + 0.5), values.size() - 1);
  const auto number = [&](double value) {
    return fmt::format(fmt::runtime(name.format), name.scale * value);
  };
  ImGui::TextUnformatted(fmt::format("{} {} {}, {} to {}", name.name, number(values[now]),
                                     name.unit, number(low), number(high))
                             .c_str());
  const PlotBox box = plot_box(name.name, 2.6f * em_curves());
  const double range = std::max(high - low, 1e-12);
  std::vector<ImVec2> line;
  for (std::size_t k = 0; k < values.size(); ++k)
    line.emplace_back(box.x(double(k) / double(std::max<std::size_t>(frames - 1, 1))),
                      box.y(0.06 + 0.88 * (values[k] - low) / range));
  ImGui::GetWindowDrawList()->AddPolyline(line.data(), int(line.size()), kLine, 0, 1.5f);
  draw_moment(box, moment);
}

std::vector<double> known_arms(const MuscleCurves& curves) {
  std::vector<double> out;
  for (const auto& arm : curves.moment_arms) out.push_back(arm.value_or(0));
  return out;
}

// Where a person draws the activation: a click makes a key, a drag moves one, the right button
// takes one away.
class EffortField {
 public:
  EffortField(DesignSession& session, PanelState& state, const std::string& muscle, double seconds)
      : session_(session), state_(state), muscle_(muscle), seconds_(seconds) {}

  void draw(double moment, ViewDocument& document) {
    ImGui::TextUnformatted("activation");
    help_of_last("Click: a key here. Drag a key: move it. Right button: take it away");
    box_ = plot_box("##effort", 4 * em_curves());
    name_place(document, "effort curve");
    const bool hovered = ImGui::IsItemHovered();
    const auto& efforts = session_.seen().trial->activations;
    const auto own = efforts.find(muscle_);
    const TriedEffort effort = own == efforts.end() ? TriedEffort{} : own->second;
    draw_line(effort);
    draw_moment(box_, moment);
    const std::optional<double> near =
        hovered || state_.effort_key ? key_at_mouse(effort) : std::nullopt;
    if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Right) && near)
      session_.run(fmt::format("relax {} at={:.4g}s", muscle_, *near), "effort");
    if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
      // a key that is not there yet comes from where it is made
      state_.effort_key = near.value_or(-1);
      state_.effort_begun = !near;
    }
    if (state_.effort_key) drag();
  }

 private:
  void draw_line(const TriedEffort& effort) {
    std::vector<ImVec2> line;
    if (effort.keys.empty()) {
      line = {{box_.x(0), box_.y(effort.value)}, {box_.x(1), box_.y(effort.value)}};
    } else {
      line.emplace_back(box_.x(0), box_.y(effort.keys.begin()->second));
      for (const auto& [at, value] : effort.keys)
        line.emplace_back(box_.x(std::min(at / seconds_, 1.0)), box_.y(value));
      line.emplace_back(box_.x(1), box_.y(effort.keys.rbegin()->second));
    }
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddPolyline(line.data(), int(line.size()), kLine, 0, 1.5f);
    for (const auto& [at, value] : effort.keys)
      list.AddCircleFilled({box_.x(std::min(at / seconds_, 1.0)), box_.y(value)},
                           0.3f * em_curves(), kKey);
  }

  std::optional<double> key_at_mouse(const TriedEffort& effort) const {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    std::optional<double> out;
    float least = 0.6f * em_curves();
    for (const auto& [at, value] : effort.keys) {
      const float distance =
          std::hypot(box_.x(std::min(at / seconds_, 1.0)) - mouse.x, box_.y(value) - mouse.y);
      if (distance >= least) continue;
      least = distance;
      out = at;
    }
    return out;
  }

  void drag() {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool fresh = *state_.effort_key < 0;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left)) state_.effort_begun = true;
    const double at = seconds_ * box_.share_of_x(mouse.x);
    std::string line =
        fmt::format("activate {} value={:.2f} at={:.3f}s", muscle_, box_.share_of_y(mouse.y), at);
    if (!fresh) line += fmt::format(" from={:.4g}s", *state_.effort_key);
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
      if (state_.effort_begun) session_.try_line(line, "effort");
      return;
    }
    if (state_.effort_begun) session_.run(line, "effort");
    state_.effort_key.reset();
  }

  DesignSession& session_;
  PanelState& state_;
  const std::string muscle_;
  const double seconds_;
  PlotBox box_{};
};

}  // namespace

void draw_motion_curves(DesignSession& session, PanelState& state, ViewDocument& document) {
  const Motion& motion = *session.shown().motion;
  const std::size_t frames = motion.frames.size();
  const double seconds = double(frames - 1) / motion.fps;
  const double moment = std::clamp(document.time / seconds, 0.0, 1.0);
  EffortField(session, state, session.seen().picked, seconds).draw(moment, document);
  show_fault(session, "effort");
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##about", kAngleNames[std::size_t(state.curve_axis)])) {
    for (int axis = 0; axis < 3; ++axis)
      if (ImGui::Selectable(kAngleNames[std::size_t(axis)], axis == state.curve_axis))
        state.curve_axis = axis;
    ImGui::EndCombo();
  }
  help_of_last("The angle of the moment arm; its joint is the one chosen under Joints");
  const MuscleCurves& curves = session.curves(state.joint, state.curve_axis);
  draw_curve({"length", "mm", 1e3, "{:.1f}"}, curves.lengths, frames, moment);
  draw_curve({"speed", "mm/s", 1e3, "{:.0f}"}, curves.speeds, frames, moment);
  if (!state.joint.empty())
    draw_curve({"moment arm", "mm", 1e3, "{:.1f}"}, known_arms(curves), frames, moment);
  draw_curve({"force", "N", 1, "{:.0f}"}, curves.forces, frames, moment);
  draw_curve({"bulge", "of the width at rest", 1, "{:.3f}"}, curves.bulges, frames, moment);
  quiet_text("export FILE.csv writes them.");
}

}  // namespace ecorche
