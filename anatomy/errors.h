// What can go wrong, by whose fault it is. The executable gives each type an exit code
// (app/cli/main.cpp).
//
// A message names the file, the part, the value and the next step:
//   "run.bvh:57: joint 'Hips': unknown channel 'Zrot'; expected Xposition .. Zrotation"
// Broken preconditions of our own functions are std::invalid_argument (our bug).
#pragma once

#include <stdexcept>
#include <string>

namespace ecorche::inline v1 {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct UsageError : Error {  // the command line asks for something that cannot be meant
  using Error::Error;
};
struct InputError : Error {  // unreadable or malformed file
  using Error::Error;
};
struct UnfitError : Error {  // well-formed, but not what the operation needs
  using Error::Error;
};
struct LimitError : Error {  // more than a stated limit of size, memory or time
  using Error::Error;
};
struct OutputError : Error {  // could not be written
  using Error::Error;
};

}  // namespace ecorche::inline v1
