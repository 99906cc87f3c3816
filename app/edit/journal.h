// The actions since a project was last saved, on disk before the next one is begun: a text to which
// lines are only ever appended.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche {

// Whole lines of a journal; one that was torn off in its midst is left out. None where there is no
// file.
std::vector<std::string> read_journal(const std::filesystem::path& file);

inline constexpr const char* kJournalFile = "journal.txt";

// Lines of a journal from which on it goes on from a document that is kept beside it, and where
// that is; what stands before them counts no more. `saves`: it was being saved.
inline constexpr std::string_view kFrom = "from ", kSaves = "saves ";

// The first line of a journal that counts, and the folder that it goes on from; empty: from what
// the journal began with. `saves_only`: as if all that was not saved were not there.
struct JournalBegin {
  std::size_t line = 0;
  std::string folder;
};
JournalBegin begin_of_journal(const std::vector<std::string>& lines, bool saves_only = false);

// Whether a running session has it.
bool is_journal_held(const std::filesystem::path& file);

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
