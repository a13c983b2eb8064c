#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink {

/// How WriteAll ended.
enum class Written : std::uint8_t {
  kAll,
  /// Nothing could be written for as long as it may wait.
  kLate,
  /// WriteWait::stop became readable first.
  kStopped,
  /// The descriptor takes nothing: it is closed, its reader is gone, or its disk is full.
  kFailed,
};

struct WriteWait {
  /// How long each piece waits for room; nothing: for ever.
  std::optional<milliseconds> room;
  /// A descriptor that is readable once the wait has to end; -1: none.
  int stop = -1;
};

/// Writes a text to a descriptor that may be full for long, such as a pipe whose reader stalls.
///
/// It asks for room (poll) before each piece of PIPE_BUF bytes at most, which then fits: Linux
/// calls a pipe writable only if it has a free page. The descriptor stays as it is: O_NONBLOCK
/// would hold for other processes, too, that share it.
///
/// Limits: a write can still block where another process takes that room in between.
/// Thread: any. Safe where memory is short: it allocates nothing.
[[nodiscard]] Written WriteAll(int descriptor, std::string_view text, const WriteWait& wait);

/// How long the last words wait for the reader of standard error. A process that is about to abort
/// must not wait for ever for a pipe without a reader.
inline constexpr milliseconds kLastWordsWait{2000};

/// Writes to standard error why the process aborts, PIPE_BUF bytes at most. Whatever a log still
/// keeps back comes later or never. Any thread; allocates nothing.
void SayLastWords(std::string_view text);

}  // namespace uplink
