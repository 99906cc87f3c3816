// A stranger's character by its own joints: their motions that let the mesh follow ours.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/own_skin.h"
#include "skinning/rigs/source_rig.h"

namespace ecorche::inline v1 {

// Of one motion.
struct OwnRigMotion {
  std::string name;
  double fps = 30;
  // A frame: of each mover, how far it has gone from where it stands, in the file's coordinates.
  std::vector<std::vector<Transform>> frames;
  double rms = 0, max = 0;  // of the mesh by its own weights from ours, m
};

// Finds the motions of a rig frame by frame. Movers are the rig's joints, and nodes of meshes that
// hang on none.
class OwnRig {
 public:
  // Throws as read_source_rig; UnfitError for a file without a rig.
  OwnRig(const OwnSkin& own, const std::string& name);

  // Takes a frame of the own skin: #V x 4, world, m. Rigid motions of the movers, found by turns so
  // that their blend is nearest to the skin; those without vertices keep to the mover above them.
  void add_frame(std::span<const float> positions, OwnRigMotion& motion) const;

  // The source with the motions as its first animations. Throws LimitError.
  std::string with_motions(const std::vector<OwnRigMotion>& motions) const;

  const SourceRig& rig() const { return rig_; }

 private:
  struct Mover {
    std::size_t node = 0;
    int above = -1;
    std::vector<std::pair<int, double>> vertices;  // and weights
  };
  struct Sums;  // of one frame
  void turn_about(const Mover& mover, const std::vector<Vec3>& targets, bool alone, Sums& sums,
                  Transform& motion) const;

  const OwnSkin& own_;
  SourceRig rig_;
  std::vector<Mover> movers_;
  double size_ = 1;  // of the mesh, file units
};

}  // namespace ecorche::inline v1
