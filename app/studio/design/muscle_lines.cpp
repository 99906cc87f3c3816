#include "app/studio/design/muscle_lines.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/design/fields.h"

namespace ecorche {
namespace {

float em_lines() { return ImGui::GetFontSize(); }

struct StripAt {
  DesignSession& session;
  const Document& document;
  const TableMuscle& muscle;
  int strip;  // from 1
  ViewDocument& view;

  const TableStrip& table() const { return muscle.strips[std::size_t(strip - 1)]; }
  // " MUSCLE strip=N", the strip left away where there is one only
  std::string words() const {
    return muscle.strips.size() > 1 ? fmt::format(" {} strip={}", muscle.name, strip)
                                    : " " + muscle.name;
  }
};

void draw_points(const StripAt& at, PanelState& state) {
  const std::vector<TablePoint>& path = at.table().path;
  if (!ImGui::BeginTable("points", 3)) return;
  ImGui::TableSetupColumn("n", ImGuiTableColumnFlags_WidthFixed, 1.6f * em_lines());
  ImGui::TableSetupColumn("place");
  ImGui::TableSetupColumn("do", ImGuiTableColumnFlags_WidthFixed, 3.4f * em_lines());
  for (int i = 0; i < int(path.size()); ++i) {
    ImGui::PushID(i);
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const bool first = i == 0, last = i + 1 == int(path.size());
    const bool hovered = state.hovered >= 0 && state.hovered < int(state.handles.size()) &&
                         state.handles[std::size_t(state.hovered)].kind == Handle::Kind::point &&
                         state.handles[std::size_t(state.hovered)].strip == at.strip - 1 &&
                         state.handles[std::size_t(state.hovered)].point == i;
    ImGui::TextColored(
        hovered ? ImVec4(1, 0.85f, 0.3f, 1) : ImGui::GetStyle().Colors[ImGuiCol_Text], "%s",
        first  ? "O"
        : last ? "I"
               : fmt::format("{}", i + 1).c_str());
    help_of_last(first ? "origin" : last ? "insertion" : "a point that the line goes through");
    ImGui::TableNextColumn();
    const TablePoint& point = path[std::size_t(i)];
    const std::string now = place_text(*at.document.frame, point.landmark, point.offset);
    if (const auto text = value_field("##place", now, -1))
      at.session.run(
          fmt::format("move_point{} point={} to={}", at.words(), i + 1, ecorche::quoted(*text)),
          "line");
    name_place(at.view, fmt::format("place:{}:{}", at.strip, i + 1));
    help_of_last(now + "\nLANDMARK, LANDMARK+LEFT,UP,FRONT (mm), or BONE@LEFT,UP,FRONT");
    ImGui::TableNextColumn();
    if (!last && ImGui::SmallButton("+")) {
      const Vec3 here = position(*at.document.frame, point);
      const Vec3 half = 0.5 * (position(*at.document.frame, path[std::size_t(i + 1)]) - here);
      at.session.run(
          fmt::format("add_point{} at={} after={}", at.words(),
                      place_text(*at.document.frame, point.landmark, point.offset + half), i + 1),
          "line");
    }
    if (!last) help_of_last("one more point between this and the next");
    if (first || last) {
      if (first) ImGui::SameLine();
      if (ImGui::SmallButton("@"))
        state.bone_click =
            BoneClick{.what = BoneClick::For::point, .strip = at.strip, .point = i + 1};
      name_place(at.view, fmt::format("click:{}:{}", at.strip, i + 1));
      help_of_last("put it where you click on a bone");
    }
    if (!first && !last) {
      ImGui::SameLine();
      if (ImGui::SmallButton("x"))
        at.session.run(fmt::format("remove_point{} point={}", at.words(), i + 1), "line");
      help_of_last("take the point away");
    }
    ImGui::PopID();
  }
  ImGui::EndTable();
}

void draw_sections(const StripAt& at) {
  const TableStrip& strip = at.table();
  if (!ImGui::BeginTable("sections", 4)) return;
  ImGui::TableSetupColumn("at", ImGuiTableColumnFlags_WidthFixed, 2.8f * em_lines());
  ImGui::TableSetupColumn("wide");
  ImGui::TableSetupColumn("thick");
  ImGui::TableSetupColumn("x", ImGuiTableColumnFlags_WidthFixed, 1.6f * em_lines());
  for (const char* head : {"at", "width", "thickness", ""}) {
    ImGui::TableNextColumn();
    quiet_text(head);
  }
  for (std::size_t i = 0; i < strip.sections.size(); ++i) {
    const TableSection& section = strip.sections[i];
    ImGui::PushID(int(i));
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::Text("%.0f %%", 100 * section.s);
    const auto side = [&](const char* key, double radius) {
      ImGui::TableNextColumn();
      const std::string now = fmt::format("{:.4g} mm", 2e3 * radius);
      if (const auto text = value_field(fmt::format("##{}", key), now, -1))
        at.session.run(fmt::format("set_section{} at={:.4g} {}={}", at.words(), section.s, key,
                                   ecorche::quoted(*text)),
                       "line");
      name_place(at.view, fmt::format("{}:{}:{}", key, at.strip, i + 1));
    };
    side("width", section.radii.x());
    side("thickness", section.radii.y());
    ImGui::TableNextColumn();
    if (i > 0 && i + 1 < strip.sections.size() && ImGui::SmallButton("x"))
      at.session.run(fmt::format("remove_section{} at={:.4g}", at.words(), section.s), "line");
    ImGui::PopID();
  }
  ImGui::EndTable();
}

void draw_belly(const StripAt& at) {
  const TableStrip& strip = at.table();
  ImGui::TextUnformatted("flesh begins, and ends (share of the line)");
  action_slider(at.session, "##begin", strip.belly_begin, 0, 0.98, "%.2f",
                fmt::format("set_belly{} begin=", at.words()), "line");
  action_slider(at.session, "##end", strip.belly_end, 0.02, 1, "%.2f",
                fmt::format("set_belly{} end=", at.words()), "line");
}

void draw_wraps(const StripAt& at) {
  const TableStrip& strip = at.table();
  for (const TableStrip::WrapUse& use : strip.wraps) {
    const TableWrap& wrap = at.document.frame->wraps[std::size_t(use.wrap)];
    ImGui::PushID(use.wrap);
    ImGui::AlignTextToFramePadding();
    ImGui::Text("slides over %s", wrap.name.c_str());
    if (wrap.kind != Wrap::Kind::ellipsoid) {
      ImGui::SameLine();
      const double radius = use.radius > 0 ? use.radius : wrap.radii.x();
      if (const auto text =
              value_field("##radius", fmt::format("{:.4g} mm", 1e3 * radius), 5 * em_lines()))
        at.session.run(use.radius > 0 ? fmt::format("use_wrap{} wrap={} radius={}", at.words(),
                                                    wrap.name, ecorche::quoted(*text))
                                      : fmt::format("set_wrap {} radius={}", wrap.name,
                                                    ecorche::quoted(*text)),
                       "line");
      help_of_last("its radius");
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("x"))
      at.session.run(fmt::format("leave_wrap{} wrap={}", at.words(), wrap.name), "line");
    help_of_last("slide over it no more");
    ImGui::PopID();
  }
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##wraps", "slide over ...")) return;
  for (const TableWrap& wrap : at.document.frame->wraps)
    if (ImGui::Selectable(wrap.name.c_str()))
      at.session.run(fmt::format("use_wrap{} wrap={}", at.words(), wrap.name), "line");
  ImGui::EndCombo();
}

}  // namespace

std::string place_text(const MuscleTable& frame, int landmark, const Vec3& offset) {
  const std::string& id = frame.landmarks[std::size_t(landmark)].id;
  if (offset.isZero(5e-5)) return id;
  const Vec3 mm = 1e3 * offset;
  return fmt::format("{}+{:.4g},{:.4g},{:.4g}", id, mm.x() + 0.0, mm.y() + 0.0, mm.z() + 0.0);
}

void draw_muscle_lines(DesignSession& session, PanelState& state, const TableMuscle& muscle,
                       ViewDocument& document) {
  const Document held = session.seen();
  ImGui::Checkbox("points", &state.points);
  ImGui::SameLine();
  ImGui::Checkbox("sections", &state.sections);
  ImGui::SameLine();
  ImGui::Checkbox("wraps", &state.wraps);
  ImGui::Checkbox("drags move one side only", &state.one_side);
  quiet_text("Drag a point in the figure, or type a place.");
  for (const bool origin : {true, false}) {
    if (ImGui::SmallButton(origin ? "paint its origin" : "paint its insertion"))
      state.bone_click = BoneClick{.what = BoneClick::For::area, .paints_origin = origin};
    name_place(document, origin ? "paint origin" : "paint insertion");
    help_of_last("As an area of bone: its strips are spread over it");
    if (origin) ImGui::SameLine();
  }
  show_fault(session, "line");
  const int strips = int(muscle.strips.size());
  for (int k = 1; k <= strips; ++k) {
    ImGui::PushID(k);
    const StripAt at{session, held, muscle, k, document};
    const bool open = strips == 1 || ImGui::TreeNodeEx(fmt::format("strip {}", k).c_str(),
                                                       k == 1 ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    if (open) {
      draw_points(at, state);
      if (ImGui::TreeNode("sections")) {
        draw_sections(at);
        draw_belly(at);
        ImGui::TreePop();
      }
      if (ImGui::TreeNode("wraps")) {
        draw_wraps(at);
        ImGui::TreePop();
      }
      if (ImGui::SmallButton("strip beside it"))
        session.run(fmt::format("add_strip {} like={}", muscle.name, k), "line");
      if (strips > 1) {
        ImGui::SameLine();
        if (ImGui::SmallButton("remove strip"))
          session.run(fmt::format("remove_strip {} strip={}", muscle.name, k), "line");
        ImGui::TreePop();
      }
    }
    ImGui::PopID();
  }
}

}  // namespace ecorche
