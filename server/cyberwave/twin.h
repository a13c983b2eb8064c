#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "schema/cyberwave/judge.h"
#include "schema/model/cyberwave/uuid.h"
#include "server/cyberwave/held.h"
#include "server/cyberwave/twin_state.h"

namespace uplink::cyberwave {

/// One robot of a twin as this process has heard it: its live state, shared by who hears it and who
/// shows it.
///
/// Thread: thread-safe by one mutex, never held across a call out; one thread applies.
class Twin final {
 public:
  Twin(std::string ruri, const model::cyberwave::Uuid& id) : ruri_(std::move(ruri)), state_(id) {}

  [[nodiscard]] const std::string& ruri() const { return ruri_; }

  /// What it holds in memory before and after a message, in bytes. A value.
  struct HeldChange {
    std::size_t before = 0;
    std::size_t after = 0;
  };
  /// As TwinState::RecordsAtMost.
  [[nodiscard]] std::size_t RecordsAtMost(const Judgement& judgement) const;
  /// As TwinState::Apply; `change` gets what became of its memory.
  [[nodiscard]] Applied Apply(Judgement&& judgement, const Arrival& arrival, HeldChange& change);
  /// As MetricFaults::Restore. They count as memory from the next message on.
  void RestoreFaults(const std::vector<std::string>& fault_ids);
  /// As TwinState::DropTables.
  void DropTables();

  /// The faults that its last metrics named.
  [[nodiscard]] std::vector<std::string> ActiveFaults() const;

  /// What it holds in memory, as of the last message: nothing before the first one.
  [[nodiscard]] std::size_t bytes() const;
  /// Calls `look` with the parts as they stand, under the lock: it must be short.
  template <typename Look>
  void LookAt(Look look) const {
    const std::lock_guard lock(mutex_);
    look(state_.parts());
  }

 private:
  const std::string ruri_;
  mutable std::mutex mutex_;
  TwinState state_;
  std::size_t bytes_ = 0;
};

using TwinPtr = std::shared_ptr<Twin>;

}  // namespace uplink::cyberwave
