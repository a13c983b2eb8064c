#pragma once

#include <string>

#include <absl/status/statusor.h>

namespace uplink::ctl {

/// Where a server answers. A value.
struct ServerUrl {
  /// HOST:PORT.
  std::string address;
  /// What a proxy wants before /api: empty, or `/fleet`.
  std::string prefix;
};

/// Reads `http://HOST[:PORT][/PATH]`; `named` says in errors where the text comes from.
///
/// Errors: kInvalidArgument says what is wrong, and for https and a user what to do instead.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<ServerUrl> ParseServerUrl(const std::string& url,
                                                       const std::string& named);

}  // namespace uplink::ctl
