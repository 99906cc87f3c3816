// Tries something out in a process of its own: graphics drivers that lack what they need crash
// instead of saying so.
#pragma once

#include <functional>
#include <string>

namespace ecorche {

// Why `attempt` failed in a copy of this process: what it threw, that it crashed, or that it did
// not end within `seconds`. Empty: it went well, and can be done here. What it prints is lost.
// Precondition: the libraries it uses have no threads here yet.
std::string failure_elsewhere(const std::function<void()>& attempt, double seconds = 20);

}  // namespace ecorche
