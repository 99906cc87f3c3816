// The picked muscle over the motion: its activation, to be drawn by hand, and what is measured.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// Precondition: a motion is played, of two frames at least.
void draw_motion_curves(DesignSession& session, PanelState& state, ViewDocument& document);

}  // namespace ecorche
