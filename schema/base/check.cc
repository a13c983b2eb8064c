#include "schema/base/check.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "schema/base/write_all.h"

namespace uplink {

void CheckFailed(const char* file, int line, const char* condition, std::string_view text) {
  // Of a longer line the end is missing, and its newline.
  std::array<char, 2048> words{};
  const int bytes =
      std::snprintf(words.data(), words.size(), "uplinkd: broken invariant at %s:%d: %s (%.*s)\n",
                    file, line, condition, static_cast<int>(text.size()), text.data());
  const auto whole = static_cast<std::size_t>(std::max(bytes, 0));
  SayLastWords({words.data(), std::min(whole, words.size() - 1)});
  std::abort();
}

}  // namespace uplink
