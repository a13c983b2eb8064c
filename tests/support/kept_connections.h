#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/log/logger.h"
#include "server/robot/connection_reports.h"
#include "tests/support/kept_lines.h"

namespace uplink::testing {

/// Keeps what is reported of robots' connections, in order. Thread-safe.
class KeptConnections final : public robot::ConnectionSink {
 public:
  explicit KeptConnections(const Clock& clock, storage::ProcessId process = {})
      : logger_(std::make_unique<NoLines>(), clock, log::Format::kText, log::Level::kError),
        reports_({.clock = clock, .logger = logger_, .sink = this, .process = process, .seed = 1}) {
  }

  /// For what reports connections.
  [[nodiscard]] robot::ConnectionReports& reports() { return reports_; }

  void Begin(storage::ConnectionItem item) override {
    const std::lock_guard lock(mutex_);
    begun_.push_back(std::move(item));
  }
  void Update(storage::ConnectionItem item) override {
    const std::lock_guard lock(mutex_);
    updated_.push_back(std::move(item));
  }
  void End(storage::ConnectionItem item) override {
    const std::lock_guard lock(mutex_);
    ended_.push_back(std::move(item));
  }

  [[nodiscard]] std::vector<storage::ConnectionItem> begun() const {
    const std::lock_guard lock(mutex_);
    return begun_;
  }
  [[nodiscard]] std::vector<storage::ConnectionItem> updated() const {
    const std::lock_guard lock(mutex_);
    return updated_;
  }
  [[nodiscard]] std::vector<storage::ConnectionItem> ended() const {
    const std::lock_guard lock(mutex_);
    return ended_;
  }
  /// The word of each end.
  [[nodiscard]] std::vector<std::string> Ends() const {
    std::vector<std::string> ends;
    for (const storage::ConnectionItem& item : ended()) {
      ends.emplace_back(model::ToText(item.ended->why));
    }
    return ends;
  }

 private:
  const log::Logger logger_;
  robot::ConnectionReports reports_;
  mutable std::mutex mutex_;
  std::vector<storage::ConnectionItem> begun_;
  std::vector<storage::ConnectionItem> updated_;
  std::vector<storage::ConnectionItem> ended_;
};

}  // namespace uplink::testing
