#include "storage/postgres/link/errors.h"

#include <algorithm>
#include <array>
#include <cctype>

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

/// What an operator does about a login that fails, by its SQLSTATE.
struct Remedy {
  std::string_view sqlstate;
  std::string_view text;
};
constexpr auto kRemedies = std::to_array<Remedy>({
    {"28000", "; correct the role in the URL, or let pg_hba.conf admit it from this machine"},
    {"28P01", "; correct the password file, or set the role's password anew"},
    {"3D000", "; create the database, or correct its name in the URL"},
});

std::string_view RemedyOf(const ServerError& error) {
  if (RefusesParameter(error)) {
    return "; the parameter comes from store.url, or from the environment (PGOPTIONS and the like)";
  }
  const auto* const found = std::ranges::find(kRemedies, error.sqlstate, &Remedy::sqlstate);
  return found == kRemedies.end() ? std::string_view() : found->text;
}

/// With one space for each run of spaces within it.
std::string Squeezed(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\t' || c == '\r';
    if (!space) {
      line += c;
    } else if (!line.empty() && !line.ends_with(' ')) {
      line += ' ';
    }
  }
  if (line.ends_with(' ')) line.pop_back();
  return line;
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
  while (!text.empty()) {
    const std::string_view raw = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), raw.size() + 1));
    const std::string part = Squeezed(raw);
    if (part.empty()) continue;
    // libpq indents the second line of a sentence, and a sentence that explains the one before.
    const bool goes_on =
        raw.front() == '\t' && std::islower(static_cast<unsigned char>(part[0])) != 0;
    if (!line.empty()) line += goes_on ? " " : "; ";
    line += part;
  }
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
  const std::string_view remedy = RemedyOf(error);
  if (remedy.empty()) return MakeStatus(error, where, "connect");
  std::string text = "postgresql ";
  text += where;
  text += ": connect: " + error.message + " (" + error.sqlstate + ")";
  return absl::InternalError(text.append(remedy));
}

}  // namespace uplink::storage::postgres
