// A character whose measures are moved by sliders: the skin is solved at once; bones, joints, muscles and binding are carried along.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/actor.h"
#include "viewer/view_document.h"

namespace ecorche {

class BodySliders {
 public:
  // Both are borrowed. Throws UnfitError for a skin that is not the base mesh, InputError without the packages.
  BodySliders(const Actor& actor, SceneModel& model);
  ~BodySliders();

  std::vector<Slider> sliders() const;

  // What sliders begin with, from texts as of --measure. Throws UsageError for a measure that has no slider.
  std::vector<std::optional<double>> asked_by(const std::vector<std::string>& measures) const;

  // The most probable body with the asked values, what is the character's own kept; fills in what every slider reads then. Bones of the
  // model are moved.
  void reshape(const std::vector<std::optional<double>>& asked, std::vector<double>& achieved);

  // The character as reshaped last. Throws OutputError.
  void write(const std::filesystem::path& file) const;

  // At rest, as reshaped last.
  void pose(PosedAnatomy& posed, SkinFrame& skin) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
