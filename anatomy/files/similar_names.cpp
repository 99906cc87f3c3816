#include "anatomy/files/similar_names.h"

#include <algorithm>
#include <cctype>

namespace ecorche::inline v1 {
namespace {

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// Letters added, left out, changed, or swapped with their neighbour (optimal string alignment).
int edit_distance(std::string_view a, std::string_view b) {
  const int rows = int(a.size()) + 1, columns = int(b.size()) + 1;
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (int i = 0; i < rows; ++i) d[i][0] = i;
  for (int j = 0; j < columns; ++j) d[0][j] = j;
  for (int i = 1; i < rows; ++i) {
    for (int j = 1; j < columns; ++j) {
      const int changed = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::vector<std::string> similar_names(std::string_view name, std::span<const std::string> names,
                                       std::size_t most) {
  constexpr std::size_t kLongest = 200;  // what is longer is no slip of a finger
  if (name.empty() || name.size() > kLongest) return {};
  const std::string asked = lower_case(name);
  const int allowed = std::max<int>(1, int(asked.size() + 2) / 3);
  struct Candidate {
    int distance;
    std::string name;
  };
  std::vector<Candidate> found;
  for (const std::string& each : names) {
    const std::string known = lower_case(each);
    const int distance = edit_distance(asked, known);
    const bool part = asked.size() >= 3 && known.find(asked) != std::string::npos;
    if (distance <= allowed || part)
      found.push_back({part ? std::min(distance, allowed) : distance, each});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::vector<std::string> out;
  for (Candidate& each : found)
    if (out.size() < most) out.push_back(std::move(each.name));
  return out;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> names) {
  const std::vector<std::string> similar = similar_names(name, names);
  std::string list;
  for (std::size_t i = 0; i < similar.size(); ++i)
    list += (i == 0 ? "" : i + 1 == similar.size() ? " or " : ", ") + similar[i];
  return list.empty() ? "" : "; did you mean " + list + "?";
}

}  // namespace ecorche::inline v1
