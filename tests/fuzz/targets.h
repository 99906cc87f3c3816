// What is thrown at the readers: each takes any bytes, and may refuse them with one of our errors,
// but nothing else.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace ecorche::test {

// By name: bvh, motion, mesh, body, character, crowd, table, poses, weights, activation, osim,
// mjcf, stl, map, markers. Throws for bytes that a reader let through though they are none of what
// it promises.
const std::map<std::string, std::function<void(std::string_view bytes)>>& fuzz_targets();

}  // namespace ecorche::test
