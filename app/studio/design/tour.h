// The first steps, shown where they are done: each ends when the person has done it.
#pragma once

#include <cstddef>
#include <filesystem>

#include "app/studio/design/design_session.h"
#include "app/studio/design/panel_state.h"
#include "viewer/window/view_document.h"

namespace ecorche {

class Tour {
 public:
  void begin();
  void end() { step_ = kNone; }
  bool runs() const { return step_ != kNone; }
  // Goes on where a step is done, and draws the one that is next: a ring about what is meant, and
  // what to do under the bar. Precondition: the frame's panels and handles have named their places.
  void draw(const DesignSession& session, const PanelState& state, float left, float top,
            float width, ViewDocument& document);

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t step_ = kNone;
};

// Whether no tour was begun or left before by this user; says so from then on. `folder`: of the
// studio's states.
bool is_first_run(const std::filesystem::path& folder);

}  // namespace ecorche
