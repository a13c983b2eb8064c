#pragma once

#include <cstddef>
#include <string>

#include <absl/status/statusor.h>

#include "server/identity/token_table.h"

namespace uplink::identity {

/// Characters of the token that scrapes show: enough that guessing is hopeless, and few enough for
/// a header.
inline constexpr std::size_t kScrapeTokenMin = 16;
inline constexpr std::size_t kScrapeTokenMax = 512;

/// A file of tokens, and its text. A value.
struct ReadTokens {
  TokenTable table;
  std::string text;
};

/// Errors: kFailedPrecondition names the file and the cause if it cannot be read; those of
///         TokenTable::Parse.
/// Thread: any; blocks on the file, never on a pipe.
[[nodiscard]] absl::StatusOr<ReadTokens> ReadTokenFile(const std::string& path);

/// The hash of the one token in the first line of a file: kScrapeTokenMin to kScrapeTokenMax
/// characters of RFC 6750's b64token.
///
/// Errors: kFailedPrecondition names the file and the cause, never what it holds.
/// Thread: as ReadTokenFile.
[[nodiscard]] absl::StatusOr<TokenHash> ReadScrapeToken(const std::string& path);

}  // namespace uplink::identity
