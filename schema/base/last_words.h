#pragma once

#include <string_view>

#include "schema/base/clock.h"

namespace uplink {

/// How long the last words wait for the reader of standard error: a process that is about to abort
/// must not wait for ever for a pipe that nobody reads.
inline constexpr milliseconds kLastWordsWait{2000};

/// Writes to standard error why the process aborts, PIPE_BUF bytes at most. Whatever a log still
/// keeps back comes later or never. Any thread; allocates nothing.
void SayLastWords(std::string_view text);

}  // namespace uplink
