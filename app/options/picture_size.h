// Sizes of pictures as text, WIDTHxHEIGHT.
#pragma once

#include <cstdio>
#include <string>

namespace ecorche {

// Sets width and height, pixels. False if the text is no such size.
inline bool read_picture_size(const std::string& text, int& width, int& height) {
  char trailing = 0;
  return std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &trailing) == 2;
}

}  // namespace ecorche
