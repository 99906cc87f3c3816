// Biovision hierarchy (.bvh) motions: a reader that trusts nothing, and a writer.
//
// The reader keeps the file's own numbers: its units, its axes, degrees. What they mean is decided
// in retarget.h. Accepted without complaint: tabs, CRLF, a UTF-8 byte order mark, any case of the
// keywords, names with spaces or colons, 0 to 6 channels in any order on any joint, joints without
// an End Site. Accepted with a line in `warnings`: several ROOTs, names that are empty, repeated or
// not UTF-8 (made unique), a motion cut short (whole frames are kept), a `Frames:` that is not the
// truth. Everything else that is wrong is an InputError "file:line: part: value; what to do".
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"

namespace ecorche {

enum class BvhChannel { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct BvhJoint {
  std::string name;
  int parent = -1;             // parents precede children; -1 for a ROOT
  Vec3 offset = Vec3::Zero();  // from the parent, file units
  // in the file's order, which is the order of the rotations: R = R1 R2 R3, column vectors
  std::vector<BvhChannel> channels;
  int first_channel = 0;        // column of the first one in a frame
  std::vector<Vec3> end_sites;  // offsets from this joint, file units
};

struct BvhMotion {
  std::string name;  // of the file, for messages
  std::vector<BvhJoint> joints;
  // the rational rate that a rounded `Frame Time` stands for: .0083333 is 120, 0.041708 is
  // 24000/1001
  double fps = 30;
  double frame_time = 1.0 / 30;  // as written, s
  int channels = 0;              // columns of a frame
  int frames = 0;
  std::vector<double> samples;  // frames x channels, degrees and file units
  std::vector<std::string> warnings;
};

struct BvhReadOptions {
  std::optional<double>
      fps;  // takes the place of the file's `Frame Time`, which may then be nonsense
};

// Throws InputError (see above; nested deeper than 256 or more than 65,535 joints too) and
// LimitError (larger than 1 GiB).
BvhMotion read_bvh(const std::filesystem::path& file, const BvhReadOptions& options = {});
BvhMotion parse_bvh(std::string_view text, const std::string& name,
                    const BvhReadOptions& options = {});

// Text with '\n' line ends and as many digits as a double needs to come back to 1e-9.
// Precondition (std::invalid_argument): samples has frames x channels finite entries.
std::string format_bvh(const BvhMotion& motion);

// Written beside its place and renamed. Throws OutputError.
void write_bvh(const std::filesystem::path& file, const BvhMotion& motion);

// World frames of the file's joints in its own units and axes. A position channel takes the place
// of that part of the offset. frame -1 is the rest pose: all rotations zero, offsets only. `out` is
// resized once and then reused.
void bvh_kinematics(const BvhMotion& motion, int frame, std::vector<Transform>& out);

// Our own skeleton and a motion of it as a BVH in metres, joint names ours, every joint's rotation
// in Z-X-Y order.
BvhMotion to_bvh(const Skeleton& skeleton, const Motion& motion);

}  // namespace ecorche
