#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/reader.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

/// The query side of a FakeDatabase. Cheap to make. Thread-safe.
class FakeReader final : public storage::Reader {
 public:
  /// `database` must outlive this.
  explicit FakeReader(const FakeDatabase& database) : database_(database) {}

  [[nodiscard]] absl::StatusOr<std::vector<storage::RobotRow>> Robots(
      std::uint32_t robots_max) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::FaultRow>> FaultsActive(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::FaultRow>> FaultHistory(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::QuarantineRow>> Quarantine(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::GapRow>> Gaps(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::EventRow>> Events(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::MessageRow>> Messages(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::MissionRunRow>> MissionRuns(
      const storage::MissionsQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::MissionReportRow>> MissionReports(
      const storage::MissionsQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ShapeRow>> Shapes(
      const storage::PresentQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ObjectRow>> Objects(
      const storage::PresentQuery& query) override;
  [[nodiscard]] absl::StatusOr<storage::Page<storage::PresenceRow>> PresenceChanges(
      const storage::HistoryQuery& query) override;
  [[nodiscard]] absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                  std::uint32_t kinds) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::LiveRow>> Live(std::string_view after) override;

 private:
  const FakeDatabase& database_;
};

}  // namespace uplink::testing
