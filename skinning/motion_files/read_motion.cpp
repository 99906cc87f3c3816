#include "skinning/motion_files/read_motion.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/scene_import.h"
#include "skinning/motion_files/acclaim_read.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/deepmimic_read.h"
#include "skinning/motion_files/gltf_motion.h"
#include "skinning/motion_files/npz_motion.h"
#include "skinning/motion_files/opensim_read.h"
#include "skinning/motion_files/skeleton_beside.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

std::string ending_of(const fs::path& file) {
  std::string out = file.extension().string();
  std::ranges::transform(out, out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

// Up to `size` bytes of its beginning.
std::string head_of(const fs::path& file, std::size_t size) {
  check_input_file(file);
  std::string head(size, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), std::streamsize(head.size()));
  head.resize(std::size_t(in.gcount()));
  return head;
}

// Binary glTF has endings of its own where it holds one thing alone (.vrma).
bool is_gltf(const fs::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".glb" || ending == ".gltf" || head_of(file, 4) == "glTF";
}

MotionClip read_amc(const fs::path& file, const std::string& text,
                    const MotionReadOptions& options) {
  const fs::path skeleton = options.skeleton.empty()
                                ? skeleton_beside(file, {"a skeleton (.asf)", "", {".asf"}})
                                : options.skeleton;
  return parse_amc(
      text, printable(file.filename().string()),
      parse_asf(read_input_file(skeleton, limits::kTableBytes), printable(skeleton.string())),
      options.fps);
}

MotionClip read_deepmimic(const fs::path& file, const std::string& text,
                          const MotionReadOptions& options) {
  const fs::path skeleton =
      options.skeleton.empty()
          ? skeleton_beside(file,
                            {"a character (character_NAME.txt)", "character_", {".txt", ".json"}})
          : options.skeleton;
  return parse_deepmimic(text, printable(file.filename().string()),
                         parse_deepmimic_character(read_input_file(skeleton, limits::kTableBytes),
                                                   printable(skeleton.string())),
                         options.fps);
}

bool is_zip(std::string_view bytes) { return bytes.starts_with("PK\x03\x04"); }

// Formats with one motion a file.
MotionClip read_one_motion(const fs::path& file, const MotionReadOptions& options) {
  const std::string name = printable(file.filename().string()), ending = ending_of(file);
  if (!options.take.empty())
    throw UsageError(printable(file.string()) + ": --take: the file has one motion; leave it out");
  const std::string text = read_input_file(file, limits::kMotionBytes);
  if (is_marker_file(file))
    throw UnfitError(name +
                     ": markers are a motion of one body alone; name the character that wears them "
                     "(`ecorche retarget FILE CHARACTER -o OUT.bvh`)");
  if (ending == ".asf")
    throw UnfitError(name + ": a skeleton without a motion; name an .amc of it");
  if (ending == ".amc") return read_amc(file, text, options);
  if (is_deepmimic(text)) return read_deepmimic(file, text, options);
  if (!options.skeleton.empty())
    throw UsageError(printable(file.string()) +
                     ": --skeleton: the file has its own; only .amc and DeepMimic need one");
  if (is_zip(text)) return parse_npz_motion(text, name, options.fps);
  if (ending == ".npz") throw InputError(name + ": no archive of NumPy, or cut short");
  if (ending == ".mot" || ending == ".sto")
    return clip_from_coordinates(parse_coordinates(text, name), options.fps);
  return clip_from_bvh(parse_bvh(text, name, {options.fps}));
}

}  // namespace

bool names_motion(const fs::path& file) {
  constexpr std::array<std::string_view, 7> kEndings = {".bvh", ".amc",  ".mot", ".sto",
                                                        ".txt", ".json", ".npz"};
  return is_marker_file(file) || std::ranges::find(kEndings, ending_of(file)) != kEndings.end();
}

bool is_marker_file(const fs::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".trc" || ending == ".c3d";
}

bool is_scene_motion(const fs::path& file) {
  return is_gltf(file) || scene_format(head_of(file, 65536)).has_value();
}

std::string read_scene_motion(const fs::path& file) {
  return is_gltf(file) ? read_input_file(file) : import_scene(file);
}

MotionClip read_motion(const fs::path& file, const MotionReadOptions& options) {
  MotionClip out;
  if (is_scene_motion(file)) {
    if (!options.skeleton.empty())
      throw UsageError(printable(file.string()) +
                       ": --skeleton: the file has its own; only .amc and DeepMimic need one");
    out = gltf_motion(read_scene_motion(file), printable(file.string()),
                      {options.fps, options.take}, file.parent_path());
  } else {
    out = read_one_motion(file, options);
  }
  cut_clip(options.range, out);
  return out;
}

}  // namespace ecorche::inline v1
