// The panels of the window: they show values and edit the document, nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "viewer/window/view_document.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

// Facts about a part, as text. Lengths are of the displayed pose.
struct PartInfo {
  std::string name, label;
  std::string joint;                            // bones
  std::string origin, insertion, group, layer;  // muscles
  double length = 0, rest_length = 0;           // m, mean of the strips
  double volume = 0;                            // m^3
};
PartInfo describe(const ViewSubject& subject, const PosedAnatomy& posed, std::uint32_t part);

// Names the middle of the last thing drawn, for recorded sessions.
void name_place(ViewDocument& document, const std::string& name);

// Parts of panels, for tools that have panels of their own; within a window of ImGui.
void draw_look(ViewDocument& document);  // layers and colours
// The plane that cuts the figure, and where it lies.
void draw_section(const ViewSubject& subject, ViewDocument& document);
void draw_views(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document);

// Windows at the edges. The timeline returns its height, 0 where nothing moves; the list of keys
// has `more` before those of the view.
float draw_timeline(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document);
void draw_help(ViewDocument& document, std::span<const KeyLine> more = {});

// Draws all panels; call between ImGui::NewFrame and ImGui::Render. Returns the room that they
// leave for the figure, which the panel of the selected part may overlap.
ViewRoom draw_panels(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document);

}  // namespace ecorche
