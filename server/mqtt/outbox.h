#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace uplink::mqtt {

/// Bytes that wait to be written, and how many are being written. Packets that MQTT requires are
/// always added; a PUBLISH only while there is room.
///
/// Limits:  `bytes_max` for waiting bytes and those being written together. Past it no PUBLISH is
///          added, and the owner stops reading (full()): each PUBACK frees a place of the window,
///          so the window alone bounds nothing. PUBACKs of a whole window may still be added.
/// Thread:  confined to its connection's.
class Outbox final {
 public:
  explicit Outbox(std::size_t bytes_max) : bytes_max_(bytes_max) {}

  void Add(std::string_view bytes) { waiting_.append(bytes); }
  /// False if there is no room.
  [[nodiscard]] bool AddIfRoom(std::string_view bytes) {
    if (bytes.size() > bytes_max_ - std::min(bytes_max_, this->bytes())) return false;
    waiting_.append(bytes);
    return true;
  }
  /// Takes all waiting bytes, which count as being written until Written.
  [[nodiscard]] std::string Take() {
    writing_ += waiting_.size();
    return std::exchange(waiting_, {});
  }
  void Written() { writing_ = 0; }

  [[nodiscard]] bool full() const { return bytes() >= bytes_max_; }
  [[nodiscard]] bool waiting() const { return !waiting_.empty(); }
  [[nodiscard]] bool writing() const { return writing_ > 0; }
  [[nodiscard]] std::size_t bytes() const { return waiting_.size() + writing_; }

 private:
  const std::size_t bytes_max_;
  std::string waiting_;
  std::size_t writing_ = 0;
};

}  // namespace uplink::mqtt
