#pragma once

#include <string_view>

namespace uplink {

/// Prints what invariant of ours broke, and where, and aborts. No input may reach this.
[[noreturn]] void CheckFailed(const char* file, int line, const char* condition,
                              std::string_view text);

}  // namespace uplink

/// Aborts when an invariant of our own does not hold; in release builds too. Bad data and failures
/// of the world are values and never come here.
#define UPLINK_CHECK(condition, text)                                \
  do {                                                               \
    if (!(condition)) [[unlikely]] {                                 \
      ::uplink::CheckFailed(__FILE__, __LINE__, #condition, (text)); \
    }                                                                \
  } while (false)
