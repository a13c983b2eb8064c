#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/identity/token_file.h"
#include "server/log/logger.h"

namespace uplink::http {

/// How often the files are looked at: the pages say that a change counts within 5 s.
inline constexpr std::chrono::seconds kTokensRefresh{2};

/// The tokens by which callers may ask. A value; shared between threads as immutable.
struct Tokens {
  identity::TokenTable table;
  /// Of listen.metrics; nothing: it asks for none.
  std::optional<identity::TokenHash> scrape;
};

/// Follows http.tokens_file and http.metrics_token_file. Thread-safe, but Look is of one thread.
class TokenFiles final {
 public:
  /// Paths; an empty one names no file.
  struct Paths {
    std::string tokens;
    std::string scrape;
  };
  /// The logger outlives it. There are no tokens before the first Look.
  TokenFiles(Paths paths, const log::Logger& logger);
  TokenFiles(const TokenFiles&) = delete;
  TokenFiles& operator=(const TokenFiles&) = delete;

  /// Reads the files, blocking on them. A change, a failure and its end have a line in the log
  /// each.
  ///
  /// Errors: names the file that cannot be read, has a flaw or may be written by everybody; what
  ///         was good last of that file stays in use.
  absl::Status Look();

  /// Never null. Who keeps it does not see later changes.
  [[nodiscard]] std::shared_ptr<const Tokens> tokens() const;
  /// Whether the last look found a file that is not used.
  [[nodiscard]] bool unread() const { return unread_.load(); }

 private:
  /// A file that is good is put into `tokens`; true if that changes something.
  [[nodiscard]] absl::StatusOr<bool> ReadTable(Tokens& tokens);
  [[nodiscard]] absl::StatusOr<bool> ReadScrape(Tokens& tokens) const;

  const Paths paths_;
  const log::Logger& logger_;
  /// The text of the file of tokens that is in use; nothing before the first.
  std::optional<std::string> text_;
  /// Why the files did not fit at the last look.
  std::string why_;
  std::atomic<bool> unread_{false};
  mutable std::mutex mutex_;
  std::shared_ptr<const Tokens> tokens_;
};

}  // namespace uplink::http
