// Strangers' characters: files with any mesh, fitted by way of a registration of it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "app/files/fitted_actor.h"
#include "morph/registration/registration.h"
#include "skinning/rigs/source_rig.h"

namespace ecorche {

struct Stranger {
  std::string name;                           // of the file, for messages
  std::shared_ptr<const std::string> source;  // .glb
  SourceRig rig;                              // as the file stands, in its units and axes
  std::vector<Landmark> joints;               // of its rig by our names, same coordinates
};

// Throws as read_source_rig. `glb`: the file as a .glb, whatever it was.
Stranger make_stranger(std::string glb, const std::string& name);

// The part of the body that each vertex is of by its weights, or by the joint that its piece hangs
// on; nothing where names of joints do not tell most of it, and for clothes of the trunk, which may
// reach to the feet. #V
std::vector<std::optional<VertexPart>> told_parts(const SourceRig& rig);

// The stranger's mesh attached to its registration, whose scale, axes and shift lead from the
// file's coordinates (of Stranger::rig) to the world. Figures go to the report under `own_skin`.
// Throws as attach_skin.
HungSkin hang_skin(const Stranger& stranger, const Registration& registration,
                   const BodyPackage& package, Report& report);

// Bones and muscles fitted into the registered body, and the stranger's mesh bound to them, ready
// for write_character_file. Throws as fit_for_file and hang_skin.
FittedForFile fit_stranger(const Assets& assets, const Template& body_template,
                           const Stranger& stranger, const Registration& registration,
                           const BodyPackage& package, const FittedActorOptions& options,
                           Report& report);

}  // namespace ecorche
