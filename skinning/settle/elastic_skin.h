// The skin by itself: a membrane that relaxes, folds at hinges, regions that keep their volume, and
// parts that may not pass through one another. Compiled once; private to the library.
#pragma once

#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"
#include "skinning/binding.h"
#include "skinning/settle/fold_planes.h"
#include "skinning/settle/membrane.h"
#include "skinning/settle/self_contact.h"
#include "skinning/settle/volume_preservation.h"

namespace ecorche::inline v1 {

struct ElasticParameters {
  // Bound of the tissue's thickness as a fraction of the body's local radius: an ear is far from
  // bone, but there is little of it.
  double radius_fraction = 0.8;
  // Thickness of tissue (m) that moves as freely as skin that joints would stretch to twice its
  // length. Larger: skin over knuckles and elbows is held less.
  double looseness_of_strain = 0.055;
  int tissue_rounds = 8, strain_rounds = 4;  // of smoothing
};

struct ElasticSkin {
  Membrane membrane;
  VolumeRegions volumes;
  std::vector<HingeFold> folds;
  SelfContact contact;
  std::vector<int> triangles;               // 3 indices each
  std::vector<double> tissue;               // #V m, between skin and bone
  std::vector<JointWeights> joint_weights;  // #V
  std::vector<Vec3> rest;                   // #V
};

// The skin as binding has found it, #V: depth of the nearest bone and half the thickness of the
// body (m), joint weights; in the caller's order.
struct SkinProperties {
  std::span<const double> depth, radius;
  std::span<const JointWeights> joint_weights;
};

// Vertices in an order of their own: vertex s is `order[s]` of the skin and of its properties
// (empty: the same); `triangles` are in that order.
ElasticSkin make_elastic_skin(const Skeleton& skeleton, const TriMesh& skin,
                              const SkinProperties& properties, std::span<const int> order,
                              std::span<const int> triangles);

}  // namespace ecorche::inline v1
