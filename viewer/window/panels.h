// The panels of the window: they show values and edit the document, nothing else.
#pragma once

#include "viewer/window/view_document.h"

namespace ecorche {

// What is known about a part, for people. Lengths are of the pose shown.
struct PartInfo {
  std::string name, label;
  std::string joint;                            // bones
  std::string origin, insertion, group, layer;  // muscles
  double length = 0, rest_length = 0;           // m, mean of the strips
  double volume = 0;                            // m^3
};
PartInfo describe(const ViewSubject& subject, const PosedAnatomy& posed, std::uint32_t part);

// Between ImGui::NewFrame and ImGui::Render. The room that they leave for the figure; what is
// selected may lie over it.
ViewRoom draw_panels(const ViewSubject& subject, const PosedAnatomy& posed, ViewDocument& document);

}  // namespace ecorche
