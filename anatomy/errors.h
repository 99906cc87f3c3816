// What can go wrong, by whose fault it is. The executable turns each type into the exit code it
// names.
//
// A message names the file, the part, the value and the next step:
//   "run.bvh:57: joint 'Hips': unknown channel 'Zrot'; expected Xposition .. Zrotation"
// Broken preconditions of our own functions are std::invalid_argument (exit code 1, our bug).
#pragma once

#include <stdexcept>
#include <string>

namespace ecorche {

class Error : public std::runtime_error {
 public:
  Error(int exit_code, const std::string& message)
      : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

struct UsageError : Error {  // the command line asks for something that cannot be meant
  explicit UsageError(const std::string& m) : Error(2, m) {}
};
struct InputError : Error {  // unreadable or malformed file
  explicit InputError(const std::string& m) : Error(3, m) {}
};
struct UnfitError : Error {  // well-formed, but not what the operation needs
  explicit UnfitError(const std::string& m) : Error(4, m) {}
};
struct LimitError : Error {  // more than a stated limit of size, memory or time
  explicit LimitError(const std::string& m) : Error(5, m) {}
};
struct OutputError : Error {  // could not be written
  explicit OutputError(const std::string& m) : Error(6, m) {}
};

}  // namespace ecorche
