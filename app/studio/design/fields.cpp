#include "app/studio/design/fields.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cstring>

namespace ecorche {
namespace {

const ImVec4 quiet_color(kQuietGrey, kQuietGrey, kQuietGrey + 0.02f, 1);
const ImVec4 fault_color(1.0f, 0.62f, 0.35f, 1);

// The field that is being written in: its text lives from frame to frame.
struct Writing {
  ImGuiID id = 0;
  char text[160] = "";
};
Writing& writing() {
  static Writing one;
  return one;
}

void copy_text(const std::string& from, char* to, std::size_t room) {
  std::strncpy(to, from.c_str(), room - 1);
  to[room - 1] = 0;
}

}  // namespace

std::optional<std::string> value_field(const std::string& id, const std::string& now, float width) {
  char text[sizeof(Writing::text)];
  const ImGuiID own = ImGui::GetID(id.c_str());
  Writing& held = writing();
  copy_text(held.id == own ? std::string(held.text) : now, text, sizeof text);
  ImGui::SetNextItemWidth(width);
  ImGui::InputText(id.c_str(), text, sizeof text, ImGuiInputTextFlags_AutoSelectAll);
  if (ImGui::IsItemActive()) {
    held.id = own;
    copy_text(text, held.text, sizeof held.text);
  }
  if (!ImGui::IsItemDeactivated()) return std::nullopt;
  const bool changed = held.id == own && ImGui::IsItemDeactivatedAfterEdit();
  if (held.id == own) held.id = 0;
  if (!changed || now == text) return std::nullopt;
  return std::string(text);
}

std::optional<Vec3> place_field(DesignSession& session, const std::string& id, const Vec3& now,
                                ArgumentUnit unit, const std::string& where) {
  auto text = value_field(id, fmt::format("{:.4g},{:.4g},{:.4g}", now.x(), now.y(), now.z()), -1);
  if (!text) return std::nullopt;
  std::erase(*text, ' ');
  session.forget_fault();
  try {
    Vec3 out = now;
    ArgumentReader({"place=" + *text}).vector("place", out, unit, Need::required, "left,up,front");
    return out;
  } catch (const std::exception& error) {
    session.refuse(error, where);
    return std::nullopt;
  }
}

std::optional<std::string> value_row(const std::string& key, const char* label,
                                     const std::string& now, const char* help) {
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  help_of_last(help);
  ImGui::TableNextColumn();
  return value_field("##" + key, now, -1);
}

bool text_field(const std::string& id, std::string& text, const std::string& hint, float width,
                bool focus) {
  char buffer[512];
  copy_text(text, buffer, sizeof buffer);
  if (focus) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(width);
  const bool entered = ImGui::InputTextWithHint(id.c_str(), hint.c_str(), buffer, sizeof buffer,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  text = buffer;
  return entered;
}

void action_slider(DesignSession& session, const std::string& id, double value, double low,
                   double high, const char* format, const std::string& line_before,
                   const std::string& where) {
  float shown = float(value);
  const auto line = [&] { return fmt::format("{}{:g}", line_before, double(shown)); };
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool moved = ImGui::SliderFloat(id.c_str(), &shown, float(low), float(high), format,
                                        ImGuiSliderFlags_AlwaysClamp);
  if (moved) {
    const float unit = high - low > 20 ? 1.0f : 0.01f;
    shown = unit * std::round(shown / unit);
    session.try_line(line(), where);
  }
  if (ImGui::IsItemDeactivatedAfterEdit()) session.keep_tried(where);
}

std::string spaced(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

void quiet_text(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, quiet_color);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

void fault_text(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, fault_color);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

void help_of_last(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(24 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void show_fault(DesignSession& session, const std::string& where) {
  const Fault& fault = session.fault();
  if (fault.text.empty() || fault.where != where) return;
  fault_text(fault.text);
  if (ImGui::IsItemVisible()) session.note_fault_seen();
}

void show_unseen_fault(DesignSession& session) {
  const Fault& fault = session.fault();
  if (!fault.text.empty() && !session.is_fault_seen()) fault_text(fault.text);
}

}  // namespace ecorche
