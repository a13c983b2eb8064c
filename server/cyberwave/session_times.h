#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "server/cyberwave/limits.h"

namespace uplink::cyberwave {

/// Stands for a publisher's session. Two sessions with the same number count as one: at worst, a
/// twin's messages make each other late.
using SessionNumber = std::uint64_t;

[[nodiscard]] SessionNumber SessionNumberOf(std::string_view session_id);

/// The last time that each session stated for one value: clocks of two publishers are never
/// compared. A value of fixed size.
class SessionTimes final {
 public:
  /// False for a message whose time is before the last one of its session. Otherwise its time is
  /// the last one from now on. An unknown time (0) is never before, and changes nothing.
  [[nodiscard]] bool Take(SessionNumber session, std::int64_t timestamp_us);

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct Last {
    SessionNumber session = 0;
    std::int64_t timestamp_us = 0;
  };
  /// The latest heard first.
  std::array<Last, kSessionsOfValueMax> last_;
  std::size_t size_ = 0;
};

}  // namespace uplink::cyberwave
