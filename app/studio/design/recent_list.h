// Files of sessions before, to take again.
#pragma once

#include <string>

#include "app/studio/design/design_session.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// A menu of those of a kind (recent_files.h) that runs `action FILE`; nothing where there are none.
void draw_recent(DesignSession& session, const std::string& kind, const std::string& action,
                 const std::string& where, ViewDocument& document);

}  // namespace ecorche
