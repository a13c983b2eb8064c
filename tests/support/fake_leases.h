#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/leases.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

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
  /// Each renewal says that a step of the schema shuts this program out.
  void ShutOut() { shut_out_ = true; }
  /// Called by each RobotsOfOthers, before its answer.
  void OnList(std::function<void()> call) { on_list_ = std::move(call); }

  [[nodiscard]] std::string ServerRun() const override { return database_.ServerRun(); }
  [[nodiscard]] absl::Status Renew(const storage::ProcessCard& card) override {
    if (Fails()) return Away();
    database_.Renew(process_, card);
    return shut_out_ ? absl::UnimplementedError("run a newer uplinkd") : absl::OkStatus();
  }
  [[nodiscard]] absl::Status Release() override {
    if (Fails()) return Away();
    database_.Release(process_);
    return absl::OkStatus();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::Lease>> Read() override {
    if (Fails()) return Away();
    return database_.ReadLeases();
  }
  [[nodiscard]] absl::StatusOr<std::vector<storage::ForeignRobot>> RobotsOfOthers(
      std::string_view after) override {
    if (on_list_) on_list_();
    if (Fails()) return Away();
    return database_.RobotsOfOthers(process_, after);
  }

 private:
  bool Fails() { return std::exchange(broken_, false) || away_; }
  static absl::Status Away() { return absl::UnavailableError("the test said so"); }

  FakeDatabase& database_;
  const storage::ProcessId process_;
  bool away_ = false;
  bool broken_ = false;
  bool shut_out_ = false;
  std::function<void()> on_list_;
};

}  // namespace uplink::testing
