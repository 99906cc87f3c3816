// WIDTHxHEIGHT, as options of several verbs give it.
#pragma once

#include <cstdio>
#include <string>

namespace ecorche {

// In pixels. False where the text is no such size.
inline bool read_picture_size(const std::string& text, int& width, int& height) {
  char trailing = 0;
  return std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &trailing) == 2;
}

}  // namespace ecorche
