// The actions since a project was last saved, on disk before the next one is begun: a text to which
// lines are only ever appended.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ecorche {

// Whole lines of a journal; one that was torn off in its midst is left out. None where there is no
// file.
std::vector<std::string> read_journal(const std::filesystem::path& file);

class Journal {
 public:
  // Opens it for appending, behind the last whole line. Throws OutputError with the system's
  // reason, also where another session holds it.
  explicit Journal(std::filesystem::path file);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  void append(const std::string& line);  // on disk when it returns
  void begin();                          // forgets all lines

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace ecorche
