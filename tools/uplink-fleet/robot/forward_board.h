#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "tools/uplink-fleet/robot/forward_table.h"

namespace uplink::synthetic {

/// What one receiver holds. A value.
struct ReceiverTable {
  std::string ruri;
  /// Its stream's first snapshot has come.
  bool whole = false;
  std::vector<HeldItem> held;
};

/// Where robots lay open what they hold, each once per time that they are asked.
///
/// Thread: Ask and Take from main's thread, Show from the robots'.
class ForwardBoard final {
 public:
  /// Asks once more; answers to what was asked before are gone.
  void Ask() {
    const std::lock_guard lock(mutex_);
    tables_.clear();
    shown_.store(0);
    asked_.fetch_add(1);
  }
  /// How many times was asked.
  [[nodiscard]] std::size_t asked() const { return asked_.load(std::memory_order_acquire); }
  /// Answers the `asked`th time.
  void Show(std::size_t asked, ReceiverTable table) {
    const std::lock_guard lock(mutex_);
    if (asked != asked_.load()) return;
    tables_.push_back(std::move(table));
    shown_.fetch_add(1);
  }
  [[nodiscard]] const std::atomic<std::size_t>& shown() const { return shown_; }
  [[nodiscard]] std::vector<ReceiverTable> Take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(tables_, {});
  }

 private:
  std::atomic<std::size_t> asked_{0};
  std::atomic<std::size_t> shown_{0};
  std::mutex mutex_;
  std::vector<ReceiverTable> tables_;
};

}  // namespace uplink::synthetic
