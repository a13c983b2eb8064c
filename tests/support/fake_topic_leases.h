#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "storage/topic_leases.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

/// The leases of topics of a FakeDatabase as one process has them. Thread: as storage::TopicLeases;
/// SetAway from the same.
class FakeTopicLeases final : public storage::TopicLeases {
 public:
  /// `database` must outlive this.
  FakeTopicLeases(FakeDatabase& database, const storage::ProcessId& process)
      : database_(database), process_(process) {}

  /// As if the connection had broken, and been made anew.
  void Reconnect() { ++connections_; }
  [[nodiscard]] std::uint64_t connections() const override { return connections_; }

  /// Every call fails until false.
  void SetAway(bool away) { away_ = away; }

  [[nodiscard]] absl::StatusOr<std::optional<storage::Epoch>> Take(
      const storage::TakeRequest& request) override {
    if (away_) return Away();
    if (absl::Status bad = CheckRequest(request); !bad.ok()) return bad;
    return database_.TakeTopics(process_, request);
  }
  [[nodiscard]] absl::Status Release(std::string_view client_id) override {
    if (away_) return Away();
    database_.ReleaseTopics(process_, client_id);
    return absl::OkStatus();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::TopicLease>> Read() override {
    if (away_) return Away();
    return database_.ReadTopics();
  }
  [[nodiscard]] absl::StatusOr<storage::DeliveryMemory> MemoryOf(
      std::string_view client_id) override {
    if (away_) return Away();
    return database_.MemoryOfTopics(client_id);
  }

 private:
  static absl::Status Away() { return absl::UnavailableError("the test said so"); }

  FakeDatabase& database_;
  const storage::ProcessId process_;
  bool away_ = false;
  std::uint64_t connections_ = 1;
};

}  // namespace uplink::testing
