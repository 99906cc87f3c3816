#include "skinning/motion_files/read_markers.h"

#include <string>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "skinning/motion_files/c3d_read.h"
#include "skinning/motion_files/trc_read.h"

namespace ecorche::inline v1 {

MarkerTake read_markers(const std::filesystem::path& file, const MotionReadOptions& options) {
  if (!options.take.empty())
    throw UsageError(printable(file.string()) + ": --take: the file has one motion; leave it out");
  if (!options.skeleton.empty())
    throw UsageError(printable(file.string()) + ": --skeleton: markers have none; leave it out");
  const std::string name = printable(file.filename().string());
  const std::string bytes = read_input_file(file, limits::kMotionBytes);
  MarkerTake out =
      is_c3d(bytes) ? parse_c3d(bytes, name, options.fps) : parse_trc(bytes, name, options.fps);
  cut_take(options.range, out);
  return out;
}

}  // namespace ecorche::inline v1
