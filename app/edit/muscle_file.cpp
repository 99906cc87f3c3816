#include "app/edit/muscle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"

namespace ecorche {
namespace {

constexpr std::size_t kMostBytes = 1u << 20;

int find_wrap(const MuscleTable& table, const std::string& name) {
  const auto at = std::ranges::find(table.wraps, name, &TableWrap::name);
  return at == table.wraps.end() ? -1 : int(at - table.wraps.begin());
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file.string()));
  std::string text(std::istreambuf_iterator<char>(in), {});
  if (text.size() > kMostBytes)
    throw LimitError(fmt::format("{}: larger than {} bytes", file.string(), kMostBytes));
  return text;
}

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
    MuscleTable one;
    one.landmarks = frame.landmarks;
    read_muscle_text(line, name, one);
    const int known = find_wrap(*out, one.wraps.front().name);
    if (known < 0)
      out->wraps.push_back(one.wraps.front());
    else
      out->wraps[std::size_t(known)] = one.wraps.front();
  }
  text = rest;
  return out;
}

}  // namespace

std::string muscle_file_text(const Document& document, const Document& built_in, int entry) {
  const EditedMuscle& muscle = *document.muscles[std::size_t(entry)];
  std::set<int> used;
  const auto add_used = [&used](const TableMuscle& side) {
    for (const TableStrip& strip : side.strips)
      for (const TableStrip::WrapUse& use : strip.wraps) used.insert(use.wrap);
  };
  add_used(muscle.left);
  if (muscle.right) add_used(*muscle.right);
  std::string out;
  for (const int wrap : used) {
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
  std::string text = read_text(file);
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
