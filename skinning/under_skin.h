// Muscles stay beneath the skin: where a pose would bring one out of it, both give way.
//
// The skin settles by tension, volume and contact of its own, so that a muscle's section may come to lie nearer to it than at rest, or beyond.
// Points of every section's outline that lie near the skin at rest are looked at: the skin about them is found again by walking over the
// mesh from where it was at rest. The skin rises over what has come out by a part of the way, smoothly round about. What is still out is
// pressed in; what pressing alone cannot, moves the section inward. Bellies then take their volume again. At rest nothing moves. A function
// of skin and slices alone.
#pragma once

#include <memory>

#include "anatomy/pose_anatomy.h"
#include "skinning/skin_frame.h"

namespace ecorche {

struct UnderSkin {
  struct Data;
  std::shared_ptr<const Data> data;
};

struct UnderSkinScratch;

// Working memory of keep_under_skin, made when it is first needed; its content means nothing between frames. A copy makes its own.
struct UnderSkinMemory {
  UnderSkinMemory() = default;
  UnderSkinMemory(UnderSkinMemory&&) = default;
  UnderSkinMemory& operator=(UnderSkinMemory&&) = default;
  UnderSkinMemory(const UnderSkinMemory&) {}
  UnderSkinMemory& operator=(const UnderSkinMemory&) { return *this; }

  std::shared_ptr<UnderSkinScratch> own;
};

// `rest`: the anatomy's rest pose, without contact or with it. `skin`: its rest skin, in the vertex order that frames have.
UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin);

// Moves the skin, its normals with it, and the sections and outlines of `posed`, the muscles of the same pose. Precondition: table, anatomy
// and skin are those it was made of; otherwise std::invalid_argument. The same bytes at any number of threads.
void keep_under_skin(const UnderSkin& under, const PosingTable& table, SkinFrame& skin, PosedAnatomy& posed, UnderSkinMemory& memory);

}  // namespace ecorche
