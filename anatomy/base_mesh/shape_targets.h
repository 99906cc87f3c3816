// The targets that shape the base mesh, read from the body package on demand.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A sparse displacement of the package's points, metres.
struct ShapeTarget {
  std::vector<int> indices;
  Points offsets;  // #indices x 3
};

// Bytes of a file of the package by its path inside it ("mpfb2/3dobjs/base.obj"), or nothing when
// there is no such file. Throws InputError when it is there but cannot be read.
using PackageReader = std::function<std::optional<std::string>(const std::string& path)>;

// Reads targets when they are first asked for and keeps them. May be used by several threads at
// once.
class ShapeTargets {
 public:
  ShapeTargets(PackageReader reader, int point_count);
  ~ShapeTargets();

  // By path without ending: "macrodetails/height/male-young-averagemuscle-averageweight-maxheight".
  // nullptr when the package has no such target. Throws InputError that names file and line.
  const ShapeTarget* find(const std::string& name) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ecorche::inline v1
