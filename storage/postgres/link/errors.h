#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <absl/status/status.h>

namespace uplink::storage::postgres {

/// What a SQLSTATE of PostgreSQL asks of us.
enum class Disposition : std::uint8_t {
  /// The world may be better soon: kUnavailable.
  kRetry,
  /// Two transactions stood in each other's way; the same again at once is right: kAborted.
  kConflict,
  /// Disk, memory or connections are used up: kResourceExhausted.
  kFull,
  /// The statement was stopped at its limit: kDeadlineExceeded.
  kTooLong,
  /// This row will never be taken; others may: kInvalidArgument, which never leaves this folder.
  kRefuseRow,
  /// Our own begin_batch: what is there must be read first. kOutOfRange, which never leaves this
  /// folder.
  kReadFirst,
  /// Wrong password, schema, rights, or our own mistake: kInternal.
  kStop,
};

/// The one table of this kind. `sqlstate` has five characters; anything else is kStop.
/// Source: PostgreSQL 15, Appendix A.
[[nodiscard]] Disposition DispositionOf(std::string_view sqlstate);

/// What libpq says, which has lines of its own, as one line: `; ` stands between its sentences.
[[nodiscard]] std::string OneLine(std::string_view text);

/// An error as the server told it.
struct ServerError {
  std::string sqlstate;
  /// The primary message; the detail after it, if there is one.
  std::string message;
};

/// `postgresql <where>: <doing>: <message> (<sqlstate>)` with the status code of its disposition;
/// of a row that is refused `<message> (<sqlstate>)` alone, since the robot is told it.
[[nodiscard]] absl::Status MakeStatus(const ServerError& error, std::string_view where,
                                      std::string_view doing);

/// The same where the server refuses to begin the session. What it does not take of the parameters
/// that `store.url` or the environment names, or what a pooler does not pass on, it will not take
/// later either: kInternal, though as the answer to a statement it would be tried again, or be a
/// row's fault.
[[nodiscard]] absl::Status MakeConnectStatus(const ServerError& error, std::string_view where);

}  // namespace uplink::storage::postgres
