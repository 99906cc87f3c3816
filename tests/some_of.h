// How much the tests try: a share of their cases, or all of them where ECORCHE_THOROUGH is set
// (`make thorough`).
#pragma once

#include <cstddef>
#include <cstdlib>
#include <vector>

namespace ecorche {

inline bool thorough() { return std::getenv("ECORCHE_THOROUGH") != nullptr; }

// Every `step`th of the cases from the one numbered `first` on; all where tests are thorough. Tests
// of one list begin at different places, so that together they try most of it.
template <class Case>
std::vector<Case> some_of(const std::vector<Case>& all, std::size_t first = 0,
                          std::size_t step = 4) {
  if (thorough()) return all;
  std::vector<Case> out;
  for (std::size_t i = first; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

}  // namespace ecorche
