// The compared figure in the window: its half of the view, names, and the line between the two.
#pragma once

#include <cstdint>
#include <optional>

#include "app/studio/design/design_session.h"
#include "viewer/window/window_event.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

class ComparisonView {
 public:
  // Borrowed.
  explicit ComparisonView(DesignSession& session) : session_(session) {}

  // Once a frame, after the session's.
  void update();
  FigureBeside figure() const;
  // Parts that are hidden of the session's figure are hidden of the other, by name.
  void dress(Appearance& appearance) const;
  // Names over the two, and the line. `room`: of both.
  void draw(const ViewRoom& room) const;
  // Drags of the line. Returns whether the event was for it.
  bool take(const WindowEvent& event, const ViewRoom& room);

 private:
  bool is_wiped() const { return session_.seen().trial->comparison.wiped; }
  float line(const ViewRoom& room) const;  // where the figures meet, pixels

  DesignSession& session_;
  ViewSubject subject_;
  std::uint64_t revision_ = 0;
  bool dragged_ = false;
};

// The choice of what it is compared with, within a panel.
void draw_comparison_choice(DesignSession& session, ViewDocument& document);

}  // namespace ecorche
