// What was done as lines of a script, the search box of actions, and the bars that save and ask.
#pragma once

#include <string>

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// Within a window of ImGui: the lines, which can be gone back to, copied and saved.
void draw_script_panel(DesignSession& session, ViewDocument& document);

// Windows of their own. `width` and `left`: of the room between the panels, pixels.
struct BarPlace {
  float left = 0, top = 0, width = 1;
};
// Undo, redo, save, actions, and what is being fitted. Returns its lower edge.
float draw_top_bar(DesignSession& session, PanelState& state, ViewDocument& document,
                   const BarPlace& place);
void draw_actions_box(DesignSession& session, PanelState& state, ViewDocument& document,
                      const BarPlace& place);

// All lines that led to the document, as a script.
std::string script_of(const History& history);

// Saves to the project, or asks for its folder.
void save_or_ask(DesignSession& session, PanelState& state);

}  // namespace ecorche
