// The names most like a mistyped one, for "did you mean".
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

// Names that differ from `name` by few letters (Damerau-Levenshtein distance up to a third of its
// length, letter case aside), or that contain it or begin as it does; the most similar first, at
// most `most`.
std::vector<std::string> similar_names(std::string_view name, std::span<const std::string> names,
                                       std::size_t most = 3);

// "; did you mean a, b or c?", or "" where no name is similar.
std::string did_you_mean(std::string_view name, std::span<const std::string> names);

}  // namespace ecorche::inline v1
