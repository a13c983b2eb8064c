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
class FakeReader : public storage::Reader {
 public:
  /// `database` must outlive this.
  explicit FakeReader(const FakeDatabase& database) : database_(database) {}

  [[nodiscard]] absl::StatusOr<std::vector<storage::RobotRow>> Robots(
      std::uint32_t robots_max) override;
  [[nodiscard]] absl::StatusOr<std::size_t> RobotCount() override;
  [[nodiscard]] absl::StatusOr<std::vector<std::string>> FleetsBeyondAscii(
      std::uint32_t fleets_max) override;
  // NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                                       \
  [[nodiscard]] absl::StatusOr<storage::Page<storage::Row>> Name(const storage::Query& query) \
      override;
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
  // NOLINTEND(bugprone-macro-parentheses)
  [[nodiscard]] absl::StatusOr<storage::Page<storage::AuditRow>> Audit(
      const storage::AuditQuery& query) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::DroppedRow>> QuarantineDropped(
      const std::string& ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::StoredReject>> Rejects(
      const storage::RejectsQuery& query) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::OpenRequestCount>> OpenRequestCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                  storage::LatestKindSet kinds) override;
  [[nodiscard]] absl::StatusOr<LiveRows> LiveOf(std::span<const std::string> ruris) override;

 private:
  const FakeDatabase& database_;
};

}  // namespace uplink::testing
