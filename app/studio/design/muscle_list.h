// The list of muscles: found by English and Latin names, by origin and insertion; grouped by
// region, nerve, function or layer.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/authoring/muscle_groups.h"
#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

// What the list is grouped by, in the order of Grouping.
enum class Grouping { region, nerve, function, layer };
inline constexpr std::array kGroupings{"by region", "by nerve", "by function", "by layer"};
// Groups that a muscle is in, by name. `groups`: of nerves and functions.
std::vector<std::string> groups_of(const TableMuscle& muscle, Grouping grouping,
                                   const MuscleGroups& groups);

// Whether every word of `find` is in what the tables say of a muscle, whatever the case.
bool is_found(const TableMuscle& muscle, const std::string& find);

// Within a window of ImGui.
void draw_muscle_list(DesignSession& session, PanelState& state, ViewDocument& document);

}  // namespace ecorche
