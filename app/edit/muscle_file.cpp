#include "app/edit/muscle_file.h"

#include <fmt/format.h>

#include <sstream>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche {
namespace {

constexpr std::size_t kMostBytes = 1u << 20;

// Wraps of the text, added or in place of those of their names; takes their lines out of it.
Shared<MuscleTable> take_wraps(const MuscleTable& frame, const std::string& name,
                               std::string& text) {
  auto out = std::make_shared<MuscleTable>(frame);
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("wrap ")) {
      rest += line + "\n";
      continue;
    }
    rest += "#\n";  // line numbers of messages stay
    place_wrap(*out, read_wraps(frame, line, name).front());
  }
  text = rest;
  return out;
}

}  // namespace

std::string muscle_file_text(const Document& document, const Document& built_in, int entry) {
  const EditedMuscle& muscle = *document.muscles[std::size_t(entry)];
  std::string out;
  for (const int wrap : wraps_of(muscle)) {
    const TableWrap& own = document.frame->wraps[std::size_t(wrap)];
    const int known = find_wrap(*built_in.frame, own.name);
    const std::string text = wrap_text(*document.frame, own);
    if (known < 0 || wrap_text(*built_in.frame, built_in.frame->wraps[std::size_t(known)]) != text)
      out += text;
  }
  if (!out.empty()) out += "\n";
  out += muscle_text(*document.frame, muscle.left);
  if (!muscle.right) return out;
  TableMuscle right = *muscle.right;
  right.name += "_r";
  return out + "\n" + muscle_text(*document.frame, right);
}

Document read_muscle_file(const Document& document, const Document& built_in,
                          const std::filesystem::path& file) {
  const std::string name = file.string();
  std::string text = read_input_file(file, kMostBytes);
  Document out = document;
  out.frame = take_wraps(*document.frame, name, text);
  MuscleTable table = *out.frame;
  read_muscle_text(text, name, table);
  const bool right =
      table.muscles.size() == 2 && table.muscles[1].name == table.muscles[0].name + "_r";
  if (table.muscles.size() != 1 && !right)
    throw InputError(
        fmt::format("{}: {} muscles; expected one, or one and its right side with _r at its name",
                    name, table.muscles.size()));
  const auto settled = [&](const TableMuscle& muscle) {
    return read_block(out, muscle_text(*out.frame, muscle), name);
  };
  auto muscle = std::make_shared<EditedMuscle>();
  muscle->left = settled(table.muscles[0]);
  if (right) {
    table.muscles[1].name = table.muscles[0].name;
    muscle->right = settled(table.muscles[1]);
  }
  place_entry(out, built_in, std::move(muscle));
  return out;
}

}  // namespace ecorche
