// Clicks and brushes on bones: where a new muscle begins and ends, what its ends are spread over.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/window_event.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

// A press that does not travel is a click on a bone; others turn the view as ever. Whether the
// event was for it alone. `posed`: of the frame that is seen, or null. Precondition:
// state.bone_click.
bool take_bone_click(DesignSession& session, PanelState& state, const PosedAnatomy* posed,
                     const WindowEvent& event, const ViewProjection& view);

}  // namespace ecorche
