// A character whose measures are moved by sliders. Each body that is asked for is solved, and bones
// and muscles go along with its skin at once; then it is fitted as `ecorche fit` does it, in the
// background: a first fit some tenths of a second after the slider stands, the whole one after it.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "morph/fit/fit_character.h"
#include "morph/shapes/solve_measures.h"
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
  // `body_template`: what the character was fitted with. Throws UnfitError for a skin that is not
  // the base mesh, or an anatomy that is not the template's; InputError without the packages.
  BodySliders(Character start, Template body_template);
  ~BodySliders();
  BodySliders(const BodySliders&) = delete;
  BodySliders& operator=(const BodySliders&) = delete;

  std::vector<Slider> sliders() const;

  // What sliders begin with, from texts as of --measure. Throws UsageError for a measure that has
  // no slider.
  std::vector<std::optional<double>> asked_by(const std::vector<std::string>& measures) const;

  // The most probable body with the asked values, what is the character's own kept; nothing asked:
  // the character's own.
  Body solve(const std::vector<std::optional<double>>& asked) const;

  // Begins to make that body; nothing asked: shows the character itself.
  void ask(const std::vector<std::optional<double>>& asked);

  // The newest body that is ready; another pointer when there is a newer one. Never null.
  std::shared_ptr<const SlidBody> shown() const;
  bool busy() const;
  // What each stage took of the last body that went through it, ms; 0: none has.
  std::array<double, 3> milliseconds() const;
  // Why there is no body as asked last; empty where there is, or may yet be.
  std::string problem() const;
  // Until the whole fit of what was asked last is ready, or its problem known.
  void wait() const;

  // The body asked for, fitted, bound and written as `ecorche fit` does it; the character itself,
  // bound anew, where nothing is asked. What it misses of the accuracy targets. Throws UnfitError
  // where no anatomy fits, OutputError.
  std::vector<MissedTarget> write(const std::vector<std::optional<double>>& asked,
                                  const std::filesystem::path& file, Report& report) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
