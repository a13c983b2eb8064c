#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "schema/base/clock.h"

namespace uplink::front {

/// The memory of messages that have begun and are not whole, over all calls of a thread: whoever
/// announces much and sends little pays with its own call. One entry per call; confined to its
/// thread.
class Unfinished final {
 public:
  explicit Unfinished(std::size_t bytes_max) : bytes_max_(bytes_max) {}

  /// So many bytes of the call's message of this number are kept; 0: none is unfinished. Another
  /// number is another message, which begins now.
  void Set(std::uint64_t call, std::uint64_t message, std::size_t bytes, SteadyTime now);
  /// With too many bytes: the call whose message began first, and so is the slowest.
  [[nodiscard]] std::optional<std::uint64_t> TooSlow() const;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Entry {
    SteadyTime began;
    std::uint64_t message = 0;
    std::size_t bytes = 0;
  };

  const std::size_t bytes_max_;
  std::size_t bytes_ = 0;
  std::unordered_map<std::uint64_t, Entry> entries_;
  std::set<std::pair<SteadyTime, std::uint64_t>> by_age_;
};

}  // namespace uplink::front
