// What a session writes for others: characters, templates, models, pictures, films, tables.
#pragma once

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// Within the bar; nothing where it is not asked for.
void draw_export(DesignSession& session, PanelState& state, ViewDocument& document);

}  // namespace ecorche
