#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/reader.h"

namespace uplink::testing {

/// A reader that can be away, and can hold its callers. Thread-safe.
class SwitchedReader final : public storage::Reader {
 public:
  explicit SwitchedReader(storage::Reader& reader) : reader_(reader) {}

  void SetAway(bool away);
  /// Every call fails so until OK.
  void Fail(absl::Status status);
  /// Latest looks at at most so many robots per call.
  void SetLatestMax(std::size_t robots);
  /// Calls wait until Release.
  void Hold();
  void Release();
  /// True once a held call waits; false after `deadline`.
  [[nodiscard]] bool WaitUntilHeld(milliseconds deadline);
  [[nodiscard]] int calls() const;

  absl::StatusOr<std::vector<storage::RobotRow>> Robots(std::uint32_t robots_max) override;
  absl::StatusOr<std::size_t> RobotCount() override;
  absl::StatusOr<std::vector<std::string>> FleetsBeyondAscii(std::uint32_t fleets_max) override;
  absl::StatusOr<std::vector<storage::DroppedRow>> QuarantineDropped(
      const std::string& ruri) override;
  absl::StatusOr<std::vector<storage::StoredReject>> Rejects(
      const storage::RejectsQuery& query) override;
  absl::StatusOr<std::vector<storage::ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  absl::StatusOr<std::vector<storage::OpenRequestCount>> OpenRequestCounts(
      std::span<const std::string> ruris) override;
  absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                    storage::LatestKindSet kinds) override;
  absl::StatusOr<LiveRows> LiveOf(std::span<const std::string> ruris) override;
  // NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                                       \
  [[nodiscard]] absl::StatusOr<storage::Page<storage::Row>> Name(const storage::Query& query) \
      override;
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
  // NOLINTEND(bugprone-macro-parentheses)
  [[nodiscard]] absl::StatusOr<storage::Page<storage::AuditRow>> Audit(
      const storage::AuditQuery& query) override;

 private:
  [[nodiscard]] absl::Status Enter();

  storage::Reader& reader_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  absl::Status fails_;
  bool held_ = false;
  int calls_ = 0;
  int inside_ = 0;
  std::size_t latest_max_ = SIZE_MAX;
};

}  // namespace uplink::testing
