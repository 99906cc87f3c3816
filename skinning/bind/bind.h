// Anchors every skin vertex to the bones and muscles beneath it.
//
// Two parts move a vertex:
//   1. A blend of joint frames. Each vertex takes the joints of the bones beneath it (exact nearest
//   points, reached without leaving
//      the body), the shares are diffused over the skin by a screened Poisson solve whose length is
//      the local depth of bone (after Baran & Popovic 2007, 10.1145/1276377.1276467), and where two
//      joints share a vertex their half-way rotation about the joint between them is blended in, so
//      that a bent limb keeps its girth. All carriers of the blend are linear maps:
//        x = sum_c w_c C_c(pose) X.
//   2. A sparse set of nodes on the skin, each anchored to the strips beneath it. A node keeps its
//   height over the posed muscle
//      surface (fat and skin keep their thickness, Wilhelms & Van Gelder
//      1997, 10.1145/258734.258833); muscles may glide underneath, so only the height counts. The
//      nodes' lifts are spread to the vertices between them.
// Then the skin settles as an elastic sheet on where these two have put it: volumes of body, limbs
// and joints are brought back, parts that meet give way (elastic_skin.h). In the rest pose the
// input skin comes back; rigid motion is reproduced.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche {

struct BindOptions {
  // of the passage from one joint to the next, in units of the limb's local radius
  double blend_width = 1.0;
  // how much of the height change of the muscles reaches the skin; 0: bones only
  double muscle_share = 1.0;
  // m, lift or sink of the skin by muscles that is never reached; half of it, where they ask for it
  // all
  double lift_limit = 0.1;
  double node_spacing = 0.04;  // m, between muscle nodes
  // false: anchors and joint weights alone, for what is written and not moved here; Binding::tables
  // stays empty
  bool moves = true;
};

// The component of the anatomy nearest to a skin vertex at rest, exact.
struct Anchor {
  enum class Kind : std::uint8_t { none, bone, muscle };
  Kind kind = Kind::none;
  int part = -1;              // index into Anatomy::bones, or flat index of the nearer slice
  double distance = 0;        // m
  Vec3 point = Vec3::Zero();  // on the component, world, rest pose
};

struct Influence {
  int joint = 0;
  double weight = 0;
};

struct SkinTables;  // the per-frame tables, opaque; see blend_tables.h

struct Binding {
  int vertex_count = 0;
  std::vector<Anchor> anchors;  // #V
  std::vector<std::array<Influence, 4>>
      joint_weights;  // #V, sum 1: what an engine with four influences can use
  std::shared_ptr<const SkinTables> tables;  // empty: cannot be deformed
};

// Precondition: body.skin is the rest pose of the anatomy, closed enough to have an inside; throws
// UnfitError for a vertex that is not finite, for a skin without triangles, or an anatomy without
// bones.
Binding bind_skin(const Anatomy& anatomy, const Body& body, const BindOptions& options = {});

// The same with the anatomy's rest pose already at hand: no second pose_anatomy().
Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                  const BindOptions& options = {});

// For a refined skin: what moves the vertices is found on the base mesh and carried over by the
// refinement's own blend, so that the fine skin moves as the base one does; the anchors are the
// fine mesh's own. Many times faster than binding the fine mesh by itself. Precondition: fine.V =
// refine_points(refinement, base.V), or a shape near it with the same vertices.
Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                  const Refinement& refinement, const TriMesh& fine,
                  const BindOptions& options = {});

}  // namespace ecorche
