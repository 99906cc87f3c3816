// FBX and COLLADA as glTF: read by the program ecorche-import, a child process without rights.
//
// The child (import_main.cpp) reads the file with the Open Asset Import Library and writes a GLB:
// nodes, meshes (positions, normals, texture coordinates, materials), skins, morph targets,
// animations, textures that lie in the file; metres, +Y up. It may open nothing, has no network,
// and is ended at limits::kImportSeconds and limits::kImportMemory. What it writes is as little
// believed as any file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// "fbx" or "dae" by the first bytes; nothing for other files.
std::optional<std::string> scene_format(std::string_view bytes);

// The scene as a GLB; `name` is what messages call the file. Throws InputError (malformed, or the
// reader gave up on it), UnfitError (a version or kind that is not read; ecorche-import is not
// installed), LimitError (time, memory, size).
std::string import_scene(std::string_view bytes, const std::string& name);
std::string import_scene(const std::filesystem::path& file);

}  // namespace ecorche::inline v1
