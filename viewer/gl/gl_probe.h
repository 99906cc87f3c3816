// Runs an attempt in a child process, since graphics drivers that lack a resource crash instead of
// returning an error.
#pragma once

#include <functional>
#include <string>

namespace ecorche {

// Reason why `attempt` failed in a forked child: the exception's message, a crash, or no end within
// `seconds`. Empty if it succeeded. Its output is discarded.
// Precondition: the libraries it uses have no threads here yet.
std::string failure_in_child(const std::function<void()>& attempt, double seconds = 20);

}  // namespace ecorche
