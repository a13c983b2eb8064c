#include "schema/base/write_all.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <climits>
#include <poll.h>
#include <unistd.h>

namespace uplink {
namespace {

/// Of poll: wait for ever.
constexpr int kForEver = -1;

bool ForNow(int error) { return error == EINTR || error == EAGAIN || error == EWOULDBLOCK; }

/// Nothing once there is room.
std::optional<Written> AwaitRoom(int descriptor, const WriteWait& wait) {
  // poll passes over a negative descriptor.
  std::array<pollfd, 2> looks{{{.fd = descriptor, .events = POLLOUT, .revents = 0},
                               {.fd = wait.stop, .events = POLLIN, .revents = 0}}};
  const int timeout = wait.room ? static_cast<int>(wait.room->count()) : kForEver;
  int ready = -1;
  do {
    ready = poll(looks.data(), looks.size(), timeout);
  } while (ready < 0 && errno == EINTR);
  if (ready < 0) return Written::kFailed;
  if (ready == 0) return Written::kLate;
  if (looks[1].revents != 0) return Written::kStopped;
  return std::nullopt;
}

}  // namespace

Written WriteAll(int descriptor, std::string_view text, const WriteWait& wait) {
  while (!text.empty()) {
    if (const std::optional<Written> ended = AwaitRoom(descriptor, wait)) return *ended;
    const ssize_t written =
        write(descriptor, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    if (written < 0 && !ForNow(errno)) return Written::kFailed;
  }
  return Written::kAll;
}

void SayLastWords(std::string_view text) {
  // One piece, one wait. There is nowhere to tell that it failed.
  static_cast<void>(
      WriteAll(STDERR_FILENO, text.substr(0, PIPE_BUF), {.room = kLastWordsWait, .stop = -1}));
}

}  // namespace uplink
