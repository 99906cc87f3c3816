#include "anatomy/files/byte_stream.h"

#include "anatomy/files/package_archive.h"

namespace ecorche::inline v1 {

std::string sealed(std::string bytes) {
  bytes += sha256(bytes);
  return bytes;
}

std::string_view unsealed(std::string_view bytes) {
  constexpr std::size_t kHashSize = 64;
  if (bytes.size() < kHashSize) throw InputError("shorter than its hash");
  const std::string_view content = bytes.substr(0, bytes.size() - kHashSize);
  if (sha256(content) != bytes.substr(content.size())) throw InputError("damaged");
  return content;
}

}  // namespace ecorche::inline v1
