#pragma once

#include <cstdint>
#include <string_view>

#include <absl/status/status.h>

namespace uplink::storage::sqlite {

/// What a result code of SQLite asks of us.
enum class Disposition : std::uint8_t {
  /// The world may be better soon: kUnavailable.
  kRetry,
  /// Disk or memory is used up: kResourceExhausted.
  kFull,
  /// The query was stopped at its limit: kDeadlineExceeded.
  kTooLong,
  /// This row will never be taken; others may: kInvalidArgument, which never leaves this folder.
  kRefuseRow,
  /// SQLite read something that no database holds: kDataLoss.
  kDamage,
  /// Rights, a folder that is read-only, or our own mistake: kInternal.
  kStop,
};

/// Takes extended codes too. The one table of this kind.
/// Source: sqlite.org/rescode.html.
[[nodiscard]] Disposition DispositionOf(int code);

/// `sqlite <path>: <doing>: <message> (<code>)` with the status code of its disposition; of a row
/// that is refused `<message> (<code>)` alone.
[[nodiscard]] absl::Status MakeStatus(int code, std::string_view path, std::string_view doing,
                                      std::string_view message);

}  // namespace uplink::storage::sqlite
