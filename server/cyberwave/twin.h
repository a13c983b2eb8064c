#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "schema/cyberwave/judge.h"
#include "schema/model/cyberwave/uuid.h"
#include "server/cyberwave/held.h"
#include "server/cyberwave/twin_state.h"
#include "server/robot/live_total.h"

namespace uplink::cyberwave {

/// One robot of a twin, real or simulated: its live state as this process heard it. The broker's
/// thread writes it, views read it.
///
/// Thread: thread-safe by one mutex, never held across a call out; one thread applies.
class Twin final {
 public:
  Twin(std::string ruri, const model::cyberwave::Uuid& id)
      : ruri_(std::move(ruri)), id_(id), state_(id) {}

  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  /// The twin's id, which its two robots share.
  [[nodiscard]] const model::cyberwave::Uuid& id() const { return id_; }
  /// Its memory counts in `total` from now on; null: in none.
  void CountIn(std::shared_ptr<robot::LiveTotal> total);

  /// As TwinState::RecordsAtMost.
  [[nodiscard]] std::size_t RecordsAtMost(const Judgement& judgement) const;
  /// As TwinState::Apply.
  [[nodiscard]] Applied Apply(Judgement&& judgement, const Arrival& arrival);
  /// As MetricFaults::Restore. Their memory counts from the next message on.
  void RestoreFaults(const std::vector<std::string>& fault_ids);
  /// As TwinState::DropTable. Returns the freed bytes.
  std::size_t DropTable(TwinTable table);

  /// The faults that its last metrics named.
  [[nodiscard]] std::vector<std::string> ActiveFaults() const;

  /// Its memory, as of the last message; 0 before the first one.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] TwinTableBytes table_bytes() const;
  /// Grows with each change of its parts.
  [[nodiscard]] std::uint64_t changes() const {
    const std::lock_guard lock(mutex_);
    return changes_;
  }
  /// Calls `look` with the parts, under the lock: it must be short.
  template <typename Look>
  void LookAt(Look look) const {
    const std::lock_guard lock(mutex_);
    look(state_.parts());
  }

 private:
  const std::string ruri_;
  const model::cyberwave::Uuid id_;
  mutable std::mutex mutex_;
  TwinState state_;
  robot::LiveShare share_;
  std::uint64_t changes_ = 0;
};

using TwinPtr = std::shared_ptr<Twin>;

}  // namespace uplink::cyberwave
