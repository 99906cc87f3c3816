// The most that a file may hold. What goes beyond is refused with a LimitError that names the
// limit, before memory is taken for it.
//
// SECURITY.md shows these as its table, made of the remarks here: `tests/bad_inputs/limits.py
// --write` brings it up to date, and the test of the same name holds the two together. A value is a
// whole number or a product or shift of such.
#pragma once

#include <cstddef>

namespace ecorche::inline v1::limits {

// bytes of a mesh, body or character
inline constexpr std::size_t kFileBytes = std::size_t{2} << 30;
// bytes of a table (.csv, .sto, .mot, joint map)
inline constexpr std::size_t kTableBytes = std::size_t{64} << 20;
// columns of a table
inline constexpr std::size_t kTableColumns = 10000;
// rows of a table of people
inline constexpr std::size_t kPeople = 1000000;
// bytes of a motion (.bvh)
inline constexpr std::size_t kMotionBytes = std::size_t{1} << 30;
// bytes of a file of a musculoskeletal model (.osim, .xml, meshes)
inline constexpr std::size_t kModelBytes = std::size_t{256} << 20;
// bytes of a name of a joint, node or part
inline constexpr std::size_t kNameBytes = 1024;

// vertices, and faces, of a mesh
inline constexpr long long kMeshElements = 1LL << 27;
// corners of all faces of a mesh
inline constexpr std::size_t kMeshCorners = std::size_t{1} << 29;
// corners of a polygon
inline constexpr std::size_t kPolygonCorners = 10000;
// squares of the corners of polygons with more than four, added up
inline constexpr std::size_t kPolygonWork = std::size_t{1} << 30;
// vertices and corners that a glTF file may hold beyond what its bytes hold once
inline constexpr std::size_t kRepeatedElements = std::size_t{1} << 22;

// objects and lists within each other in glTF's JSON
inline constexpr int kJsonDepth = 64;
// bytes of a body's or character's JSON
inline constexpr std::size_t kJsonBytes = std::size_t{64} << 20;
// bytes of a crowd's JSON
inline constexpr std::size_t kCrowdJsonBytes = std::size_t{512} << 20;
// bytes of a .gltf, with the data that its text holds
inline constexpr std::size_t kGltfTextBytes = std::size_t{1} << 30;
// nodes of a body or character
inline constexpr std::size_t kNodes = 65536;
// joints of a person of a crowd
inline constexpr std::size_t kCrowdJoints = 256;

// seconds that reading an FBX or COLLADA file may take
inline constexpr int kImportSeconds = 60;
// bytes of memory that reading an FBX or COLLADA file may take
inline constexpr std::size_t kImportMemory = std::size_t{4} << 30;
// bytes of the glTF that an FBX or COLLADA file becomes
inline constexpr std::size_t kImportBytes = std::size_t{1} << 30;

// muscles of a character
inline constexpr int kMuscles = 4096;
// sheets of fascia of a character
inline constexpr int kFasciaSheets = 1024;
// rows, and columns, of a sheet of fascia
inline constexpr int kFasciaRows = 256;
// sections of all muscles of a character
inline constexpr int kSlices = 65536;
// sections of a muscle strip
inline constexpr int kStripSlices = 64;
// points of a strip's path
inline constexpr int kPathPoints = 32;
// surfaces that a strip's path wraps over
inline constexpr int kStripWraps = 64;

// joints of a motion
inline constexpr std::size_t kMotionJoints = 65535;
// joints within each other
inline constexpr std::size_t kMotionDepth = 256;
// frames of a motion
inline constexpr int kMotionFrames = 1 << 20;

// elements within each other
inline constexpr int kXmlDepth = 256;
// bodies, functions and includes of a model within each other
inline constexpr int kModelDepth = 64;
// files that a model includes
inline constexpr int kModelFiles = 256;
// bodies, wrap objects and path points of a model, each
inline constexpr int kModelParts = 20000;

}  // namespace ecorche::inline v1::limits
