#pragma once

#include <cstddef>
#include <string>

#include <absl/status/statusor.h>

namespace uplink::ctl {

/// Where a server answers. A value.
struct ServerUrl {
  /// HOST:PORT; or the path of a Unix socket, which begins with a slash.
  std::string address;
  /// What a proxy wants before /api: empty, or `/fleet`.
  std::string prefix = {};
  /// It is asked by https.
  bool tls = false;
};

/// How a URL is written, for help and errors.
inline constexpr const char* kUrlForms = "http://HOST:PORT, https://HOST:PORT or unix:/PATH";

/// Reads `http://HOST[:PORT][/PATH]`, the same with https, or `unix:/PATH`; `named` says in errors
/// where the text comes from.
///
/// Errors: kInvalidArgument says what is wrong.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<ServerUrl> ParseServerUrl(const std::string& url,
                                                       const std::string& named);

/// The URL of an address, for people.
[[nodiscard]] std::string ToText(const ServerUrl& url);

}  // namespace uplink::ctl
