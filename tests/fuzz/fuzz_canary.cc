#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/check.h"

/// A target with a bug on purpose: a fuzzer that runs must find the word, and the replay of the
/// corpus, which holds it, must fail.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const void* bytes = data;
  const std::string_view input(static_cast<const char*>(bytes), size);
  UPLINK_CHECK(!input.starts_with("fly"), "the canary was found");
  return 0;
}
