// Muscles stay beneath the skin: where a pose would bring one out of it, both give way.
//
// The skin settles by tension, volume and contact of its own, so that a muscle's section may come
// to lie nearer to it than at rest, or beyond. Points of every section's outline that lie near the
// skin at rest are looked at: the skin about them is found again by walking over the mesh from
// where it was at rest. The skin rises over what has come out by a part of the way, smoothly round
// about, but not in folds and where it meets itself; the flesh for that comes from where no muscle
// is near: body and limbs keep their volumes. What is still out is pressed in; what pressing alone
// cannot, moves the section inward. Bellies then take their volume again. At rest nothing moves. A
// function of skin and slices alone. A refined skin follows its base mesh in this too.
#pragma once

#include <memory>
#include <span>

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

struct UnderSkin {
  struct Data;
  std::shared_ptr<const Data> data;
};

struct UnderSkinScratch;

// Working memory of a frame, made when it is first needed; its content means nothing between
// frames. A copy makes its own.
struct UnderSkinMemory {
  UnderSkinMemory() = default;
  UnderSkinMemory(UnderSkinMemory&&) = default;
  UnderSkinMemory& operator=(UnderSkinMemory&&) = default;
  UnderSkinMemory(const UnderSkinMemory&) {}
  UnderSkinMemory& operator=(const UnderSkinMemory&) { return *this; }

  std::shared_ptr<UnderSkinScratch> own;
};

// The mesh on which the binding's skin settles, and what lies beneath it; `rest`: the anatomy's
// rest pose, without contact or with it. Precondition: the binding is not empty
// (std::invalid_argument).
UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const Binding& binding);

// deform_skin(), and the skin rises over the muscles, at kept volumes; `flesh` as there, see
// soft_tissue.h. `under`: made for the binding.
void deform_over_muscles(const Binding& binding, const UnderSkin& under,
                         std::span<const float> flesh, const PosedAnatomy& posed, SkinFrame& out,
                         UnderSkinMemory& memory);

// The muscles give way beneath the skin of the frame that deform_over_muscles() has just made over
// them with the same memory; `table`: what they were posed by. Who wants the skin alone does
// without. Throws std::invalid_argument for a frame that was moved otherwise.
void give_way_to_skin(const Binding& binding, const UnderSkin& under, const PosingTable& table,
                      const SkinFrame& skin, PosedAnatomy& posed, UnderSkinMemory& memory);

}  // namespace ecorche
