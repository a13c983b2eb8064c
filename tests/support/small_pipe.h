#pragma once

#include <string>
#include <string_view>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "tests/support/eventually.h"

namespace uplink::testing {

/// A pipe of one page whose reader reads when the test wants it to. Linux calls it writable only
/// while it is empty. One thread reads.
class SmallPipe final {
 public:
  SmallPipe() {
    UPLINK_CHECK(pipe2(ends_, O_CLOEXEC) == 0, "a test can open a pipe");
    UPLINK_CHECK(fcntl(writer(), F_SETPIPE_SZ, kBytes) == kBytes, "pipes of a page are possible");
  }
  ~SmallPipe() {
    CloseReader();
    CloseWriter();
  }
  SmallPipe(const SmallPipe&) = delete;
  SmallPipe& operator=(const SmallPipe&) = delete;

  static constexpr int kBytes = 4096;

  [[nodiscard]] int writer() const { return ends_[1]; }
  /// Nothing more fits until something is read.
  void Fill() const {
    const std::string page(kBytes, '.');
    UPLINK_CHECK(write(writer(), page.data(), page.size()) == kBytes, "the pipe was empty");
  }
  void CloseReader() { Close(ends_[0]); }
  void CloseWriter() { Close(ends_[1]); }
  /// Reads on until the text holds `part`: all that was read since the pipe was made. What there is
  /// if the part does not come within the test's patience, or the writer is closed.
  const std::string& ReadUntil(std::string_view part) {
    const SteadyTime end = SystemClock().Steady() + kPatience;
    while (text_.find(part) == std::string::npos && SystemClock().Steady() < end) {
      pollfd readable{.fd = ends_[0], .events = POLLIN, .revents = 0};
      if (poll(&readable, 1, 100) <= 0) continue;
      char bytes[kBytes];
      const ssize_t n = read(ends_[0], bytes, sizeof(bytes));
      if (n <= 0) break;
      text_.append(bytes, static_cast<std::size_t>(n));
    }
    return text_;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static void Close(int& end) {
    if (end >= 0) close(end);
    end = -1;
  }

  int ends_[2];
  std::string text_;
};

}  // namespace uplink::testing
