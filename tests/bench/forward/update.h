#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::bench {

/// Objects that are updated in turn.
inline constexpr std::size_t kUpdatedObjects = 100;

/// One update of an object that a fleet shares. A value.
struct Update {
  std::size_t number = 0;
  /// When it is published. The object's name carries it, so that a receiver knows how long the
  /// object was under way.
  SteadyTime at;
};

/// What a robot reports: an UplinkMsg.
[[nodiscard]] std::string ReportOf(const Update& update);
/// What another robot gets of it: the bytes of a RelayResponse as uplinkd makes them. Brokers carry
/// the same.
[[nodiscard]] std::string ForwardOf(const Update& update, std::string_view origin_ruri);
/// When the update that the message carries was published; nothing if it carries none.
[[nodiscard]] std::optional<SteadyTime> PublishedAt(std::string_view message);

}  // namespace uplink::bench
