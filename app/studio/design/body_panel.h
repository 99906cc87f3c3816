// Panels of the body, the joints, and what is tried with them.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// Each within a window of ImGui.
void draw_body_panel(DesignSession& session, PanelState& state, ViewDocument& document);
void draw_joint_panel(DesignSession& session, PanelState& state, ViewDocument& document);
void draw_trial_panel(DesignSession& session, ViewDocument& document);

}  // namespace ecorche
