// The strips of a muscle in the card: points, sections, belly and wraps, in fields that are
// actions.
#pragma once

#include <string>

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// "landmark+left,up,front", as scripts write a place.
std::string place_text(const MuscleTable& frame, int landmark, const Vec3& offset);

// Within a window of ImGui.
void draw_muscle_lines(DesignSession& session, PanelState& state, const TableMuscle& muscle,
                       ViewDocument& document);

}  // namespace ecorche
