// The panel of a body's measures: each with its number, its slider, and a tick where a person has
// asked for it.
#pragma once

#include "viewer/window/view_document.h"

namespace ecorche {

struct MeasurePanel {
  float width = 0, bottom = 0;  // pixels; width 0: the subject has no sliders
};

// At the right edge of the window, from `top` down to at most `bottom`. Between ImGui::NewFrame and
// ImGui::Render.
MeasurePanel draw_measure_panel(const ViewSubject& subject, float top, float bottom,
                                ViewDocument& document);

}  // namespace ecorche
