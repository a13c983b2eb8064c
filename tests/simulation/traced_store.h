#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "storage/store.h"
#include "tests/simulation/trace.h"

namespace uplink::simulation {

/// Stands before a store and writes each call with all its arguments, then its answer, into a
/// trace. Changes nothing of either.
///
/// Thread: as the store.
class TracedStore final : public storage::Store {
 public:
  /// Both must outlive this.
  TracedStore(storage::Store& store, Trace& trace) : store_(store), trace_(trace) {}

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
  [[nodiscard]] std::size_t TakeRunsClosed() override;
  [[nodiscard]] absl::StatusOr<storage::Trimmed> TrimQuarantine(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<storage::Erased> Retain(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::vector<std::size_t>> Checkpoint(
      std::span<const storage::LiveRow> rows) override;
  [[nodiscard]] bool InDoubt() const override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::FoundRobot>> Compare(
      std::span<const storage::ToldRobot> robots) override;
  void EndDoubt() override;

 private:
  void AddBatch(const storage::Batch& batch);

  storage::Store& store_;
  Trace& trace_;
};

}  // namespace uplink::simulation
