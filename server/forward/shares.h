#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <string>

namespace uplink::forward {

/// How much memory the shared set takes, as a whole and per robot that reported it, and what was
/// left out for that.
///
/// Thread: bytes and left_out from any; the rest on one thread.
class Shares final {
 public:
  struct Limits {
    std::size_t bytes_max = 0;
    std::size_t robot_bytes_max = 0;
  };
  explicit Shares(const Limits& limits) : limits_(limits) {}

  /// An item of the robot takes `after` bytes in place of `before`. False, and nothing changes, if
  /// there is no room for more.
  [[nodiscard]] bool Resize(const std::string& ruri, std::size_t before, std::size_t after);
  void NoteLeftOut() { ++left_out_; }
  void ForgetLeftOut() { left_out_ = 0; }

  [[nodiscard]] std::size_t bytes_max() const { return limits_.bytes_max; }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  /// Times that an item was left out since ForgetLeftOut.
  [[nodiscard]] std::size_t left_out() const { return left_out_.load(); }

 private:
  const Limits limits_;
  /// By robots that have any.
  std::map<std::string, std::size_t> robots_;
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::size_t> left_out_{0};
};

}  // namespace uplink::forward
