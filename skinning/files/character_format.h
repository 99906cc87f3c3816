// A character as a .glb that any glTF viewer opens, and that reads back as the anatomy it was
// written from.
//
// Scene: mesh node `skin`, mesh nodes `bone/<name>`, `muscle/<name>`, `fascia/<name>`, `eye/left`
// and `eye/right`, the joint hierarchy under `pelvis`; metres, +Y up, facing +Z. A material a
// tissue; muscles fade from belly to tendon by COLOR_0, and have _FIBRE and TEXCOORD_0
// (fibre_attributes.h). The skin has TEXCOORD_0 where its texture is known: its first vertices are
// the body's, in order, and those that seams need twice follow; _SKIN_VERTEX names the body's
// vertex of each. Skin, muscles and fascia carry four joint influences a vertex; bones and eyes
// ride on their joints. What glTF has no word for is in `extras`: schema number and body on the
// asset's scene, axes and limits on joints, label, attachments, path and slices on muscles. Fascia
// is a grid of points, row after row, and _BELLY the share by which it has faded into the belly
// below. The skin's nearest parts are the vertex attributes _ANCHOR_PART (bone index, or number of
// bones + slice index) and _ANCHOR_DISTANCE (m). A motion that was recorded (clip_shapes.h) has
// morph targets on skin and muscles with animated weights for what their influences leave, and
// their error in the scene's `extras.ecorche.shapes`; nobody reads them back. Vertex caches
// (skinning/files/pc2_io.h) are exact.
//
// A character with a skin of its own (schema 3) is the file that it came in with our parts behind:
// its nodes, meshes, materials, images, animations keep their indices, its binary chunk begins
// ours, byte for byte, and its positions are untouched, in its units and axes. Its mesh nodes move
// by our joints: their JOINTS_0 and WEIGHTS_0 are ours, in skins whose inverse bind matrices bring
// the file's positions to the world, in metres, of the pose in which the mesh stands; our joints
// stand in that pose too, so that any viewer shows the mesh as it came, with our bones and muscles
// inside it. (Pieces that their own joints bend as the file stands get positions as they stand, in
// metres.) There is no node `skin`. The scene's `extras.ecorche.own` name, by accessor: positions
// of all vertices in the skeleton's rest pose (`rest`), the registered base mesh at rest (`base`,
// `base_triangles`), and by which of its vertices each own one is carried (`counts` a vertex,
// `vertices`, `weights`); `nodes` (ours begin there), `skin` (ours, of muscles), `pieces`, the pose
// (`root`, `turns`), `scale`, `axes` and `shift` from the file's coordinates to the world, and the
// source's JSON (`source`, a buffer view; `source_bytes` of binary).
#pragma once

namespace ecorche::inline v1 {

// Number of the format. 1: no copies of vertices on seams, one primitive a bone.
inline constexpr int kCharacterSchema = 2;
// Of characters with a skin of their own.
inline constexpr int kOwnSkinSchema = 3;

}  // namespace ecorche::inline v1
