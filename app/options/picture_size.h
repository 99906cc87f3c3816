// Sizes of pictures as text, WIDTHxHEIGHT.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "anatomy/errors.h"

namespace ecorche {

// Sets width and height, pixels. False if the text is no such size.
inline bool read_picture_size(const std::string& text, int& width, int& height) {
  char trailing = 0;
  return std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &trailing) == 2;
}

// Of --size. Throws UsageError if the text is no such size.
inline void require_picture_size(const std::string& text, int& width, int& height) {
  if (!read_picture_size(text, width, height))
    throw UsageError(
        fmt::format("--size: '{}' is no size; write WIDTHxHEIGHT, for example 1280x720", text));
}

}  // namespace ecorche
