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

#include <filesystem>

#include "anatomy/anatomy.h"
#include "skinning/bind/bind.h"
#include "skinning/files/character_look.h"

namespace ecorche {

struct Character {
  Anatomy anatomy;
  Body body;
};

// 1: no copies of vertices on seams, one primitive a bone
inline constexpr int kCharacterSchema = 2;

// With a motion, the file holds it as one animation named `motion`, a key a frame. Binding and
// motion must belong to the character (std::invalid_argument otherwise). Throws OutputError.
void write_character(const std::filesystem::path& file, const Character& character,
                     const Binding& binding, const Motion* motion = nullptr,
                     const CharacterLook& look = {});

// Throws InputError for a file that is no character of ours (it names what is missing) or whose
// numbers no body has (character_check.h), UnfitError for one of a newer schema, LimitError.
// Positions come back in single precision (1e-7 m).
Character read_character(const std::filesystem::path& file);
Character parse_character(std::string bytes,
                          const std::string& name);  // `name` is what messages call it

// A body without anatomy: the mesh node `skin` and the body's notes (name, sex, age, mass,
// landmarks). Throws OutputError.
void write_body(const std::filesystem::path& file, const Body& body);

// The body of a file that write_body or write_character wrote. Throws as read_character.
Body read_body(const std::filesystem::path& file);
Body parse_body(std::string bytes, const std::string& name);

// Whether the file is a binary glTF that write_body or write_character may have written: by its
// first bytes and the mark in its text. Throws InputError for what is no file that can be read.
bool has_body_notes(const std::filesystem::path& file);

}  // namespace ecorche
