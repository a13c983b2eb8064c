#pragma once

#include <cstdint>

namespace uplink::journal {

/// To what a store was connected anew.
enum class Reconnected : std::uint8_t {
  /// The same run of the same server and database: it has all that it told.
  kSameServer,
  /// Another one, or a store that cannot tell: it may lack the last commits.
  kMayHaveGoneBack,
};

}  // namespace uplink::journal
