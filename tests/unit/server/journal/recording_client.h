#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/loop/wake.h"
#include "server/robot/commit_client.h"
#include "tests/support/records.h"

namespace uplink::journal {

/// Counts wakes by stream. Thread-safe.
class CountingInbox final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t stream) override {
    const std::lock_guard lock(mutex_);
    ++wakes_[stream];
  }
  [[nodiscard]] int wakes(std::uint64_t stream) const {
    const std::lock_guard lock(mutex_);
    const auto found = wakes_.find(stream);
    return found == wakes_.end() ? 0 : found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, int> wakes_;
};

/// A robot, or a drone, that writes down what the journal tells it. Thread-safe.
class RecordingClient final : public robot::CommitClient {
 public:
  explicit RecordingClient(std::string ruri, loop::StreamRef stream = {})
      : robot_(std::make_shared<const model::RobotId>(model::RobotId{std::move(ruri), "bench"})),
        stream_(stream) {}

  void OnHeld(const robot::HoldNews& news) override {
    const std::lock_guard lock(mutex_);
    holds_.push_back(news);
  }
  void OnHeldElsewhere(const std::optional<storage::StoredPresence>& /*presence*/) override {
    static_cast<void>(Note("held elsewhere"));
  }
  [[nodiscard]] bool HasStream() const override {
    return has_stream_.load() && !away_once_.exchange(false);
  }
  loop::StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& /*result*/) override {
    return Note("opened " + std::to_string(open_id));
  }
  loop::StreamRef OnOtherFleet(std::uint64_t open_id, const std::string& fleet,
                               metrics::Ledger& /*ledger*/) override {
    generation_.fetch_add(1);
    return Note("refused " + std::to_string(open_id) + ": of " + fleet);
  }
  [[nodiscard]] robot::Registration registration() const override { return registration_.load(); }
  void SetRegistration(robot::Registration registration) { registration_.store(registration); }
  loop::StreamRef OnRefused(metrics::Ledger& /*ledger*/) override {
    generation_.fetch_add(1);
    return Note("not registered");
  }
  loop::StreamRef OnClaimed(const storage::ClaimResult& result) override {
    if (result.other_fleet) return Note("of fleet " + *result.other_fleet);
    {
      const std::lock_guard lock(mutex_);
      claims_.push_back(result);
    }
    return Note(result.held_since == 0 ? "claimed, held elsewhere" : "claimed");
  }
  loop::StreamRef OnSettled(std::span<const robot::Settled> settled,
                            metrics::Ledger& /*ledger*/) override {
    std::string line = "settled";
    for (const robot::Settled& one : settled) {
      line += " " + std::to_string(one.seq);
      if (one.outcome.kind == storage::OutcomeKind::kDuplicate) line += " again";
      if (one.outcome.kind == storage::OutcomeKind::kRefused) line += " refused";
      if (one.rejected_for) line += " rejected";
    }
    return Note(std::move(line));
  }
  loop::StreamRef OnGapsWritten(std::size_t count) override {
    return Note("gaps " + std::to_string(count));
  }
  loop::StreamRef OnDoubted() override { return Note("doubted"); }
  loop::StreamRef OnFenced(metrics::Ledger& /*ledger*/) override {
    generation_.fetch_add(1);
    return Note("fenced");
  }
  [[nodiscard]] std::vector<storage::CommittedSession> Committed() const override {
    const std::lock_guard lock(mutex_);
    return committed_;
  }
  loop::StreamRef OnWentBack(metrics::Ledger& /*ledger*/) override {
    generation_.fetch_add(1);
    SetCommitted({});
    return Note("went back");
  }
  [[nodiscard]] std::uint64_t generation() const override { return generation_.load(); }

  /// What was told since the last call, a line each.
  [[nodiscard]] std::vector<std::string> Told() {
    const std::lock_guard lock(mutex_);
    return std::exchange(told_, {});
  }
  /// The holds that began since the last call.
  [[nodiscard]] std::vector<robot::HoldNews> Holds() {
    const std::lock_guard lock(mutex_);
    return std::exchange(holds_, {});
  }
  /// All its claims that were answered.
  [[nodiscard]] std::vector<storage::ClaimResult> Claims() const {
    const std::lock_guard lock(mutex_);
    return claims_;
  }
  void EndStream() { has_stream_.store(false); }
  /// What the store told it.
  void SetCommitted(std::vector<storage::CommittedSession> committed) {
    const std::lock_guard lock(mutex_);
    committed_ = std::move(committed);
  }
  /// The next look finds no stream, those after it do.
  void EndStreamForOneLook() { away_once_.store(true); }
  [[nodiscard]] const storage::RobotRef& robot() const { return robot_; }

 private:
  loop::StreamRef Note(std::string line) {
    const std::lock_guard lock(mutex_);
    told_.push_back(std::move(line));
    return stream_;
  }

  const storage::RobotRef robot_;
  const loop::StreamRef stream_;
  std::atomic<std::uint64_t> generation_{1};
  mutable std::mutex mutex_;
  std::vector<std::string> told_;
  std::vector<robot::HoldNews> holds_;
  std::vector<storage::ClaimResult> claims_;
  std::vector<storage::CommittedSession> committed_;
  std::atomic<bool> has_stream_{true};
  std::atomic<robot::Registration> registration_{robot::Registration::kFits};
  mutable std::atomic<bool> away_once_{false};
};

/// A good durable record.
[[nodiscard]] inline model::Record FaultRecord(std::string id = "BATTERY_LOW") {
  model::Fault fault;
  fault.unix_time_ms = 1'763'683'200'000;
  fault.fault_id = std::move(id);
  fault.source = "bench";
  fault.active = true;
  return test::RecordOf(fault);
}

}  // namespace uplink::journal
