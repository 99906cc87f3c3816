// Numbers as bytes, as they lie in memory, for what stays on the machine that wrote it: caches, and
// exchange with programs of ours.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

template <class T>
requires std::is_trivially_copyable_v<T>
void put_bytes(std::string& out, const T* values, std::size_t count) {
  out.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

// Throws InputError when fewer are left; nothing is read then.
template <class T>
requires std::is_trivially_copyable_v<T>
void take_bytes(std::string_view& in, T* values, std::size_t count) {
  if (count > in.size() / sizeof(T)) throw InputError("shorter than its contents say");
  std::memcpy(values, in.data(), count * sizeof(T));
  in.remove_prefix(count * sizeof(T));
}

// With a hash behind, which says whether all is there and as it was. Throws InputError when it is
// not.
std::string sealed(std::string bytes);
std::string_view unsealed(std::string_view bytes);

}  // namespace ecorche::inline v1
