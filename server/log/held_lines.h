#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace uplink::log {

/// Lines that wait until a person has read others.
///
/// Thread: thread-safe.
class HeldLines final {
 public:
  /// Lines that wait at most.
  static constexpr std::size_t kLinesMax = 64;

  /// Keeps lines from now on.
  void Begin();
  /// Keeps the line; false if it keeps none now, or is full.
  [[nodiscard]] bool Add(std::string& line);
  /// Keeps no more lines, and hands over those that waited.
  [[nodiscard]] std::vector<std::string> Take();

 private:
  std::mutex mutex_;
  bool keeps_ = false;
  std::vector<std::string> lines_;
};

}  // namespace uplink::log
