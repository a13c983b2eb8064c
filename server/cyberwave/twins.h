#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/cyberwave/twin.h"

namespace uplink::cyberwave {

/// Memory of all twins together, past which those that hold more than kTwinBytesKept lose their
/// tables: 10,000 arms of six joints with their metrics hold some 100 MB.
inline constexpr std::size_t kTwinsBytesMax = std::size_t{512} * 1024 * 1024;
/// What no twin loses for what others hold.
inline constexpr std::size_t kTwinBytesKept = std::size_t{32} * 1024;

/// The robots of twins that this process has heard, by RURI, at most `twins_max`
/// (cyberwave.robots_max).
///
/// Thread: thread-safe; one thread applies, adds and removes.
class Twins final {
 public:
  explicit Twins(std::size_t twins_max, std::size_t bytes_max = kTwinsBytesMax)
      : twins_max_(twins_max), bytes_max_(bytes_max) {}

  /// Null if it was not heard, or is forgotten.
  [[nodiscard]] TwinPtr Find(std::string_view ruri) const;
  /// The same, made if it is not there. Null at twins_max.
  [[nodiscard]] TwinPtr FindOrAdd(const std::string& ruri, const model::cyberwave::Uuid& id);
  [[nodiscard]] std::vector<TwinPtr> All() const;
  void Remove(std::string_view ruri);
  void Clear();

  /// As Twin::Apply, of one of these. Where all of them hold too much, this one loses its tables if
  /// it holds more than kTwinBytesKept.
  [[nodiscard]] Applied Apply(Twin& twin, Judgement&& judgement, const Arrival& arrival);

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::size_t twins_max() const { return twins_max_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  /// Times that a twin lost its tables.
  [[nodiscard]] std::uint64_t tables_dropped() const { return tables_dropped_.load(); }

 private:
  const std::size_t twins_max_;
  const std::size_t bytes_max_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, TwinPtr> twins_;
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::uint64_t> tables_dropped_{0};
};

}  // namespace uplink::cyberwave
