#include "app/studio/design/dropped_files.h"

#include <imgui.h>

#include <string>
#include <vector>

#include "anatomy/base_mesh/skin_import.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/edit/project.h"
#include "app/files/open_motion.h"
#include "app/studio/handles/dropped_bone.h"
#include "app/studio/handles/handles.h"
#include "morph/placement/bone_groups.h"
#include "skinning/files/character_read.h"
#include "skinning/motion_files/read_motion.h"

namespace ecorche {

void open_dropped(DesignSession& session, PanelState& state, const std::filesystem::path& file) {
  if (names_motion(file) || is_project(file) || has_body_notes(file)) {
    session.run(
        (names_motion(file) ? "play_motion " : "set_body ") + ecorche::quoted(file.string()),
        "view");
    return;
  }
  session.forget_fault();
  try {
    const MeshFile mesh = read_mesh_file(file);
    if (has_base_skin(mesh, session.workshop().package())) {
      session.run("set_body " + ecorche::quoted(file.string()), "view");
      return;
    }
    std::vector<std::string> taken = session.workshop().bone_names();
    for (const SourceLandmark& landmark : session.seen().frame->landmarks)
      taken.push_back(landmark.id);
    state.dropped = dropped_bone(file, mesh, taken);
    state.asks_tab = "Joints";
  } catch (const std::exception& error) {
    session.refuse(error, "view");
  }
}

void guess_joint(DesignSession& session, PanelState& state, const PosedAnatomy* posed,
                 const WindowEvent& event, const ViewProjection& view) {
  if (!posed || !state.joint.empty() || ImGui::GetIO().WantCaptureMouse) return;
  std::vector<Handle> joints;
  add_joints(session.anatomy().skeleton, *posed, joints);
  float least = 6 * ImGui::GetFontSize();
  for (const Handle& handle : joints) {
    const auto at = view.pixel(handle.place.cast<float>());
    const std::string& name = session.anatomy().skeleton.joints[std::size_t(handle.joint)].name;
    if (!at || !session.has_joint(name)) continue;
    const float distance = (*at - Vec2f(event.x, event.y)).norm();
    if (distance >= least) continue;
    least = distance;
    state.joint = split_side(name).first;
  }
}

}  // namespace ecorche
