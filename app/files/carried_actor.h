// A character that lies, sits or is lifted: its patient, and its own skin as the shape that is
// pressed. Shared by lift, lie and sit.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "app/common_options.h"
#include "app/files/actor.h"
#include "skinning/lift/carry.h"

namespace ecorche {

struct CarriedActor {
  std::shared_ptr<const Actor> actor;
  CarryModel model;  // without a sheet
};

// Mass from the body, or from its volume where it is not known. Throws as open_character() and
// make_actor(), UnfitError for another skeleton than ours.
CarriedActor carried_actor(const std::filesystem::path& file, const FleshOptions& tissue,
                           const Common& common, Report& report);

// 8, with a note and under `missed`, where NAME.contact_force is further from NAME.weight than a
// share; 0 otherwise.
int tell_missed_force(const std::string& name, double share, const Common& common, Report& report);

}  // namespace ecorche
