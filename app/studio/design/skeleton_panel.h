// The panel of joints below the chosen one: measures of groups of bones, joints and bones of one's
// own, what was taken away.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

void draw_skeleton_panel(DesignSession& session, PanelState& state, ViewDocument& document);

// Asks for the joint of a mesh that was dropped; nothing where none was.
void draw_dropped_bone(DesignSession& session, PanelState& state, ViewDocument& document);
// A choice of the joint that the panels show.
void draw_joint_choice(DesignSession& session, PanelState& state);

}  // namespace ecorche
