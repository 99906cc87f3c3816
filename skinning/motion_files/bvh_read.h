// Reads Biovision hierarchy (.bvh) motions, and trusts nothing in them.
//
// Accepted without complaint: tabs, CRLF, a UTF-8 byte order mark, any case of the keywords, names
// with spaces or colons, 0 to 6 channels in any order on any joint, joints without an End Site.
// Accepted with a line in `warnings`: several ROOTs, names that are empty, repeated or not UTF-8
// (made unique), a motion cut short (whole frames are kept), a `Frames:` that is not the truth.
// Everything else that is wrong is an InputError "file:line: part: value; what to do".
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "skinning/motion_files/bvh_motion.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct BvhReadOptions {
  // takes the place of the file's `Frame Time`, which may then be nonsense
  std::optional<double> fps;
};

// Throws InputError (see above; nested deeper than 256 or more than 65,535 joints too) and
// LimitError (larger than 1 GiB).
BvhMotion read_bvh(const std::filesystem::path& file, const BvhReadOptions& options = {});
BvhMotion parse_bvh(std::string_view text, const std::string& name,
                    const BvhReadOptions& options = {});

// The channels as rotations and translations. A position channel takes the place of that part of
// the offset.
MotionClip clip_from_bvh(const BvhMotion& motion);

}  // namespace ecorche::inline v1
