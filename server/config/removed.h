#pragma once

#include <string_view>

namespace uplink::config {

/// A key that an earlier version had and this one refuses.
struct Removed {
  std::string_view section;
  std::string_view key;
  /// `UPLINKD_LISTEN_TRANSPORT`.
  std::string_view variable;
  /// Why it is gone, for an operator. LoadConfig says behind it what to do.
  std::string_view text;
};

/// Null if there was no such key.
[[nodiscard]] const Removed* FindRemoved(std::string_view section, std::string_view key);
[[nodiscard]] const Removed* FindRemovedByEnvironment(std::string_view variable);

}  // namespace uplink::config
