// --filter: changes of a motion, in words.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "skinning/filters/motion_filters.h"

namespace CLI {
class App;
}

namespace ecorche {

// --filter NAME[=VALUE][,KEY=VALUE..], may be given several times.
void add_filter_option(CLI::App& verb, std::vector<std::string>& filters);

// A motion that another one goes over to, on the same body.
using SecondMotion = std::function<FilteredMotion(const std::filesystem::path& file)>;

// In the order given. Throws UsageError that names the filter, the value and what to write instead;
// InputError for a table of points; as `second` for the motion of a blend.
std::vector<MotionFilter> to_filters(const std::vector<std::string>& words,
                                     const SecondMotion& second);

}  // namespace ecorche
