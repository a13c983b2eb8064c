#include "schema/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace uplink {

void CheckFailed(const char* file, int line, const char* condition, std::string_view text) {
  std::fprintf(stderr, "uplinkd: broken invariant at %s:%d: %s (%.*s)\n", file, line, condition,
               static_cast<int>(text.size()), text.data());
  std::abort();
}

}  // namespace uplink
