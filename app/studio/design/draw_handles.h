// Handles and wire shapes drawn over the figure, and the mouse on them.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

// Finds the handles of this frame and draws them, over the figure and under the panels.
void draw_handles(DesignSession& session, PanelState& state, const PosedAnatomy& posed,
                  const ViewProjection& view, ViewDocument& document);

// Whether the event was a handle's: taken hold of, dragged, let go of.
bool take_handle(DesignSession& session, PanelState& state, const PosedAnatomy& posed,
                 const WindowEvent& event, const ViewProjection& view);

}  // namespace ecorche
