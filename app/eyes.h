// Eyes for pictures: the skin itself has but sockets.
#pragma once

#include <vector>

#include "anatomy/body_package.h"
#include "viewer/scene.h"

namespace ecorche {

// The package's eye globes, set into the lids of `skin` by the rims of its sockets. Empty for skins of another topology.
std::vector<Eyeball> find_eyes(const BodyPackage& package, const TriMesh& skin, const Skeleton& skeleton);

// The same with the package that is installed; empty where there is none, for a character can be looked at without it.
std::vector<Eyeball> find_eyes(const TriMesh& skin, const Skeleton& skeleton);

}  // namespace ecorche
