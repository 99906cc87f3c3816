// A motion's shapes of a character's skin, muscles and fascia: what its .glb needs beyond joints to
// show them where the program has them (docs/decisions/0016-muscles-move-by-morphs-in-files.md).
#pragma once

#include <span>
#include <vector>

#include "anatomy/character.h"
#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posed_anatomy.h"
#include "skinning/binding.h"
#include "skinning/morphs/linear_blend.h"
#include "skinning/morphs/mesh_shapes.h"
#include "skinning/morphs/morph_basis.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct ClipShapes {
  MeshShapes skin;  // by the body's vertices; none for a character with a skin of its own
  std::vector<MeshShapes> muscles;  // by the vertices of each muscle as files loft it
  std::vector<MeshShapes> fascia;   // by the points of each sheet
};

struct ClipOptions {
  ShapeOptions muscles{};  // and fascia
  // One mesh in which everything moves, and what is seen first.
  ShapeOptions skin{.share = 0.001, .worst = 4e-3};
};

// For a skin that has these vertices of the skin alone.
ClipShapes clip_on_rows(const ClipShapes& shapes, std::span<const int> vertices);

// Takes the frames of a motion, in order. Normals of muscles are left to the joints: nobody sees
// that, and the file would be twice as large.
class ClipRecorder {
 public:
  // Precondition: the binding is the character's.
  ClipRecorder(const Character& character, const Binding& binding, const ClipOptions& options = {});

  void add(const PosedAnatomy& posed, const SkinFrame& skin);
  // The recorder is spent.
  ClipShapes finish();

 private:
  struct Recorded {
    BlendedMesh mesh;
    MorphBasis basis;
    Eigen::VectorXf offsets{}, normals{};
    double collapsed = 0;  // m, what a blend that has collapsed keeps vertices away
  };
  MeshShapes finish(Recorded& one);

  std::vector<Vec3> joint_rest_;
  MuscleSurface surface_;
  FasciaSurface fascia_surface_;
  std::vector<Recorded> muscles_, fascia_;
  std::vector<Recorded> skin_;  // one or none
  std::vector<Affine> moves_;
  PointsF posed_, posed_fascia_;
};

}  // namespace ecorche::inline v1
