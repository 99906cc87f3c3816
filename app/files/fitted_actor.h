// A body fitted with bones and muscles and its skin bound to them, with the figures in the report.
// Shared by fit, bench, demo, view and population.
#pragma once

#include <filesystem>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "app/files/actor.h"
#include "app/report.h"
#include "morph/fit/fit_character.h"

namespace ecorche {

// A stranger's mesh attached to a body, for its character.
struct HungSkin {
  TriMesh rest;     // in the body's rest pose
  Points standing;  // as it stands, world, m
  OwnSkin own;      // without its pose
};

struct FittedActorOptions {
  FittingOptions fitting{};
  // the character gets the refined skin of 120,404 vertices instead of the base mesh
  bool fine_skin = false;
  std::filesystem::path weights{};  // see ActorOptions
  const HungSkin* hung = nullptr;   // the character gets this skin instead
};

// Results of the fit beside the character.
struct FitOutcome {
  Anatomy undilated;  // the muscles before they grew
  TissueMesh tissue;  // see Fit::tissue
  FittingReport report;
  // from the fat layer to the muscle under it, all over the limbs, grooves and tendons included, m;
  // 0 where tissues are not measured
  double skin_gap_median = 0;
  // share of a stranger's edges that bringing its mesh to rest made thrice as long; 0 for our skins
  double torn_share = 0;
  double longest_tear = 0;  // m, by which the worst of them grew
};

struct FittedActor : FitOutcome {
  Actor actor;
};
FittedActor fit_actor(const Assets& assets, const Template& body_template, const Body& body,
                      const BodyPackage& package, const FittedActorOptions& options,
                      Report& report);

// A character that is only written.
struct FittedForFile : FitOutcome {
  BoundCharacter bound;
};
FittedForFile fit_for_file(const Assets& assets, const Template& body_template, const Body& body,
                           const BodyPackage& package, const FittedActorOptions& options,
                           Report& report);

// The character alone, without tables and binding.
Character fit_unbound(const Template& body_template, const Body& body, const BodyPackage& package,
                      const FittingOptions& options, Report& report);

// Under `timings_ms`, `fit` and `rays`.
void report_fit(const FittingReport& fitted, double skin_gap_median, Report& report);

}  // namespace ecorche
