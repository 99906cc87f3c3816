// A motion as one OBJ file a frame: DIR/%04d.obj, counted from 1, every file with the same vertices
// and faces.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

class ObjSequenceWriter {
 public:
  // Makes the folder DIR where its parent exists. Throws UsageError for a name without one number
  // field before ".obj", OutputError.
  ObjSequenceWriter(const std::filesystem::path& pattern, const Triangles& F);

  // The lines of each file that follow its `vertices` vertices, and those that go before them,
  // ready made.
  ObjSequenceWriter(const std::filesystem::path& pattern, int vertices, std::string before,
                    std::string after);

  // Writes one file, whole or not at all; positions survive exactly. Precondition: rows of `stride`
  // floats, x y z first, for every index.
  void add_frame(std::span<const float> positions, int stride = 4);

  // Name of the frame that was or will be written as number `number` (from 1).
  std::filesystem::path name(int number) const;

 private:
  std::string before_, after_, head_ = "# metres, +Y up\n", faces_;
  int width_ = 0, frames_ = 0, highest_ = -1;
};

}  // namespace ecorche::inline v1
