#include "app/studio/design/skeleton_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/design/fields.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

void draw_groups(DesignSession& session, PanelState& state, ViewDocument& document) {
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##group", state.group.empty() ? "choose a group of bones"
                                                       : spaced(state.group).c_str())) {
    for (const GroupRule& rule : session.workshop().base().tables.rules.groups)
      if (ImGui::Selectable(spaced(rule.name).c_str(), rule.name == state.group))
        state.group = rule.name;
    ImGui::EndCombo();
  }
  name_place(document, "group");
  show_fault(session, "group");
  if (state.group.empty()) {
    quiet_text("Length, width, taper, bow: what a hand makes of the bones that the skin asks for.");
    return;
  }
  const auto& groups = session.seen().skeleton->groups;
  const auto own = groups.find(state.group);
  const auto values = own == groups.end() ? GroupScale::unchanged() : own->second;
  if (ImGui::BeginTable("measures", 2)) {
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 8.5f * ImGui::GetFontSize());
    for (std::size_t k = 0; k < values.size(); ++k) {
      const GroupMeasure& measure = group_measures()[k];
      const std::string now = fmt::format("{:.4g} {}", values[k], measure.factor ? "times" : "mm");
      auto text = value_row(measure.name, spaced(measure.name).c_str(), now, measure.help);
      name_place(document, fmt::format("group:{}", measure.name));
      if (!text) continue;
      if (const auto word = text->find(" times"); word != std::string::npos) text->resize(word);
      session.run(
          fmt::format("set_group {} {}={}", state.group, measure.name, ecorche::quoted(*text)),
          "group");
    }
    ImGui::EndTable();
  }
  if (own != groups.end() && ImGui::Button("as the skin has it"))
    session.run("reset_group " + state.group, "group");
}

void draw_own_joints(DesignSession& session, PanelState& state, ViewDocument& document) {
  const EditedSkeleton own = *session.seen().skeleton;
  for (const OwnJoint& joint : own.joints) {
    ImGui::PushID(joint.name.c_str());
    if (ImGui::SmallButton("x")) session.run("remove_joint " + joint.name, "own");
    ImGui::SameLine();
    ImGui::Text("%s, on %s", spaced(joint.name).c_str(), spaced(joint.parent).c_str());
    ImGui::PopID();
  }
  for (const std::string& name : own.removed) {
    ImGui::PushID(name.c_str());
    if (ImGui::SmallButton("bring back")) session.run("restore_joint " + name, "own");
    ImGui::SameLine();
    ImGui::Text("%s was taken away", spaced(name).c_str());
    ImGui::PopID();
  }
  if (state.joint.empty()) {
    quiet_text("Choose a joint above to hang a new one or a bone on it.");
    return;
  }
  text_field("##joint name", state.joint_name, "name of a new joint: tail", -1);
  name_place(document, "new joint");
  const bool entered =
      text_field("##joint place", state.joint_place, "its place: coccyx+0,-20,-20; Enter", -1);
  name_place(document, "new joint place");
  help_of_last("A landmark and millimetres to the left, up and to the front, or BONE@L,U,F");
  if (entered && !state.joint_name.empty() && !state.joint_place.empty() &&
      session.run(fmt::format("add_joint {} {} at={}", ecorche::quoted(state.joint_name),
                              state.joint, ecorche::quoted(state.joint_place)),
                  "own"))
    state.joint_name.clear(), state.joint_place.clear();
  show_fault(session, "own");
}

void draw_own_bones(DesignSession& session, PanelState& state, ViewDocument& document) {
  const EditedSkeleton own = *session.seen().skeleton;
  for (const OwnBone& bone : own.bones) {
    ImGui::PushID(bone.name.c_str());
    if (ImGui::SmallButton("x")) session.run("remove_bone " + bone.name, "bone");
    ImGui::SameLine();
    ImGui::Text("%s, on %s", spaced(bone.name).c_str(), spaced(bone.joint).c_str());
    const std::string at =
        fmt::format("{:.4g},{:.4g},{:.4g}", bone.at.x(), bone.at.y(), bone.at.z());
    if (const auto text = value_field("##at", at, -1)) {
      double x = 0, y = 0, z = 0;
      if (std::sscanf(text->c_str(), "%lf,%lf,%lf", &x, &y, &z) == 3)
        session.run(fmt::format("set_bone {} by={:.4g},{:.4g},{:.4g}", bone.name, x - bone.at.x(),
                                y - bone.at.y(), z - bone.at.z()),
                    "bone");
    }
    help_of_last("From the joint's centre to the left, up, to the front, mm");
    ImGui::PopID();
  }
  if (!state.joint.empty()) {
    text_field("##bone name", state.bone_name, "name of a new bone: tail_bone", -1);
    name_place(document, "new bone");
    if (text_field("##bone file", state.bone_file, "its mesh: tail.obj unit=mm; Enter", -1) &&
        !state.bone_name.empty() && !state.bone_file.empty() &&
        session.run(fmt::format("add_bone {} {} file={}", ecorche::quoted(state.bone_name),
                                state.joint, state.bone_file),
                    "bone"))
      state.bone_name.clear(), state.bone_file.clear();
    name_place(document, "new bone file");
    help_of_last("OBJ, PLY, STL, OFF or GLB; unit=mm, up=z where the file does not say it");
  }
  show_fault(session, "bone");
}

}  // namespace

void draw_skeleton_panel(DesignSession& session, PanelState& state, ViewDocument& document) {
  const auto section = [&](const char* name, const auto& draw) {
    const bool open = ImGui::CollapsingHeader(name);
    name_place(document, std::string("section:") + name);
    if (open) draw(session, state, document);
  };
  section("Measures of bones", draw_groups);
  section("Joints added and taken away", draw_own_joints);
  section("Bones of one's own", draw_own_bones);
}

}  // namespace ecorche
