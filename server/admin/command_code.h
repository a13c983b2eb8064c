#pragma once

#include <optional>
#include <string_view>

#include <absl/status/status.h>

namespace uplink::admin {

/// How clients see that a command failed. A value.
struct CommandCode {
  /// The status code of HTTP.
  int http = 0;
  /// The canonical name: `INVALID_ARGUMENT`.
  std::string_view name;
};

/// Of a status whose message is for the client; nothing for a failure of the store, which each
/// transport words by itself. Pure.
[[nodiscard]] std::optional<CommandCode> CommandCodeOf(const absl::Status& status);

}  // namespace uplink::admin
