// The card of the picked muscle: what it is, its figures and lines, in fields that are actions.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// Within a window of ImGui.
void draw_muscle_card(DesignSession& session, PanelState& state, ViewDocument& document);

}  // namespace ecorche
