#include "storage/sqlite/errors.h"

#include <string>

#include <sqlite3.h>

namespace uplink::storage::sqlite {

Disposition DispositionOf(int code) {
  switch (code & 0xFF) {
    case SQLITE_BUSY:      // another connection writes for longer than the busy timeout
    case SQLITE_LOCKED:    // as BUSY, within one process
    case SQLITE_PROTOCOL:  // a race for the WAL's locks
    case SQLITE_IOERR:     // a disk or network mount may come back
    case SQLITE_CANTOPEN:  // no descriptor left, or the folder is away
    case SQLITE_ABORT:     // rolled back under us
      return Disposition::kRetry;
    case SQLITE_FULL:
    case SQLITE_NOMEM:
      return Disposition::kFull;
    case SQLITE_INTERRUPT:
      return Disposition::kTooLong;
    case SQLITE_CONSTRAINT:
    case SQLITE_TOOBIG:
    case SQLITE_MISMATCH:
      return Disposition::kRefuseRow;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return Disposition::kDamage;
    default:  // a foreign enumeration: whatever it grows by is ours to look at first
      return Disposition::kStop;
  }
}

absl::Status MakeStatus(int code, std::string_view path, std::string_view doing,
                        std::string_view message) {
  std::string text = "sqlite ";
  text += path;
  text += ": ";
  text += doing;
  text += ": ";
  text += message;
  text += " (" + std::to_string(code) + ")";
  switch (DispositionOf(code)) {
    case Disposition::kRetry:
      return absl::UnavailableError(text);
    case Disposition::kFull:
      return absl::ResourceExhaustedError(text);
    case Disposition::kTooLong:
      return absl::DeadlineExceededError(text);
    case Disposition::kRefuseRow:  // told to the robot: without our path and statement
      return absl::InvalidArgumentError(std::string(message) + " (" + std::to_string(code) + ")");
    case Disposition::kDamage:
      return absl::DataLossError(text);
    case Disposition::kStop:
      return absl::InternalError(text);
  }
  return absl::InternalError(text);
}

}  // namespace uplink::storage::sqlite
