#include "skinning/motion/activation.h"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "skinning/motion/name_pattern.h"

namespace ecorche::inline v1 {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// The muscle's part of a path: what lies before a closing "activation", after the last slash.
std::string plain_name(std::string_view name) {
  std::string text = lower(name);
  for (const std::string_view end : {"/activation", ".activation", "|activation"})
    if (text.size() > end.size() && text.ends_with(end)) text.resize(text.size() - end.size());
  const auto slash = text.rfind('/');
  return slash == std::string::npos ? text : text.substr(slash + 1);
}

struct Sided {
  std::string name;
  std::string side;  // "_l", "_r" or ""
};

Sided split(const std::string& name) {
  if (name.size() > 2 && (name.ends_with("_l") || name.ends_with("_r")))
    return {name.substr(0, name.size() - 2), name.substr(name.size() - 2)};
  if (name.size() > 2 && (name.starts_with("l_") || name.starts_with("r_")))
    return {name.substr(2), std::string("_") + name[0]};
  return {name, ""};
}

void add_matches(const Anatomy& anatomy, const std::string& pattern, std::vector<int>& found) {
  const bool both = !pattern.ends_with("_l") && !pattern.ends_with("_r");
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    const std::string name = lower(anatomy.muscles[m].name);
    const Sided sided = split(name);
    if (matches_pattern(pattern, name) ||
        (both && !sided.side.empty() && name.ends_with(sided.side) &&
         matches_pattern(pattern, sided.name)))
      found.push_back(int(m));
  }
}

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = int(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

double value_between(std::span<const double> times, std::span<const double> values,
                     double seconds) {
  const auto after = std::upper_bound(times.begin(), times.end(), seconds);
  if (after == times.begin()) return values.front();
  if (after == times.end()) return values.back();
  const std::size_t k = std::size_t(after - times.begin());
  const double share = (seconds - times[k - 1]) / (times[k] - times[k - 1]);
  return values[k - 1] + share * (values[k] - values[k - 1]);
}

void activation_at(const Activations& activations, double seconds, std::vector<double>& out) {
  out.assign(std::size_t(activations.muscles), 0.0);
  for (const ActivationCurve& curve : activations.curves) {
    const double value = value_between(curve.times, curve.values, seconds);
    for (int m : curve.muscles) out[m] = std::max(out[m], value);
  }
}

std::vector<int> muscles_meant(const Anatomy& anatomy, std::string_view name,
                               const MuscleAliases& aliases) {
  const std::string text = plain_name(name);
  std::vector<int> found;
  if (text.empty()) return found;
  add_matches(anatomy, text, found);
  if (found.empty()) {
    const Sided sided = split(text);
    for (const auto& [theirs, ours] : aliases)
      if (matches_pattern(sided.name, lower(theirs)) || matches_pattern(text, lower(theirs)))
        add_matches(anatomy, lower(ours) + sided.side, found);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::string nearest_names(const Anatomy& anatomy, std::string_view name,
                          const MuscleAliases& aliases) {
  const Sided wanted = split(plain_name(name.substr(0, 100)));
  std::vector<std::pair<int, std::string>> near;
  const auto add = [&](const std::string& candidate) {
    near.emplace_back(edit_distance(wanted.name, lower(candidate)), candidate + wanted.side);
  };
  for (const Muscle& muscle : anatomy.muscles) add(split(muscle.name).name);
  for (const auto& alias : aliases) add(alias.first);
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, near.size()); ++i)
    text += (i == 0 ? "" : i == 2 ? " or " : ", ") + near[i].second;
  return text;
}

}  // namespace ecorche::inline v1
