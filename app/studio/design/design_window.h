// The studio's window: panels, handles and keys around a session of actions.
#pragma once

#include "app/common_options.h"
#include "app/edit/session.h"
#include "app/report.h"
#include "viewer/window/window.h"

namespace ecorche {

// Runs it until it is closed. Times of frames go to the report under `window`. Throws as
// run_window.
void run_design_window(Session& session, const Common& common, Report& report,
                       const Session::Drawer& draw, const WindowOptions& options);

}  // namespace ecorche
