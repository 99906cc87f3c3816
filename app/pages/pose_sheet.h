// All poses of the pose book on one picture.
#pragma once

#include <span>
#include <string>

#include "app/files/actor.h"
#include "skinning/motion/pose_book.h"
#include "viewer/gl/renderer.h"
#include "viewer/scene.h"

namespace ecorche {

struct PoseSheetOptions {
  int columns = 10;
  int cell_width = 230, cell_height = 270;  // pixels
  bool skin = true;                         // false: the muscles and bones under it
};

// Every pose as `actor` moves its skin, each seen from where the book says and filling its cell,
// with its label. `title` stands above.
Image sheet_of_poses(Renderer& renderer, const Actor& actor, const SceneModel& model,
                     std::span<const NamedPose> poses, const std::string& title,
                     const PoseSheetOptions& options = {});

}  // namespace ecorche
