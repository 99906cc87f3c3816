// The list of muscles: found by English and Latin names, by origin and insertion, by region.
#pragma once

#include <string>

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// Whether every word of `find` is in what the tables say of a muscle, whatever the case.
bool is_found(const TableMuscle& muscle, const std::string& find);

// Within a window of ImGui.
void draw_muscle_list(DesignSession& session, PanelState& state, ViewDocument& document);

}  // namespace ecorche
