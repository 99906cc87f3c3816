// What the skin does by itself once it has been put where bones and muscles want it: it evens out
// its stretch, keeps the volume of the flesh beneath it, and parts where it would pass through
// itself. Private to the room.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "skinning/bind/skin_depth.h"
#include "skinning/settle/membrane.h"
#include "skinning/settle/self_contact.h"
#include "skinning/settle/volume_preservation.h"

namespace ecorche {

struct ElasticSkin {
  Membrane membrane;
  LimbVolumes volumes;
  SkinContact contact;
  std::vector<double> tissue;                           // #V m, between skin and bone
  std::vector<std::array<Influence, 4>> joint_weights;  // #V
  std::vector<Vec3> rest;                               // #V
};

// Vertices in an order of their own: vertex s is `order[s]` of the skin and of what belongs to it
// (empty: the same); `triangles` are in that order.
std::shared_ptr<const ElasticSkin> make_elastic_skin(
    const Skeleton& skeleton, const TriMesh& skin, const SkinSurvey& survey,
    std::span<const std::array<Influence, 4>> joint_weights, std::span<const int> order,
    std::span<const int> triangles);

// Moves `positions` (#V x 4, in that order): stretch evened out, volumes kept. A function of the
// pose alone; allocates only when the skin has another size than last time. Same input, same bytes
// at any number of threads.
void settle_skin(const ElasticSkin& skin, std::span<const int> triangles,
                 std::span<const Transform> X_WJ, std::span<float> positions,
                 ElasticScratch& scratch);

// After that: scratch.rising, #V, how freely the skin may rise: as open as it is, and little where
// it has met another part, whose flesh holds it down.
void find_rising(const ElasticSkin& skin, std::span<const float> positions,
                 ElasticScratch& scratch);

// After that: parts that meet are pressed flat, and the flesh that this or a rise has moved comes
// from or goes to where there is `room` (#V, 0 .. 1; empty where nothing has risen). Over what has
// risen, limbs and body alone keep volumes: were the flesh about a hinge to keep its own, a flexed
// arm would sink where its muscles have just raised it. scratch.pressed: what contact has moved.
// False where nothing has met or risen.
bool part_settled_skin(const ElasticSkin& skin, std::span<const int> triangles,
                       std::span<const Transform> X_WJ, std::span<const float> room,
                       std::span<float> positions, ElasticScratch& scratch);

}  // namespace ecorche
