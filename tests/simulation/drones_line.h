#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/store.h"
#include "tests/simulation/drones_book.h"
#include "tests/simulation/recorder.h"

namespace uplink::simulation {

/// The way of one process to the store: it fails calls on order, before they are applied or with
/// their answer lost, and tells the book what was applied.
///
/// Thread: confined to its caller.
class DronesLine final : public storage::Store {
 public:
  /// Both outlive it.
  DronesLine(storage::Store& store, DronesBook& book, const storage::ProcessId& process)
      : store_(store), book_(book), process_(process) {}

  /// The next call that claims or commits fails so.
  void FailNext(StoreFault fault) { fault_ = fault; }
  /// Every call fails before it is applied, until false.
  void SetAway(bool away) { away_ = away; }
  [[nodiscard]] bool away() const { return away_; }

  [[nodiscard]] absl::StatusOr<std::vector<storage::OpenResult>> OpenStreams(
      std::span<const storage::OpenRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::AdoptResult>> Adopt(
      std::span<const storage::AdoptRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ClaimResult>> ClaimDrones(
      std::span<const storage::ClaimRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::Outcome>> Commit(
      const storage::Batch& batch) override;
  [[nodiscard]] absl::StatusOr<storage::Swept> Sweep(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::size_t> CloseRuns(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ProcessId>> ProcessesWithOpenConnections()
      override;
  [[nodiscard]] absl::StatusOr<std::size_t> EndConnections(const storage::ProcessId& process,
                                                           SystemTime now) override;
  [[nodiscard]] std::size_t TakeRunsClosed() override { return store_.TakeRunsClosed(); }
  [[nodiscard]] absl::StatusOr<storage::Trimmed> TrimQuarantine(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<storage::Erased> Retain(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::vector<std::size_t>> Checkpoint(
      std::span<const storage::LiveRow> rows) override;
  [[nodiscard]] bool InDoubt() const override { return store_.InDoubt(); }
  [[nodiscard]] absl::StatusOr<std::vector<storage::FoundRobot>> Compare(
      std::span<const storage::ToldRobot> robots) override;
  [[nodiscard]] std::string ServerRun() const override { return store_.ServerRun(); }
  void EndDoubt() override { store_.EndDoubt(); }

 private:
  /// Carries the call out, unless it is lost on its way; its answer may be.
  template <typename Call>
  auto Pass(const Call& call) -> decltype(call());

  storage::Store& store_;
  DronesBook& book_;
  const storage::ProcessId process_;
  StoreFault fault_ = StoreFault::kNone;
  bool away_ = false;
};

}  // namespace uplink::simulation
