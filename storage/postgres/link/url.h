#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

namespace uplink::storage::postgres {

/// True if the text is a URL of PostgreSQL, good or bad: `postgresql://` or `postgres://`.
[[nodiscard]] bool IsPostgresUrl(std::string_view url);

/// A `store.url` taken apart. A value.
struct Url {
  /// libpq's keywords and values, those of one place alone left out.
  std::vector<std::pair<std::string, std::string>> settings;
  /// The keywords of each place to try in turn: host, hostaddr, port.
  std::vector<std::vector<std::pair<std::string, std::string>>> places;
  /// `host:port/database`, for messages; without user and password.
  std::string shown;
};

/// Errors: kInvalidArgument, beginning with `store.url`: no URL of PostgreSQL, a parameter that
///         libpq does not know, a password (those belong into a file).
[[nodiscard]] absl::StatusOr<Url> ParseUrl(std::string_view url);

}  // namespace uplink::storage::postgres
