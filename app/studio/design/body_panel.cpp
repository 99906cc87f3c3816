#include "app/studio/design/body_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "anatomy/joint_angles.h"
#include "app/studio/design/fields.h"
#include "app/studio/design/recent_list.h"
#include "app/studio/design/skeleton_panel.h"
#include "morph/measures/measure_table.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

constexpr const char* kMeasures[] = {
    "stature",       "weight",      "chest_girth",        "waist_girth",
    "hip_girth",     "thigh_girth", "calf_girth",         "upper_arm_girth_relaxed",
    "forearm_girth", "neck_girth",  "biacromial_breadth", "crotch_height"};
constexpr const char* kMethods[] = {"ecorche", "paper"};

float em_body() { return ImGui::GetFontSize(); }

void measure_row(DesignSession& session, const std::string& name, ViewDocument& view) {
  const auto& targets = session.seen().body->targets;
  const auto own = targets.find(name);
  ImGui::PushID(name.c_str());
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(spaced(name).c_str());
  ImGui::TableNextColumn();
  const bool mass = name == "weight";
  const std::string now = own == targets.end() ? std::string("as the body has it")
                          : mass               ? fmt::format("{:.4g} kg", own->second)
                                               : fmt::format("{:.4g} cm", 1e2 * own->second);
  if (const auto text = value_field("##value", now, -1))
    session.run(fmt::format("set_measure {} {}", name, ecorche::quoted(*text)), "measures");
  name_place(view, "measure:" + name);
  ImGui::TableNextColumn();
  if (own != targets.end() && ImGui::SmallButton("x"))
    session.run("free_measure " + name, "measures");
  ImGui::PopID();
}

void fit_row(DesignSession& session, const char* key, const char* label, const std::string& now,
             const char* help) {
  if (const auto text = value_row(key, label, now, help))
    session.run(fmt::format("set_fit {}={}", key, ecorche::quoted(*text)), "fit");
}

void draw_fit(DesignSession& session) {
  const FitSettings fit = session.seen().fit;
  const int method = int(fit.method);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo(
          "##method",
          method < 2 ? fmt::format("muscles grow as: {}", kMethods[method]).c_str() : "method")) {
    for (const char* each : kMethods)
      if (ImGui::Selectable(each)) session.run(fmt::format("set_fit method={}", each), "fit");
    ImGui::EndCombo();
  }
  if (!ImGui::BeginTable("fit", 2)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 8.5f * em_body());
  fit_row(session, "alpha", "alpha", fmt::format("{:.4g}", fit.alpha),
          "Of the method paper: share of the length's change that muscles start with across");
  fit_row(session, "clearance", "clearance", fmt::format("{:.4g} mm", fit.clearance),
          "Kept between muscles and the layer over them");
  fit_row(session, "rays", "rays", fmt::format("{}", fit.rays), "Cast around each section");
  fit_row(session, "slices", "slices", fit.slices > 0 ? fmt::format("{}", fit.slices) : "by length",
          "Of every strip; 0: 12 to 24 by its length");
  ImGui::EndTable();
  show_fault(session, "fit");
}

const Joint* shown_joint(const Skeleton& skeleton, const std::string& name) {
  int found = find_joint(skeleton, name);
  if (found < 0) found = find_joint(skeleton, name + "_l");
  return found < 0 ? nullptr : &skeleton.joints[std::size_t(found)];
}

// Sliders of the three angles within their limits.
void draw_angles(DesignSession& session, const Joint& joint, const std::string& name,
                 ViewDocument& view) {
  const auto& angles = session.seen().trial->angles;
  const auto turned = angles.find(name);
  for (int axis = 0; axis < 3; ++axis) {
    const double low = joint.min[axis] / kDegree, high = joint.max[axis] / kDegree;
    if (high - low < 2) continue;
    const bool own = turned != angles.end() && std::isfinite(turned->second[axis]);
    const double now = own ? turned->second[axis] : joint.zero[axis] / kDegree;
    ImGui::TextUnformatted(kAngleNames[std::size_t(axis)]);
    action_slider(session, fmt::format("##turn{}", axis), now, low, high, "%.0f deg",
                  fmt::format("turn_joint {} {}=", name, kAngleNames[std::size_t(axis)]), "joint");
    name_place(view, fmt::format("turn:{}", kAngleNames[std::size_t(axis)]));
  }
}

void draw_limits(DesignSession& session, const Joint& joint, const std::string& name) {
  if (!ImGui::BeginTable("limits", 3)) return;
  ImGui::TableSetupColumn("axis", ImGuiTableColumnFlags_WidthFixed, 6 * em_body());
  for (int axis = 0; axis < 3; ++axis) {
    const double ends[] = {joint.min[axis] / kDegree, joint.max[axis] / kDegree};
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(kAngleNames[std::size_t(axis)]);
    for (const int end : {0, 1}) {
      ImGui::TableNextColumn();
      const auto text =
          value_field(fmt::format("##{}{}", axis, end), fmt::format("{:.4g} deg", ends[end]), -1);
      if (!text) continue;
      session.run(
          fmt::format("set_limits {} {} min={} max={}", name, kAngleNames[std::size_t(axis)],
                      end == 0 ? ecorche::quoted(*text) : fmt::format("{:.6g}", ends[0]),
                      end == 1 ? ecorche::quoted(*text) : fmt::format("{:.6g}", ends[1])),
          "joint");
    }
  }
  ImGui::EndTable();
}

void draw_chosen_joint(DesignSession& session, const Joint& joint, PanelState& state,
                       ViewDocument& document) {
  ImGui::TextUnformatted("Turn it");
  draw_angles(session, joint, state.joint, document);
  if (ImGui::Button("all joints as the pose has them")) {
    const std::string& pose = session.seen().trial->pose;
    session.run("pose " + (pose.empty() ? std::string("rest") : pose), "joint");
  }
  ImGui::Separator();
  ImGui::TextUnformatted("Limits, from and to");
  draw_limits(session, joint, state.joint);
  const auto& edits = *session.seen().joints;
  const auto edit = edits.find(state.joint);
  ImGui::TextUnformatted("Centre moved by left, up, front (mm)");
  const Vec3 moved = edit == edits.end() ? Vec3(Vec3::Zero()) : edit->second.moved;
  if (const auto to = place_field(session, "##moved", moved, ArgumentUnit::millimetre, "centre")) {
    const Vec3 by = *to - moved;
    session.run(
        fmt::format("move_joint {} by={:.4g},{:.4g},{:.4g}", state.joint, by.x(), by.y(), by.z()),
        "centre");
  }
  name_place(document, "centre");
  show_fault(session, "centre");
  if (ImGui::Button("where the skin says")) session.run("snap_joint " + state.joint, "joint");
  name_place(document, "snap");
  help_of_last("The centre goes where the skin's measures have it, as every fit takes it");
  ImGui::SameLine();
  ImGui::Checkbox("axes, to drag", &state.axes);
  name_place(document, "axes");
  if (edit != edits.end() && ImGui::Button("as it was built"))
    session.run("reset_joint " + state.joint, "joint");
  if (edit != edits.end()) ImGui::SameLine();
  if (ImGui::Button("take it away")) session.run("remove_joint " + state.joint, "take away");
  name_place(document, "take away");
  help_of_last("A finger, a toe, or a joint of one's own that nothing hangs on");
  show_fault(session, "take away");
  if (session.fault().where == "take away" &&
      session.fault().text.find("muscles=remove") != std::string::npos) {
    if (ImGui::Button("take its muscles away, too"))
      session.run(fmt::format("remove_joint {} muscles=remove", state.joint), "take away");
    name_place(document, "take muscles");
  }
}

}  // namespace

void draw_body_panel(DesignSession& session, PanelState& state, ViewDocument& document) {
  const EditedBody body = *session.seen().body;
  ImGui::TextWrapped(
      "%s", body.file.empty() ? "The template's own body" : body.file.filename().string().c_str());
  if (text_field("##file", state.body_file, "another body: FILE.glb, Enter", -1) &&
      !state.body_file.empty())
    session.run("set_body " + ecorche::quoted(state.body_file), "body");
  help_of_last("A body, a character, or a skin on the base mesh; none: the template's own");
  draw_recent(session, "body", "set_body", "body", document);
  show_fault(session, "body");
  ImGui::TextUnformatted("fat over the muscles");
  action_slider(session, "##layer", body.layer, 0.2, 2.5, "%.2f times", "set_layer ", "body");
  name_place(document, "layer");
  const bool sites = ImGui::TreeNode("by site");
  name_place(document, "layer sites");
  if (sites) {
    for (const std::string& site : session.workshop().fat_sites()) {
      const auto own = body.layer_sites.find(site);
      ImGui::PushID(site.c_str());
      ImGui::TextUnformatted(spaced(site).c_str());
      action_slider(session, "##site", own == body.layer_sites.end() ? 1 : own->second, 0.2, 3,
                    "%.2f times", fmt::format("set_layer site={} factor=", site), "body");
      name_place(document, "layer:" + site);
      ImGui::PopID();
    }
    ImGui::TreePop();
  }
  ImGui::Separator();
  ImGui::TextUnformatted("Measures");
  if (ImGui::BeginTable("measures", 3)) {
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 9 * em_body());
    ImGui::TableSetupColumn("value");
    ImGui::TableSetupColumn("x", ImGuiTableColumnFlags_WidthFixed, 1.6f * em_body());
    for (const char* name : kMeasures) measure_row(session, name, document);
    for (const auto& [name, value] : body.targets)
      if (std::ranges::find(kMeasures, name) == std::end(kMeasures))
        measure_row(session, name, document);
    ImGui::EndTable();
  }
  quiet_text("What is typed is asked for; all else follows what is most probable with it.");
  show_fault(session, "measures");
  ImGui::Separator();
  ImGui::TextUnformatted("How muscles grow to the skin");
  draw_fit(session);
}

void draw_joint_panel(DesignSession& session, PanelState& state, ViewDocument& document) {
  draw_dropped_bone(session, state, document);
  const Skeleton& skeleton = session.anatomy().skeleton;
  ImGui::Checkbox("centres in the figure, to drag", &state.joints);
  name_place(document, "joints");
  draw_joint_choice(session, state);
  name_place(document, "joint");
  const Joint* joint = state.joint.empty() ? nullptr : shown_joint(skeleton, state.joint);
  show_fault(session, "joint");
  if (joint)
    draw_chosen_joint(session, *joint, state, document);
  else if (state.joint.empty())
    quiet_text("Choose one, or show the centres and click one.");
  else
    quiet_text("It is there as soon as the body is fitted.");
  ImGui::Separator();
  draw_skeleton_panel(session, state, document);
}

void draw_trial_panel(DesignSession& session, ViewDocument& document) {
  const Trial trial = *session.seen().trial;
  ImGui::TextUnformatted("Pose");
  ImGui::SetNextItemWidth(-1);
  const std::string now = trial.pose.empty() ? std::string("rest") : trial.pose;
  if (ImGui::BeginCombo("##pose", spaced(now).c_str(), ImGuiComboFlags_HeightLarge)) {
    if (ImGui::Selectable("rest")) session.run("pose rest", "try");
    static const std::vector<std::string> poses = session.workshop().pose_names();
    for (const std::string& pose : poses)
      if (ImGui::Selectable(spaced(pose).c_str(), pose == now)) session.run("pose " + pose, "try");
    ImGui::EndCombo();
  }
  name_place(document, "pose");
  if (!trial.motion.empty()) {
    ImGui::TextWrapped("Motion: %s", trial.motion.filename().string().c_str());
    if (ImGui::Button("pose at this moment"))
      session.run(fmt::format("show_moment {:.4g}s", document.time), "try");
    help_of_last("What scripts and pictures show of the motion");
    ImGui::SameLine();
    if (ImGui::Button("no motion")) session.run("play_motion none", "try");
  } else {
    quiet_text("Drop a motion into the window, or Ctrl + O, to play it.");
  }
  draw_recent(session, "motion", "play_motion", "try", document);
  show_fault(session, "try");
  ImGui::Separator();
  ImGui::TextUnformatted("Activation");
  for (const auto& [name, effort] : trial.activations) {
    const std::string word = name == "*" ? "all" : ecorche::quoted(name);
    ImGui::PushID(name.c_str());
    if (ImGui::SmallButton("x")) session.run("relax " + word, "effort");
    help_of_last("Relax it");
    ImGui::SameLine();
    ImGui::TextUnformatted(name == "*" ? "every muscle" : name.c_str());
    if (effort.keys.empty())
      action_slider(session, "##value", effort.value, 0, 1, "%.2f",
                    fmt::format("activate {} value=", word), "effort");
    else
      quiet_text(fmt::format("a curve of {} keys over the motion", effort.keys.size()));
    ImGui::PopID();
  }
  static std::string wanted;
  if (text_field("##who", wanted, "a muscle, or biceps*, or all; Enter", -1) && !wanted.empty() &&
      session.run(fmt::format("activate {} value=1", ecorche::quoted(wanted)), "effort"))
    wanted.clear();
  show_fault(session, "effort");
}

}  // namespace ecorche
