// Eyes for pictures and files: the skin itself has but sockets.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/tissue_look.h"

namespace ecorche::inline v1 {

// Drawn as white, iris and pupil; looks along the joint's +Z at rest.
struct Eyeball {
  Vec3 center = Vec3::Zero();  // world, at rest, m
  double radius = 0.012;       // m
  int joint = 0;               // rides on it
};

// The package's eye globes, set into the lids of `skin` by the rims of its sockets. Empty for skins
// of another topology.
std::vector<Eyeball> find_eyes(const BodyPackage& package, const TriMesh& skin,
                               const Skeleton& skeleton);

// The same with the package that is installed; empty where there is none, for a character can be
// looked at without it.
std::vector<Eyeball> find_eyes(const Assets& assets, const TriMesh& skin, const Skeleton& skeleton);

// A band of the globe that has one colour.
struct EyePart {
  TissueLook look;
  TriMesh mesh;    // world, at rest
  Points normals;  // #V x 3
};

// Pupil, iris and white, which together close the globe.
std::vector<EyePart> eye_parts(const Eyeball& eye);

}  // namespace ecorche::inline v1
