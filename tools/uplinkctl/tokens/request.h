#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/load.h"
#include "server/identity/token_table.h"

namespace uplink::ctl {

/// What --expires takes for a token without an end.
inline constexpr const char* kNever = "never";
/// How long a token counts at most, if it has an end.
inline constexpr std::chrono::days kTokenLifeMax{3650};

/// A token as it was asked for. A value.
struct TokenRequest {
  std::string role = "viewer";
  /// Names, or `*` alone.
  std::vector<std::string> fleets{};
  /// `90d`, or kNever.
  std::string expires = "90d";
  std::string note{};
};

/// The entry of such a token, without id and hash. Pure; any thread.
///
/// Errors: kInvalidArgument names the flag.
[[nodiscard]] absl::StatusOr<identity::TokenEntry> EntryOf(const TokenRequest& request,
                                                           SystemTime now);

/// Adds a new token to a file. Its text, which is nowhere else.
///
/// Errors: those of ChangeTokens; kInternal if there is no randomness.
[[nodiscard]] absl::StatusOr<std::string> AddToken(const std::string& path,
                                                   identity::TokenEntry& entry);

/// Takes a token's line out of a file; all others stay as they are.
///
/// Errors: those of ChangeTokens; kNotFound if no token has the id.
[[nodiscard]] absl::Status RevokeToken(const std::string& path, const std::string& id);

/// The file that a command works on: `file`, else http.tokens_file of the configuration (empty: the
/// usual one).
///
/// Errors: kInvalidArgument if the configuration cannot be read, or names none.
[[nodiscard]] absl::StatusOr<std::string> TokensFileOf(const std::string& file,
                                                       const std::string& config,
                                                       const config::Environment& environment);

}  // namespace uplink::ctl
