#include "storage/postgres/link/errors.h"

#include <algorithm>
#include <array>

namespace uplink::storage::postgres {
namespace {

struct Row {
  /// A whole SQLSTATE, or the two characters of a class.
  std::string_view code;
  Disposition disposition;
};

// Whole codes go before their class.
constexpr auto kTable = std::to_array<Row>({
    {"UL001", Disposition::kReadFirst},  // begin_batch of our migrations
    {"08", Disposition::kRetry},         // connection exceptions
    {"22", Disposition::kRefuseRow},     // data exceptions: a NUL in a text, a number out of range
    {"23", Disposition::kRefuseRow},     // constraints, of the schema or of an operator
    {"25006", Disposition::kRetry},  // a standby, or read-only for a while: a failover is under way
    {"25P03", Disposition::kRetry},  // the session was ended for idling in a transaction
    {"25P04", Disposition::kTooLong},  // transaction_timeout (17)
    {"40", Disposition::kConflict},    // serialization failure, deadlock
    {"53100", Disposition::kFull},     // disk full
    {"53200", Disposition::kFull},     // out of memory
    {"53300", Disposition::kRetry},    // too many connections
    {"53", Disposition::kFull},
    {"54", Disposition::kRefuseRow},   // too large for an index page, a row, a field
    {"55P03", Disposition::kRetry},    // a lock was not to be had within lock_timeout
    {"57014", Disposition::kTooLong},  // statement_timeout, or an operator's cancel
    {"57", Disposition::kRetry},       // the server, or this session, was shut down
    {"58", Disposition::kRetry},       // an error of the system beneath: I/O
    {"P0", Disposition::kRefuseRow},   // an operator's trigger says no
});

/// PgBouncer answers 08P01 to everything, most of it for a while; its texts for a parameter have
/// these words. Source: src/client.c of PgBouncer 1.18 and 1.23.
constexpr std::string_view kPoolersState = "08P01";
constexpr std::string_view kPoolersWords = "startup parameter";

/// How the server refuses a parameter to a client that connects, beside its value.
constexpr auto kParameterStates = std::to_array<std::string_view>({
    "42601",  // a word in `options` is no parameter
    "42704",  // the server does not know it
    "55P02",  // it cannot be set by a session
});
/// A parameter for superusers; the same code stands for a database that the role may not use.
constexpr std::string_view kDeniedState = "42501";
constexpr std::string_view kDeniedWords = "to set parameter";

bool RefusesParameter(const ServerError& error) {
  if (DispositionOf(error.sqlstate) == Disposition::kRefuseRow) return true;
  if (std::ranges::find(kParameterStates, error.sqlstate) != kParameterStates.end()) return true;
  const auto says = [&error](std::string_view state, std::string_view words) {
    return error.sqlstate == state && error.message.find(words) != std::string::npos;
  };
  return says(kPoolersState, kPoolersWords) || says(kDeniedState, kDeniedWords);
}

}  // namespace

Disposition DispositionOf(std::string_view sqlstate) {
  if (sqlstate.size() != 5) return Disposition::kStop;
  for (const Row& row : kTable) {
    if (sqlstate.starts_with(row.code)) return row.disposition;
  }
  return Disposition::kStop;
}

std::string OneLine(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n' || c == '\t' || c == '\r';
    if (!space) {
      line += c;
    } else if (!line.empty() && !line.ends_with(' ')) {
      line += ' ';
    }
  }
  if (line.ends_with(' ')) line.pop_back();
  return line;
}

absl::Status MakeStatus(const ServerError& error, std::string_view where, std::string_view doing) {
  const std::string cause = error.message + " (" + error.sqlstate + ")";
  std::string text = "postgresql ";
  text += where;
  text += ": ";
  text += doing;
  text += ": " + cause;
  switch (DispositionOf(error.sqlstate)) {
    case Disposition::kRetry:
      return absl::UnavailableError(text);
    case Disposition::kConflict:
      return absl::AbortedError(text);
    case Disposition::kFull:
      return absl::ResourceExhaustedError(text);
    case Disposition::kTooLong:
      return absl::DeadlineExceededError(text);
    case Disposition::kRefuseRow:
      return absl::InvalidArgumentError(cause);
    case Disposition::kReadFirst:
      return absl::OutOfRangeError(text);
    case Disposition::kStop:
      return absl::InternalError(text);
  }
  return absl::InternalError(text);
}

absl::Status MakeConnectStatus(const ServerError& error, std::string_view where) {
  if (!RefusesParameter(error)) return MakeStatus(error, where, "connect");
  std::string text = "postgresql ";
  text += where;
  text += ": connect: " + error.message + " (" + error.sqlstate + ")";
  text += "; the parameter comes from store.url, or from the environment (PGOPTIONS and the like)";
  return absl::InternalError(text);
}

}  // namespace uplink::storage::postgres
