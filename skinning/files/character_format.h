// A character as a .glb that any glTF viewer opens, and that reads back as the anatomy it was
// written from.
//
// Scene: mesh node `skin`, mesh nodes `bone/<name>`, `muscle/<name>`, `eye/left` and `eye/right`,
// the joint hierarchy under `pelvis`; metres, +Y up, facing +Z. A material a tissue; muscles fade
// from belly to tendon by COLOR_0. The skin has TEXCOORD_0 where its texture is known: its first
// vertices are the body's, in order, and those that seams need twice follow; _SKIN_VERTEX names the
// body's vertex of each. Skin and muscles carry four joint influences a vertex; bones and eyes ride
// on their joints. What glTF has no word for is in `extras`: schema number and body on the asset's
// scene, axes and limits on joints, label, attachments, path and slices on muscles. The skin's
// nearest parts are the vertex attributes _ANCHOR_PART (bone index, or number of bones + slice
// index) and _ANCHOR_DISTANCE (m). glTF has nothing exact for a skin that moves by muscles: its
// four influences are the joint part of the binding. Vertex caches (skinning/files/pc2_io.h) are
// exact.
#pragma once

namespace ecorche::inline v1 {

// Number of the format. 1: no copies of vertices on seams, one primitive a bone.
inline constexpr int kCharacterSchema = 2;

}  // namespace ecorche::inline v1
