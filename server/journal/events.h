#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "schema/base/clock.h"

namespace uplink::journal {

/// A commit that takes this long or longer is worth a line of level debug: a disk's flush takes a
/// fraction of it, and robots do not notice it yet.
inline constexpr milliseconds kSlowCommit{100};

/// A commit of the store that took kSlowCommit or longer. A value.
struct SlowCommit {
  std::size_t records = 0;
  std::size_t presence_changes = 0;
  milliseconds took{0};
};

/// To what a store was connected anew.
enum class Reconnected : std::uint8_t {
  /// The same run of the same server and database: it has all that it told.
  kSameServer,
  /// Another one, or a store that cannot tell: it may lack the last commits.
  kMayHaveGoneBack,
};

/// An OpenStream of the robot, or a claim of it as a drone, found it in another fleet in the store,
/// and moved it. A value.
struct Moved {
  std::string ruri;
  /// The fleet in which the store had it, and that of the OpenStream.
  std::string from;
  std::string to;
  /// The subject of the gateway that the stream came through; empty: it came by the robot's own
  /// certificate, or from a broker.
  std::string gateway;
};

}  // namespace uplink::journal
