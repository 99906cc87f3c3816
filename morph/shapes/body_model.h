// The one model of bodies: from a sex and whatever else is asked (age, stature, mass, muscle, any
// measures) to the most probable person who has it.
//
// What is left out is what is most probable for the rest: nothing asked gives the mean of the
// survey's adults, an age alone the mean of people of that age. Stature and mass are measures like
// any other, so that one target makes one body, however it is spelt.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "morph/shapes/body.h"
#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {

struct BodySpec {
  Sex sex = Sex::male;
  std::optional<double> age{};     // years, 1 .. 90; none: adults as the survey has them
  std::optional<double> height{};  // m
  std::optional<double> mass{};    // kg
  // Share of people of the same targets who are less muscular, 0 .. 1 (muscularity.h).
  std::optional<double> muscle{};
  std::vector<MeasureTarget> measures{};
  std::string name{};
};

// What bodies are made with. Shape spaces are read when first asked for; several threads may ask.
class BodyModel {
 public:
  // Throws InputError for missing or damaged packages and tables.
  explicit BodyModel(const Assets& assets);
  explicit BodyModel(BodyPackage package);

  const BodyPackage& package() const { return package_; }
  const TapeMeasure& tape() const { return tape_; }
  // The survey's adults.
  const ShapeSpace& adults(Sex sex) const;
  // People of an age, or adults without one. Throws UnfitError for an age outside 1 .. 90.
  ShapeSpace people(Sex sex, std::optional<double> age) const;

 private:
  BodyPackage package_;
  TapeMeasure tape_;
  mutable std::once_flag read_[2];
  mutable ShapeSpace spaces_[2];
};

// A body and how well it has what was asked.
struct MadeBody {
  Body body;
  std::vector<MeasureTarget> targets;  // stature and mass first
  SolvedBody solved;
  double worst_miss = 0;  // of a target, in the measure's tolerances
  bool met = false;
  std::vector<std::string> why;  // not: a conflict or a miss each, with what is possible
};

// With targets that contradict each other, the nearest body. Throws UnfitError for ages and muscle
// out of range and for skins bent out of human shape, UsageError when a measure is asked for twice.
MadeBody most_probable_body(const BodyModel& model, const BodySpec& spec,
                            const SolveOptions& options = {});

// Throws UnfitError that names what cannot be met and what is possible.
Body make_body(const BodyModel& model, const BodySpec& spec);

// For one body alone: reads the model's tables and a shape space.
Body make_body(const BodyPackage& package, const BodySpec& spec);

}  // namespace ecorche::inline v1
