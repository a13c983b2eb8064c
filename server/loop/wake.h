#pragma once

#include <cstdint>

namespace uplink::loop {

/// Wakes streams on their own thread. Thread-safe. An inbox outlives every thread that may wake
/// through it; waking a stream that is gone does nothing.
class WakeInbox {
 public:
  virtual ~WakeInbox() = default;
  /// OnWake of that stream runs soon on its thread; several wakes may become one.
  virtual void Wake(std::uint64_t stream) = 0;
};

/// Names one stream to other threads. A value.
struct StreamRef {
  WakeInbox* inbox = nullptr;
  std::uint64_t stream = 0;

  void Wake() const {
    if (inbox != nullptr) inbox->Wake(stream);
  }
  [[nodiscard]] explicit operator bool() const { return inbox != nullptr; }
  friend bool operator==(const StreamRef&, const StreamRef&) = default;
};

}  // namespace uplink::loop
