// Private to the writers of .glb files: surfaces with a primitive a tissue, which share their
// vertices.
#pragma once

#include <span>
#include <vector>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/muscles/muscle_surface.h"
#include "skinning/files/glb_builder.h"

namespace ecorche::inline v1::gltf {

// Faces with a flag are of the second material. At least one primitive; attributes added to one
// must be added to all. normals: #V x 3.
std::vector<tinygltf::Primitive> two_tissues(GlbBuilder& glb, const TriMesh& mesh,
                                             const Points& normals, const std::vector<char>& second,
                                             int first_material, int second_material);

// All muscles at rest as files show them: kLoftPoints around a section.
struct LoftedMuscles {
  MuscleSurface surface;
  Points positions;  // #V x 3
};
LoftedMuscles lofted_muscles(const Anatomy& anatomy);

// Colours of a muscle: the belly has one material, the rest another that fades from tendon to
// belly.
struct MuscleTints {
  std::vector<char> tendon;         // #F, 1: not wholly belly
  std::vector<Tint> belly, fading;  // #V, of either material's colour
};

// muscle: its number, which gives its tone. belly: #V, 1 on the belly, 0 on tendon.
MuscleTints muscle_tints(int muscle, std::span<const float> belly, const Triangles& F);

// Primitives with COLOR_0. `mesh` has the vertices and faces that the tints are of.
std::vector<tinygltf::Primitive> muscle_tissues(GlbBuilder& glb, const TriMesh& mesh,
                                                const MuscleTints& tints);

// A sheet of fascia, tendon that fades into the belly below.
tinygltf::Primitive fascia_tissue(GlbBuilder& glb, const FasciaSheet& sheet);
// All of its faces as tendon.
MuscleTints fascia_tints(std::span<const float> belly, const Triangles& F);

// Pupil, iris and white.
std::vector<tinygltf::Primitive> eye_tissues(GlbBuilder& glb, const Eyeball& eye);

}  // namespace ecorche::inline v1::gltf
