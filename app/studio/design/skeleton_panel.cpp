#include "app/studio/design/skeleton_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/edit/palpable_points.h"
#include "app/studio/design/fields.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

// Points of the body that is shown.
void draw_palpable(DesignSession& session, PanelState&, ViewDocument&) {
  const std::vector<LandmarkDepth> off = points_off(session.shown().landmarks);
  if (session.shown().landmarks.empty())
    quiet_text("The body is still being fitted.");
  else if (off.empty())
    quiet_text("All lie as deep as people have them.");
  for (const LandmarkDepth& point : off) fault_text(point_text(point));
}

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
  show_fault(session, "own");
  if (state.joint.empty()) {
    quiet_text("Choose a joint above to hang a new one on it.");
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
                  "new joint"))
    state.joint_name.clear(), state.joint_place.clear();
  show_fault(session, "new joint");
}

void draw_own_bones(DesignSession& session, PanelState& state, ViewDocument& document) {
  const EditedSkeleton own = *session.seen().skeleton;
  for (const OwnBone& bone : own.bones) {
    ImGui::PushID(bone.name.c_str());
    if (ImGui::SmallButton("x")) session.run("remove_bone " + bone.name, "bone");
    ImGui::SameLine();
    ImGui::Text("%s, on %s", spaced(bone.name).c_str(), spaced(bone.joint).c_str());
    const std::string where = "bone:" + bone.name;
    if (const auto at = place_field(session, "##at", bone.at, ArgumentUnit::millimetre, where)) {
      const Vec3 by = *at - bone.at;
      session.run(
          fmt::format("set_bone {} by={:.4g},{:.4g},{:.4g}", bone.name, by.x(), by.y(), by.z()),
          where);
    }
    name_place(document, "bone:" + bone.name);
    if (session.fault().where != where)  // which stands where the tooltip would
      help_of_last("From the joint's centre to the left, up, to the front, mm");
    show_fault(session, where);
    ImGui::PopID();
  }
  quiet_text("Drop a mesh of a bone into the window: OBJ, PLY, STL, OFF or GLB.");
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

void draw_joint_choice(DesignSession& session, PanelState& state) {
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##joint",
                         state.joint.empty() ? "choose a joint" : spaced(state.joint).c_str()))
    return;
  for (const std::string& name : session.joint_names())
    if (ImGui::Selectable(spaced(name).c_str(), name == state.joint)) state.joint = name;
  ImGui::EndCombo();
}

void draw_dropped_bone(DesignSession& session, PanelState& state, ViewDocument& document) {
  if (!state.dropped) return;
  DroppedBone& bone = *state.dropped;
  ImGui::TextWrapped("%s",
                     fmt::format("{}: a bone of your own?", bone.file.filename().string()).c_str());
  quiet_text("Which joint carries it?");
  ImGui::PushID("dropped");
  draw_joint_choice(session, state);
  ImGui::PopID();
  text_field("##dropped name", bone.name, "its name", -1);
  name_place(document, "dropped name");
  const auto large = [&](const char* unit) {
    const Vec3 mm = millimetres(bone, unit);
    return fmt::format("{}: {:.3g} x {:.3g} x {:.3g} mm large", unit, mm.x(), mm.y(), mm.z());
  };
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##unit", large(bone.unit.c_str()).c_str())) {
    for (const BoneUnit& unit : kBoneUnits)
      if (ImGui::Selectable(large(unit.name).c_str(), bone.unit == unit.name))
        bone.unit = unit.name;
    ImGui::EndCombo();
  }
  help_of_last("The unit of the file, and how large the bone is with it");
  ImGui::Checkbox("its middle at the joint", &bone.centred);
  help_of_last("Otherwise the file's origin lies at the joint's centre");
  bool done = false;
  if (state.joint.empty()) {
    quiet_text("Choose the joint to go on.");
  } else {
    if (ImGui::Button("hang it on")) done = session.run(line_of(bone, state.joint), "dropped");
    name_place(document, "hang it on");
    if (done) {
      session.say(fmt::format("{} hangs on {}: its place is under Bones of one's own",
                              spaced(bone.name), spaced(state.joint)));
      state.shows_bones = true;
    }
    ImGui::SameLine();
  }
  if (ImGui::Button("leave it")) done = true;
  name_place(document, "leave it");
  ImGui::SameLine();
  if (ImGui::Button("it is a body"))
    done = session.run("set_body " + ecorche::quoted(bone.file.string()), "dropped");
  show_fault(session, "dropped");
  ImGui::Separator();
  if (done) state.dropped.reset();
}

void draw_skeleton_panel(DesignSession& session, PanelState& state, ViewDocument& document) {
  const auto section = [&](const char* name, const auto& draw, bool shown = false) {
    if (shown) ImGui::SetNextItemOpen(true);
    const bool open = ImGui::CollapsingHeader(name);
    name_place(document, std::string("section:") + name);
    if (open) draw(session, state, document);
  };
  const std::size_t off = points_off(session.shown().landmarks).size();
  if (off > 0)
    fault_text(
        fmt::format("{} palpable {} of bones out of bounds", off, off == 1 ? "point" : "points"));
  section("Palpable points", draw_palpable);
  section("Measures of bones", draw_groups);
  section("Joints added and taken away", draw_own_joints);
  section("Bones of one's own", draw_own_bones, state.shows_bones);
  if (state.shows_bones) ImGui::SetScrollHereY(1);
  state.shows_bones = false;
}

}  // namespace ecorche
