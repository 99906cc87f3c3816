// Files that are opened in the window or dropped into it.
#pragma once

#include <filesystem>

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/window_event.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

// A motion, a body, or a mesh that may become a bone.
void open_dropped(DesignSession& session, PanelState& state, const std::filesystem::path& file);

// Of what is dropped onto the figure: the joint that is seen nearest to it. `posed`: of the frame
// that is seen, or null.
void guess_joint(DesignSession& session, PanelState& state, const PosedAnatomy* posed,
                 const WindowEvent& event, const ViewProjection& view);

}  // namespace ecorche
