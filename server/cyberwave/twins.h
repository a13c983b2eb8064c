#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/cyberwave/twin.h"
#include "server/robot/live_total.h"

namespace uplink::cyberwave {

/// The robots of twins that this process has heard, by RURI: at most `twins_max`
/// (cyberwave.robots_max).
///
/// Thread: thread-safe; one thread applies, adds and removes.
class Twins final {
 public:
  /// Their memory also counts in `all`, the server's total; null: there is none.
  explicit Twins(std::size_t twins_max, std::shared_ptr<robot::LiveTotal> all = nullptr)
      : twins_max_(twins_max), total_(std::make_shared<robot::LiveTotal>(std::move(all))) {}

  /// Null if it was not heard, or was forgotten.
  [[nodiscard]] TwinPtr Find(std::string_view ruri) const;
  /// As Find, but adds a missing one. Null at twins_max.
  [[nodiscard]] TwinPtr FindOrAdd(const std::string& ruri, const model::cyberwave::Uuid& id);
  [[nodiscard]] std::vector<TwinPtr> All() const;
  void Remove(std::string_view ruri);
  void Clear();

  /// As Twin::Apply, for one of these. Checks the total at the end.
  [[nodiscard]] Applied Apply(Twin& twin, Judgement&& judgement, const Arrival& arrival);
  /// As Twin::DropTable, and counts it. Any thread.
  std::size_t DropTable(Twin& twin, TwinTable table);

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::size_t twins_max() const { return twins_max_; }
  [[nodiscard]] std::size_t bytes() const { return total_->bytes(); }
  /// Tables that twins lost.
  [[nodiscard]] std::uint64_t tables_dropped() const { return tables_dropped_.load(); }

 private:
  const std::size_t twins_max_;
  const std::shared_ptr<robot::LiveTotal> total_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, TwinPtr> twins_;
  std::atomic<std::uint64_t> tables_dropped_{0};
};

}  // namespace uplink::cyberwave
