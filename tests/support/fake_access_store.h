#pragma once

#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/access_store.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

/// What operators decide, in a FakeDatabase. Passes the contract. Thread: any, one call at a time.
class FakeAccessStore final : public storage::AccessStore {
 public:
  /// It must outlive this.
  explicit FakeAccessStore(FakeDatabase& database) : database_(database) {}

  absl::StatusOr<storage::AccessVersion> Version() override;
  absl::StatusOr<std::vector<storage::Revocation>> RevocationsAfter(
      storage::AccessVersion after) override;
  absl::StatusOr<std::vector<storage::RobotSetting>> SettingsAfter(
      storage::AccessVersion after) override;
  absl::StatusOr<bool> Revoke(const storage::Revocation& revocation,
                              const storage::AuditRow& audit) override;
  absl::StatusOr<storage::ChangedSetting> Change(const storage::SettingChange& change,
                                                 const storage::AuditRow& audit) override;
  absl::Status Acknowledge(const storage::Acknowledgement& fault,
                           const storage::AuditRow& audit) override;
  absl::Status Append(const storage::AuditRow& audit) override;

  /// Of every call: not OK, the store is away.
  absl::Status status;

 private:
  /// The database is locked.
  void Note(const storage::AuditRow& audit);

  FakeDatabase& database_;
};

}  // namespace uplink::testing
