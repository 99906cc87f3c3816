// A character whose measurements are set by sliders. For each set of targets the body is solved
// and bones and muscles are warped with its skin at once. A fit follows in the background: a
// preliminary one some tenths of a second after the slider has stopped, then the one of `ecorche
// fit`.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "app/report.h"
#include "morph/fit/fit_quality.h"
#include "morph/shapes/solve_measures.h"
#include "morph/template/template.h"
#include "viewer/window/view_document.h"

namespace ecorche {

struct SlidBody {
  enum class Stage {
    carried,
    first,
    whole
    // gone along; bones where they belong, but neighbouring muscles have not parted; as `fit` makes
    // it
  };
  Stage stage = Stage::carried;
  Character character;
  SceneModel model;
  PosedAnatomy rest;
  std::vector<double> achieved;     // #sliders
  std::vector<std::string> missed;  // accuracy targets, of a whole fit
};

class BodySliders {
 public:
  // `body_template`: the template that the character was fitted with. Throws UnfitError for a
  // skin that is not the base mesh, or an anatomy that is not the template's; InputError without
  // the packages.
  BodySliders(const Assets& assets, Character start, Template body_template);
  ~BodySliders();
  BodySliders(const BodySliders&) = delete;
  BodySliders& operator=(const BodySliders&) = delete;

  std::vector<Slider> sliders() const;

  // Initial targets of the sliders, from texts like those of --measure. Throws UsageError for a
  // measure without a slider.
  std::vector<std::optional<double>> asked_by(const std::vector<std::string>& measures) const;

  // The most probable body with the target values that keeps the character's other traits;
  // without targets, the character's own body.
  Body solve(const std::vector<std::optional<double>>& asked) const;

  // Starts to make that body; without targets, shows the character itself.
  void ask(const std::vector<std::optional<double>>& asked);

  // The newest finished body; a new pointer for each. Never null.
  std::shared_ptr<const SlidBody> shown() const;
  bool busy() const;
  // Time of each stage for the last body that passed it, ms; 0: none has.
  std::array<double, 3> milliseconds() const;
  // Reason why the last targets have no body; empty if they have one or it is still being made.
  std::string problem() const;
  // Waits until the complete fit of the last targets is finished or has failed.
  void wait() const;

  // Fits, binds and writes the body with these targets as `ecorche fit` does; without targets,
  // binds and writes the character itself. Returns the accuracy targets that it misses. Throws
  // UnfitError if no anatomy fits, OutputError.
  std::vector<MissedTarget> write(const std::vector<std::optional<double>>& asked,
                                  const std::filesystem::path& file, Report& report) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
