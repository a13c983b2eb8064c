#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/leases.h"
#include "storage/topic_leases.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

/// What a call of a fake says that the test has put away.
[[nodiscard]] inline absl::Status AwayAsSaid() {
  return absl::UnavailableError("the test said so");
}

/// The leases of a FakeDatabase as one process has them. Thread: as storage::Leases; SetAway from
/// the same.
class FakeLeases final : public storage::Leases {
 public:
  /// `database` must outlive this.
  FakeLeases(FakeDatabase& database, const storage::ProcessId& process)
      : database_(database), process_(process) {}

  /// Every call fails until false.
  void SetAway(bool away) { away_ = away; }
  /// The connection ends: the next call fails, and makes it anew for those after it.
  void Break() { broken_ = true; }
  /// Each renewal says that the schema shuts this program out.
  void ShutOut() { shut_out_ = true; }
  /// Called by each RobotsOfOthers, before its answer.
  void OnList(std::function<void()> call) { on_list_ = std::move(call); }

  [[nodiscard]] std::string ServerRun() const override { return database_.ServerRun(); }
  [[nodiscard]] absl::Status Renew(const storage::ProcessCard& card) override {
    if (Fails()) return AwayAsSaid();
    database_.Renew(process_, card);
    return shut_out_ ? absl::UnimplementedError("run a newer uplinkd") : absl::OkStatus();
  }
  [[nodiscard]] absl::Status Release() override {
    if (Fails()) return AwayAsSaid();
    database_.Release(process_);
    return absl::OkStatus();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::Lease>> Read() override {
    if (Fails()) return AwayAsSaid();
    return database_.ReadLeases();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::ForeignRobot>> RobotsOfOthers(
      std::string_view after) override {
    if (on_list_) on_list_();
    if (Fails()) return AwayAsSaid();
    return database_.RobotsOfOthers(process_, after);
  }

 private:
  bool Fails() { return std::exchange(broken_, false) || away_; }

  FakeDatabase& database_;
  const storage::ProcessId process_;
  bool away_ = false;
  bool broken_ = false;
  bool shut_out_ = false;
  std::function<void()> on_list_;
};

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
    if (away_) return AwayAsSaid();
    if (absl::Status bad = CheckRequest(request); !bad.ok()) return bad;
    return database_.TakeTopics(process_, request);
  }
  [[nodiscard]] absl::Status Release(std::string_view client_id) override {
    if (away_) return AwayAsSaid();
    database_.ReleaseTopics(process_, client_id);
    return absl::OkStatus();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::TopicLease>> Read() override {
    if (away_) return AwayAsSaid();
    return database_.ReadTopics();
  }
  [[nodiscard]] absl::StatusOr<storage::DeliveryMemory> MemoryOf(
      std::string_view client_id) override {
    if (away_) return AwayAsSaid();
    return database_.MemoryOfTopics(client_id);
  }

 private:
  FakeDatabase& database_;
  const storage::ProcessId process_;
  bool away_ = false;
  std::uint64_t connections_ = 1;
};

}  // namespace uplink::testing
