#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "schema/base/clock.h"

namespace uplink::journal {

/// A commit that takes at least this long is logged at level debug: a disk's flush takes a fraction
/// of it, and robots do not notice it yet.
inline constexpr milliseconds kSlowCommit{100};

/// A commit of the store that took kSlowCommit or longer. A value.
struct SlowCommit {
  std::size_t records = 0;
  std::size_t presence_changes = 0;
  milliseconds took{0};
};

/// What a store is connected to after a new connection.
enum class Reconnected : std::uint8_t {
  /// The same run of the same server and database: it has everything that it confirmed.
  kSameServer,
  /// Another one, or a store that cannot say: it may lack the last commits.
  kMayHaveGoneBack,
};

/// An OpenStream or a drone's claim found the robot in another fleet in the store, and moved it. A
/// value.
struct Moved {
  std::string ruri;
  /// The fleet in which the store had it, and that of the OpenStream.
  std::string from;
  std::string to;
  /// The subject of the stream's gateway; empty: it came by the robot's own certificate, or from a
  /// broker.
  std::string gateway;
};

}  // namespace uplink::journal
