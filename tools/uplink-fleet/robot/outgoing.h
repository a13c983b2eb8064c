#pragma once

#include <cstdint>
#include <string>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// How a message is settled (protocol: Kinds), as its agent knows it.
enum class Keeping : std::uint8_t { kLive, kDurable };
enum class Content : std::uint8_t { kRoverNexus, kRcanRobotState, kNone };

/// A message that the agent wants delivered. A value.
struct Outgoing {
  Keeping keeping = Keeping::kLive;
  Content content = Content::kRoverNexus;
  std::string payload;
  /// The caller's own mark; comes back when the message is settled.
  std::uint64_t tag = 0;
  /// When it was to be sent.
  SteadyTime due{};
  /// What the message is the latest of (a shape's or an object's id, settings): only the latest is
  /// sent of those that wait. Empty: each one counts.
  std::string latest_of{};
};

}  // namespace uplink::synthetic
