// libFuzzer's way in, one executable a target.
#include <cstddef>
#include <cstdint>

#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto& target = ecorche::test::fuzz_targets().at(ECORCHE_FUZZ_TARGET);
  target({reinterpret_cast<const char*>(data), size});
  return 0;
}
