// Fields of the studio's panels. A value is typed with a unit and is an action when it is done.
#pragma once

#include <optional>
#include <string>

#include "app/studio/design/design_session.h"
#include "viewer/window/panels.h"

namespace ecorche {

constexpr float kQuietGrey = 0.70f;

// Shows a value; returns the text that a person has put in its place, when it is finished.
std::optional<std::string> value_field(const std::string& id, const std::string& now, float width);
// Three numbers with units, left, up and front; what does not read is a fault of `where`.
std::optional<Vec3> place_field(DesignSession& session, const std::string& id, const Vec3& now,
                                ArgumentUnit unit, const std::string& where);
// The same in a table of two columns, its name before it.
std::optional<std::string> value_row(const std::string& key, const char* label,
                                     const std::string& now, const char* help);
// A line to write in. Returns whether Enter was pressed.
bool text_field(const std::string& id, std::string& text, const std::string& hint, float width,
                bool focus = false);
// A slider that is an action when it is let go of: while it is held, `line` of its value is tried.
void action_slider(DesignSession& session, const std::string& id, double value, double low,
                   double high, const char* format, const std::string& line_before,
                   const std::string& where);
void quiet_text(const std::string& text);
void fault_text(const std::string& text);
std::string spaced(std::string name);        // a name's words, without underscores
void help_of_last(const std::string& text);  // a tooltip
// What went wrong with what stands above; nothing where nothing did.
void show_fault(DesignSession& session, const std::string& where);
// What went wrong where nothing of it is in sight: in a panel that is closed or scrolled away.
void show_unseen_fault(DesignSession& session);

}  // namespace ecorche
